// SPDX-License-Identifier: Apache-2.0
#include "rta.h"

namespace nonio::renishaw_rta {

NONIO_PLUGIN(registry) { registry.add(renishaw::rta_reader()); }

}  // namespace nonio::renishaw_rta
