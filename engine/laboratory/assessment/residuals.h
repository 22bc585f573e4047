// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "campaign/modelling/joint_model.h"

namespace nonio::assessment {

/// A page with the residuals of axes in several campaigns.
Expected<std::string> residuals_page(const std::vector<modelling::Together>& all,
                                     const Templates& templates, const std::string& language);

}  // namespace nonio::assessment
