// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lines.h"
#include "nonio/math/rigid_artefact.h"

/// Artefacts and squares as lines of the fit: common unknowns of several lines, and certified
/// values.
namespace nonio::rigid_body {

/// Appends the artefacts of this state: three lines per placement, then the certified values.
/// `unknowns`, the number of common unknowns, is increased.
void take_artefacts(const AnalysisInput&, std::size_t& unknowns, Lines&);

/// Adds the inputs of balls and certified values, and the keys that are missing for these inputs.
void put_stated_inputs(const AnalysisInput&, const Lines&, math::ReadingModel&);

math::BudgetLine stated_budget(std::size_t readings, std::size_t group);

}  // namespace nonio::rigid_body
