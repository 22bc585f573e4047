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

/// Excluded readings: lines in the file of one measurement.
struct Exclusion {
  std::string measurement;
  std::vector<std::uint32_t> lines;
  std::string why;
};

struct Period {
  std::string axis;
  double mm = 0.0;
};

struct ModelStep {
  std::string effect;
  bool added = true;  ///< false if the effect was removed
  Quantity quantity = Quantity::deviation;
  /// RMS, m or rad; nullopt if the model could not be fitted.
  std::optional<double> rms_before{}, rms_after{};
  /// RMS of the cross-validation, and noise floor, m or rad.
  std::optional<double> cv_before{}, cv_after{}, floor{};
  std::string why{};
  std::optional<Exclusion> excluded{};
  std::optional<Period> period{};
};

/// One JSON object per change, oldest first, without times, so that equal changes write equal
/// bytes. No results depend on this file.
inline constexpr const char* history_name = "model-history.jsonl";

std::string history_line(const ModelStep& step);
/// Errors contain the line.
Expected<std::vector<ModelStep>> parse_history(std::string_view text);

Expected<std::vector<ModelStep>> read_history(const std::filesystem::path& folder);

}  // namespace nonio::modelling
