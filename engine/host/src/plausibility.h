// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "nonio/host/campaign_reader.h"

/// What looks like a mistake of the person or program that wrote the files: a unit, a sign, an
/// order, a copy, a date. Each finding asks for attention and names the numbers that betray it; no
/// table is written and no number drawn until a person says why it may stand. Sources: none, these
/// are orders of magnitude of machine tools and instruments (docs/wrong-inputs.md lists them).
namespace nonio::host {

inline constexpr std::string_view plausibility_name = "plausibility";
inline constexpr std::string_view plausibility_prefix = "plausibility.";
inline constexpr std::string_view file_of_another_campaign =
    "plausibility.file-of-another-campaign";
/// The one doubt that keeps no table: copies change no mean.
inline constexpr std::string_view no_scatter = "plausibility.no-scatter";

/// All of them, an entry for each measurement that has any, and one without for the campaign.
std::vector<Results::Analysed> implausible(const ReadCampaign& read, const Context& context,
                                           const Inputs& inputs);

/// Which of the files another campaign has too becomes one of the inputs.
void note_shared(const Twins& twins, Inputs& inputs);

/// What the manifest alone says. `today`: YYYY-MM-DD, or empty: no day is too late.
std::vector<Finding> implausible_campaign(const Manifest& manifest, const std::string& today);

/// What the readings of a measurement say. `all`: of each measurement of the campaign.
std::vector<Finding> implausible_readings(const Campaign& campaign, std::size_t measurement,
                                          const std::vector<Observations>& all);

/// Passes that are copies, directions that are swapped or go against the order of the rows.
void implausible_passes(const Observations& o, bool with_directions, std::vector<Finding>& out);

/// A file of text that ends within its last number.
std::vector<Finding> implausible_end(std::string_view bytes, const std::string& file);

/// A temperature, pressure or humidity that no shop has, with its line; else nothing.
Expected<void> possible_air(const Observations& o, const std::string& file);

/// The day of the clock.
std::string day_of_clock();

}  // namespace nonio::host
