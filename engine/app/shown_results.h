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

/// results.json and the words that it is shown with.
struct Shown {
  std::string text;
  Templates templates;
  std::string language = "en";
  /// Of each measurement, where the campaign was evaluated for this; empty for stored results.
  std::vector<Observations> observations{};
};

enum class Documents { written, left_out };

/// The results of a campaign as a run would write them, but without a number drawn for a
/// certificate. Nothing is written.
Expected<Shown> evaluated_now(const std::filesystem::path& folder, const Common& common,
                              Documents documents = Documents::written);
/// The results that a run has stored in a folder.
Expected<Shown> of_run(const std::filesystem::path& folder, const Common& common);

/// A finding of results.json.
Finding finding_of(const nlohmann::ordered_json& json);

}  // namespace nonio::app
