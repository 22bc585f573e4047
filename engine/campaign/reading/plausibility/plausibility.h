// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "campaign/reading/campaign_reader.h"

/// Reports what looks like a mistake of the person or program that wrote the files: a unit, a sign,
/// an order, a copy, a date. A finding that requires action states the numbers that show the
/// mistake; no table is written and no certificate number is assigned until a person states why it
/// is accepted. A finding that another cause may explain too is information. Sources: none; the
/// limits are orders of magnitude of machine tools and instruments (docs/dev/wrong-inputs.md lists
/// them).
namespace nonio::reading {

inline constexpr std::string_view plausibility_name = "plausibility";
inline constexpr std::string_view plausibility_prefix = "plausibility.";
/// Key of the text of a finding that contains the reason why a person accepts the finding for
/// tables. Outputs that write files for controls other than tables read it. The second constant is
/// its name in version 0.1.
inline constexpr const char* accepted_because = "accepted";
inline constexpr const char* formerly_accepted_because = "stands";
inline constexpr std::string_view file_of_another_campaign =
    "plausibility.file-of-another-campaign";

/// Returns all findings: one entry for each measurement that has any, and one without a measurement
/// for the campaign.
std::vector<Results::Analysed> implausible(const ReadCampaign& read, const Context& context,
                                           const Inputs& inputs,
                                           const std::vector<Results::Analysed>& analyses);

/// Records in `inputs` which of the files another campaign contains too.
void note_shared(const Twins& twins, Inputs& inputs);

/// Returns the findings about the manifest alone. `today` is the date YYYY-MM-DD; if it is empty,
/// no date is regarded as too late.
std::vector<Finding> implausible_campaign(const config::Manifest& manifest,
                                          const std::string& today);

/// Reports a pitch in inches under a key in mm: it is below 2 mm, and 25.4 times its value is
/// either the pitch of another axis of the machine, or a usual pitch although the value itself has
/// more than two significant digits.
void implausible_pitch(const Campaign& campaign, std::vector<Finding>& out);

/// Reports readings whose period shows that the pitch of the axis is stated in inches.
void period_against_pitch(const Axis& axis, const Observations& o, std::vector<Finding>& out);

/// Reports ball centres at implausible distances, or that turn about another axis than the stated
/// one.
void implausible_centres(const Measurement& m, const Observations& o, std::vector<Finding>& out);

/// Reports a text file that ends within its last number.
std::vector<Finding> implausible_end(std::string_view bytes, const std::string& file);

/// Returns an error with the line of a temperature, pressure or humidity that no workshop has.
Expected<void> possible_air(const Observations& o, const std::string& file);

/// Returns the date of today, YYYY-MM-DD, in the local time zone.
std::string day_of_clock();

}  // namespace nonio::reading
