// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "campaign/reading/campaign_reader.h"

/// What looks like a mistake of the person or program that wrote the files: a unit, a sign, an
/// order, a copy, a date. A finding that requires action names the numbers that betray it; no
/// table is written and no number drawn until a person states why it is accepted. One that another
/// cause explains as well is information. Sources: none, these
/// are orders of magnitude of machine tools and instruments (docs/dev/wrong-inputs.md lists them).
namespace nonio::reading {

inline constexpr std::string_view plausibility_name = "plausibility";
inline constexpr std::string_view plausibility_prefix = "plausibility.";
/// Evidence of a finding that a person accepts for tables: the reason. Outputs that write for
/// controls without being tables look for it. The second one is its name in version 0.1.
inline constexpr const char* accepted_because = "accepted";
inline constexpr const char* formerly_accepted_because = "stands";
inline constexpr std::string_view file_of_another_campaign =
    "plausibility.file-of-another-campaign";

/// All of them, an entry for each measurement that has any, and one without for the campaign.
std::vector<Results::Analysed> implausible(const ReadCampaign& read, const Context& context,
                                           const Inputs& inputs,
                                           const std::vector<Results::Analysed>& analyses);

/// Which of the files another campaign has too becomes one of the inputs.
void note_shared(const Twins& twins, Inputs& inputs);

/// The findings of the manifest alone. `today`: YYYY-MM-DD, or empty: no day is too late.
std::vector<Finding> implausible_campaign(const config::Manifest& manifest,
                                          const std::string& today);

/// A pitch in inches under a name that states mm: no usual one, and a usual one 25.4 times as
/// large; or that of another axis of the machine, 25.4 times as large.
void implausible_pitch(const Campaign& campaign, std::vector<Finding>& out);

/// The same as the readings betray it.
void period_against_pitch(const Axis& axis, const Observations& o, std::vector<Finding>& out);

/// Centres of a ball: how far apart, and about which axis.
void implausible_centres(const Measurement& m, const Observations& o, std::vector<Finding>& out);

/// A file of text that ends within its last number.
std::vector<Finding> implausible_end(std::string_view bytes, const std::string& file);

/// A temperature, pressure or humidity that no shop has, with its line; else nothing.
Expected<void> possible_air(const Observations& o, const std::string& file);

/// The day of the clock.
std::string day_of_clock();

}  // namespace nonio::reading
