// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/units.h"

namespace nonio::modelling {

/// Readings that were excluded: lines in the file of one measurement.
struct Exclusion {
  std::string measurement;
  std::vector<std::uint32_t> lines;
  std::string why;
};

/// A new value for the screw pitch of an axis.
struct Period {
  std::string axis;
  double mm = 0.0;
};

/// One recorded change of the model: of an effect, or of data on which its fit depends.
struct ModelStep {
  std::string effect;
  bool added = true;  ///< false: the effect was removed
  Quantity quantity = Quantity::deviation;
  /// RMS in m or rad; none if that model could not be fitted.
  std::optional<double> rms_before{}, rms_after{};
  /// RMS of the cross-validation before and after the change, and noise floor, m or rad.
  std::optional<double> cv_before{}, cv_after{}, floor{};
  std::string why{};  ///< comment of a person; usually empty
  std::optional<Exclusion> excluded{};
  std::optional<Period> period{};
};

/// Name of the history next to campaign.toml: one JSON object per line for each change of the
/// model, oldest first. It contains no time, so that the same changes result in the same bytes. It
/// is a record for people: no program computes from it, and a run does not read it.
inline constexpr const char* history_name = "model-history.jsonl";

std::string history_line(const ModelStep& step);
/// Parses a history. An error contains the line.
Expected<std::vector<ModelStep>> parse_history(std::string_view text);

/// Reads the history in a campaign's folder; empty if there is none.
Expected<std::vector<ModelStep>> read_history(const std::filesystem::path& folder);

}  // namespace nonio::modelling
