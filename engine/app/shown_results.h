// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "common.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/results.h"
#include "nonio/sdk/settings.h"

namespace nonio::app {

/// The text of results.json, and the templates and the language for showing it.
struct Shown {
  std::string text;
  Templates templates;
  std::string language = "en";
  /// Readings of each measurement if the campaign was evaluated now; empty for stored results.
  std::vector<Observations> observations{};
};

enum class Documents { written, left_out };

/// Evaluates a campaign as a run would, without assigning a certificate number. Nothing is written.
Expected<Shown> evaluated_now(const std::filesystem::path& folder, const Common& common,
                              Documents documents = Documents::written);
/// Reads the results that a run has stored in a folder.
Expected<Shown> of_run(const std::filesystem::path& folder, const Common& common);

/// Converts a finding of results.json; the values of its evidence are converted to SI.
Finding finding_of(const nlohmann::ordered_json& json);

}  // namespace nonio::app
