// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "plugin_check/plugin_checks.h"

/// Compares a plugin with files that a person wrote for a case: readings.csv, table.csv,
/// expected/values.csv and formulas.toml. A data file alone does not show whether it was read
/// correctly.
namespace nonio::plugin_check::kit {

/// Compares observations with readings.csv, reading by reading. Returns the first difference in
/// words, "" if there is none, and adds the number of compared rows to `compared`.
std::string differs_from_truth(const Observations& o, const Measurement& m, const Source& source,
                               std::size_t& compared);

Verdict truth(const Analysis& analysis, const Bench& bench);
Verdict truth(const Effect& effect, const Bench& bench);
Verdict truth(const Controller& controller, const Bench& bench);

}  // namespace nonio::plugin_check::kit
