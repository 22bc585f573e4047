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

/// What the table adds at these positions of its inputs, moving towards `direction`: linear between
/// the points, beyond them as the table says. m or rad.
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

/// Whether positions rise, numbers are finite and there are as many as the points need.
Expected<void> validate_table(const LoadedTable& table);

}  // namespace nonio::math
