// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "common.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/results.h"
#include "nonio/sdk/templates.h"

namespace nonio::app {

struct Shown {
  std::string text;
  Templates templates;
  std::string language = "en";
  std::vector<Observations> observations{};
  /// Notes of the results in `language`, in their order; empty for English.
  std::vector<std::string> notes{};
};

/// Returns the results with their notes in the language of the site.
nlohmann::ordered_json results_of(const Shown& shown);

enum class Documents { written, left_out };

/// Evaluates a campaign as a run does, without a certificate number; nothing is written.
Expected<Shown> evaluated_now(const std::filesystem::path& folder, const Common& common,
                              Documents documents = Documents::written);
/// Reads stored results and their language. An error if the folder contains no results.json.
Expected<Shown> of_run(const std::filesystem::path& folder, const Common& common);

/// Whether the site of these results states that the certificate is no longer in force.
bool is_out_of_force(const std::filesystem::path& results, const std::string& number);

/// Converts a finding of results.json. The values of its evidence are converted to SI units.
Finding finding_of(const nlohmann::ordered_json& json);

enum class Holds { campaign, results, run, nothing };
Holds what_holds(const std::filesystem::path& folder);

/// Returns the path in the pack if the results of the folder OUT/ID are packed, otherwise `folder`.
std::filesystem::path results_at(const std::filesystem::path& folder);
/// Returns the error message for a folder without campaign.toml, results.json and summary.json.
std::string holds_nothing(const std::filesystem::path& folder);

/// Returns the id that a run gives to the campaign, even if its manifest has other errors.
std::string id_of_campaign(const std::filesystem::path& folder);

}  // namespace nonio::app
