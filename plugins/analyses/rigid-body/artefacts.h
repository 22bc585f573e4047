// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lines.h"
#include "nonio/math/rigid_artefact.h"

/// Artefacts and squares among the lines of the fit: what several lines share, and what a
/// certificate states of it.
namespace nonio::rigid_body {

/// Puts the artefacts of this state behind the lines: three for each placement, then what is
/// stated. `unknowns`: those that are shared so far.
void take_artefacts(const AnalysisInput&, std::size_t& unknowns, Lines&);

/// Inputs of balls and of what is stated, and the keys that are not stated.
void put_stated_inputs(const AnalysisInput&, const Lines&, math::ReadingModel&);

/// A part of the budget of a line of what is stated.
math::BudgetLine stated_budget(std::size_t readings, std::size_t group);

}  // namespace nonio::rigid_body
