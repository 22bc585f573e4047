// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "campaign/modelling/campaign_model.h"
#include "nonio/sdk/results.h"

namespace nonio::modelling {

/// States which effects use the time constants of thermal tests, or why none does.
std::vector<Finding> time_constant_findings(const PartModel& part, const model::Fit& fit);

}  // namespace nonio::modelling
