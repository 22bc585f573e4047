// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "plugin_check/plugin_checks.h"

/// Comparison of a plugin with files that a person wrote for a case (readings.csv, table.csv,
/// expected/values.csv, formulas.toml), because a data file alone does not show whether it was read
/// correctly.
namespace nonio::plugin_check::kit {

/// Returns the first difference in words, or an empty text, and adds the number of compared rows to
/// `compared`.
std::string differs_from_truth(const Observations& o, const Measurement& m, const Source& source,
                               std::size_t& compared);

Verdict truth(const Analysis& analysis, const Bench& bench);
Verdict truth(const Effect& effect, const Bench& bench);
Verdict truth(const Controller& controller, const Bench& bench);

}  // namespace nonio::plugin_check::kit
