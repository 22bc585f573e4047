// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "campaign/modelling/campaign_model.h"
#include "nonio/sdk/results.h"

namespace nonio::modelling {

/// Returns findings about the time constants that thermal tests of the campaign determine for the
/// axes of this part: which effects use them, or why none does. Empty if no effect needs one.
std::vector<Finding> time_constant_findings(const PartModel& part, const model::Fit& fit);

}  // namespace nonio::modelling
