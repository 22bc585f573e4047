// SPDX-License-Identifier: Apache-2.0
#include "ballbar.h"

namespace nonio::ballbar_b5r {

NONIO_PLUGIN(registry) { registry.add(ballbar::reader()); }

}  // namespace nonio::ballbar_b5r
