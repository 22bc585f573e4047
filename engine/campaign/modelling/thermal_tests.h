// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "campaign/modelling/campaign_model.h"
#include "nonio/sdk/results.h"

namespace nonio::modelling {

/// Recorded channels, or values of them, that are not used.
std::vector<Finding> channel_findings(const PartModel& part);
/// Gaps and jumps of a displacement over time, with the largest time constant of the fit that a gap
/// exceeds.
std::vector<Finding> restart_findings(const PartModel& part, const model::Fit& fit);
/// States which effects use the time constants of thermal tests, or why none does.
std::vector<Finding> time_constant_findings(const PartModel& part, const model::Fit& fit);

}  // namespace nonio::modelling
