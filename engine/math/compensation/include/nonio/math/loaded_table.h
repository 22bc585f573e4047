// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/math/compensation.h"
#include "nonio/sdk/control.h"

namespace nonio::math {

/// Returns c(x): what the table adds at position `at` of its inputs, moving toward `direction`
/// (+1, -1), m or rad. Between points k and k + 1 of one input
///
///     c(x) = c_k + (c_(k+1) - c_k) (x - x_k)/(x_(k+1) - x_k)
///
/// With two inputs, c is linear in each of them; outside of the points, `LoadedTable::outside`
/// applies. Source: manual or code of the control (plugins/controllers/*/README.md).
double added(const LoadedTable& table, std::span<const double> at, int direction);

/// Returns the sum that all tables add to `output` if the axes are at `at`; a table with an input
/// that is not in `at` adds nothing. An axis that is not in `direction` moves toward +.
double added(const std::vector<LoadedTable>& tables, std::string_view output,
             const std::map<std::string, double>& at, const std::map<std::string, int>& direction);

/// Correction of one axis: the sum of the tables whose only input is this axis, plus (direction +)
/// or minus (-) half of the backlash value. `present`: backlash value in the control, if no table
/// sets one. std::nullopt without such tables.
std::optional<Correction> correction_of(const std::vector<LoadedTable>& tables,
                                        std::string_view axis, double present = 0.0);

/// Errors, with the output of the table: missing or descending positions, numbers that are not
/// finite, another number of values than points, unequal ends of a repeating table with one input.
Expected<void> validate_table(const LoadedTable& table);

}  // namespace nonio::math
