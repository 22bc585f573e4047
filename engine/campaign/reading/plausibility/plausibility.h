// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "campaign/reading/campaign_reader.h"

/// Reports apparent mistakes in files: units, signs, order, copies, dates. An open finding that
/// requires action prevents tables and certificates. Sources: none; the limits are orders of
/// magnitude of machine tools and instruments (docs/dev/wrong-inputs.md).
namespace nonio::reading {

inline constexpr std::string_view plausibility_name = "plausibility";
inline constexpr std::string_view plausibility_prefix = "plausibility.";
/// Key of the reason for which a person accepts a finding, and its name in version 0.1.
inline constexpr const char* accepted_because = "accepted";
inline constexpr const char* formerly_accepted_because = "stands";
inline constexpr std::string_view file_of_another_campaign =
    "plausibility.file-of-another-campaign";

/// Returns one entry per measurement with findings, and one without a measurement.
std::vector<Results::Analysed> implausible(const ReadCampaign& read, const Context& context,
                                           const Inputs& inputs,
                                           const std::vector<Results::Analysed>& analyses);

void note_shared(const Twins& twins, Inputs& inputs);

/// `today`: YYYY-MM-DD; if empty, no date is too late.
std::vector<Finding> implausible_campaign(const config::Manifest& manifest,
                                          const std::string& today);

/// Reports a pitch in inches under a key in mm: it is below 2 mm, and 25.4 times its value is the
/// pitch of another axis, or a usual pitch although the value has more than two significant digits.
void implausible_pitch(const Campaign& campaign, std::vector<Finding>& out);

/// Reports a period in the readings that shows a pitch in inches.
void period_against_pitch(const Axis& axis, const Observations& o, std::vector<Finding>& out);

/// Reports implausible distances, and centers that turn about another axis than the stated one.
void implausible_centres(const Measurement& m, const Observations& o, std::vector<Finding>& out);

/// Reports a text file that ends within its last number.
std::vector<Finding> implausible_end(std::string_view bytes, const std::string& file);

/// Returns an error for a temperature, pressure or humidity that no workshop has.
Expected<void> possible_air(const Observations& o, const std::string& file);

/// Returns YYYY-MM-DD in the local time zone.
std::string day_of_clock();

}  // namespace nonio::reading
