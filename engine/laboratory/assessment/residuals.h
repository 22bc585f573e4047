// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "campaign/modelling/joint_model.h"

namespace nonio::assessment {

/// A page with the residuals of axes in several campaigns, and of parts that a machine made. Error:
/// there are none.
Expected<std::string> residuals_page(const modelling::FleetExplanation& all,
                                     const Templates& templates, const std::string& language);

}  // namespace nonio::assessment
