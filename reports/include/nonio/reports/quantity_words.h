// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "nonio/reports/wording.h"

namespace nonio::reports {

/// Name of a quantity that is followed over the campaigns: "Scale", "Straightness Z, bow"; its
/// symbol where it has no words. `site`: the words of site.toml.
std::string followed_quantity(const Wording& site, const std::string& quantity);

}  // namespace nonio::reports
