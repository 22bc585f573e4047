// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "campaign/modelling/model_change.h"

namespace nonio::modelling {

/// Every reading with its model, a row each, in the order of the parts and of their tables:
///
///     part,measurement,file_line,target_mm,run,direction,time_s,reading_um,model_um,residual_um,weight
///
/// Units are part of the names; where parts differ in units there is a column for each unit, empty
/// where it is of other parts. Displacements over time have no target. Unknown values are empty;
/// weight 0: a suspect reading that the fit does not use. reading = model + residual.
std::string readings_csv(const std::vector<Compared>& all);

}  // namespace nonio::modelling
