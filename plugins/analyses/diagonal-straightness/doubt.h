// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/math/budget.h"
#include "sets.h"

namespace nonio::diagonal_straightness {

/// The lines of a set as its budget needs them, in the order of solve_diagonals.
std::vector<math::BudgetLine> budget_lines(const Collected&, const Campaign&);

/// The measurement and the others that it is made from.
std::vector<const Observations*> observations_of(const AnalysisInput&,
                                                 const std::vector<std::string>& uses);

}  // namespace nonio::diagonal_straightness
