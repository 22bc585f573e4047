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

/// Effect of tables that a control has loaded.
namespace nonio::math {

/// Returns c(x): what the table adds at position `at` of its inputs, moving toward `direction`
/// (+1, -1), m or rad. Between points k and k + 1 of one input
///
///     c(x) = c_k + (c_(k+1) - c_k) (x - x_k)/(x_(k+1) - x_k)
///
/// With two inputs, c is linear in each of them. Outside of the points, `LoadedTable::outside`
/// applies. Source: the control's manual or code, with its confidence in
/// plugins/controllers/*/README.md. Range: tables that `validate_table` accepts.
double added(const LoadedTable& table, std::span<const double> at, int direction);

/// Returns the sum that all tables add to `output` if the axes are at `at`; a table with an input
/// that is not in `at` adds nothing. An axis that is not in `direction` moves toward +.
double added(const std::vector<LoadedTable>& tables, std::string_view output,
             const std::map<std::string, double>& at, const std::map<std::string, int>& direction);

/// Returns the correction of one axis as a function of its own position: the sum of the tables
/// whose only input is this axis, plus half of the backlash value for motion in direction +, minus
/// half of it for motion in direction -. `present`: backlash value in the control, which applies if
/// no table sets one. Nothing if no such table exists.
std::optional<Correction> correction_of(const std::vector<LoadedTable>& tables,
                                        std::string_view axis, double present = 0.0);

/// Checks that every input has positions, positions ascend, all numbers are finite, the number of
/// values matches the points, and a table with one input that repeats has equal values at its ends.
/// The error names the output of the table.
Expected<void> validate_table(const LoadedTable& table);

}  // namespace nonio::math
