// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "plugin_check/plugin_checks.h"

/// Files that a person wrote for a case, because the data file alone does not show whether it was
/// read correctly: readings.csv, table.csv, expected/values.csv, formulas.toml.
namespace nonio::plugin_check::kit {

/// Of a reader: reading by reading, against readings.csv.
std::string differs_from_truth(const Observations& o, const Measurement& m, const Source& source,
                               std::size_t& compared);

Verdict truth(const Analysis& analysis, const Bench& bench);
Verdict truth(const Effect& effect, const Bench& bench);
Verdict truth(const Controller& controller, const Bench& bench);

}  // namespace nonio::plugin_check::kit
