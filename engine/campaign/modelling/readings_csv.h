// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "campaign/modelling/model_change.h"

namespace nonio::modelling {

/// Returns every reading with its model as a row, in the order of the parts and of their tables:
///
/// part,measurement,file_line,target_mm,run,direction,time_s,reading_um,model_um,residual_um,weight
///
/// If parts differ in units, there is a column for each unit, which is empty for other parts.
/// Displacements over time have no target. Unknown values are empty. Weight 0: a suspect reading
/// that the fit does not use. reading = model + residual.
std::string readings_csv(const std::vector<Compared>& all);

}  // namespace nonio::modelling
