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

/// What a control does with tables that are in it.
namespace nonio::math {

/// c(x): what the table adds at these positions of its inputs, moving towards `direction` (+1, -1),
/// m or rad. Between points k and k + 1 of one input
///
///     c(x) = c_k + (c_(k+1) - c_k) (x - x_k)/(x_(k+1) - x_k)
///
/// of two inputs the same in each of them; beyond the points as the table states (`outside`).
/// Source: the control's manual or code, with its confidence in plugins/controllers/*/README.md.
/// Range: what `validate_table` accepts.
double added(const LoadedTable& table, std::span<const double> at, int direction);

/// What all of these add to `output` where the axes are at `at`; a table of which an input is not
/// known adds nothing.
double added(const std::vector<LoadedTable>& tables, std::string_view output,
             const std::map<std::string, double>& at, const std::map<std::string, int>& direction);

/// The tables of one axis over itself, and half of the backlash value in each direction of travel:
/// a constant that the control adds to both is in no range of deviations. `present`: the value in
/// the control where no table sets it. Nothing where there is no table of this axis.
std::optional<Correction> correction_of(const std::vector<LoadedTable>& tables,
                                        std::string_view axis, double present = 0.0);

/// An error that names the table's output unless positions rise, numbers are finite, there are as
/// many as the points need, and a table that repeats has equal ends.
Expected<void> validate_table(const LoadedTable& table);

}  // namespace nonio::math
