// SPDX-License-Identifier: Apache-2.0
#include "rtl.h"

namespace nonio::renishaw_rtl {

NONIO_PLUGIN(registry) { registry.add(renishaw::rtl_reader()); }

}  // namespace nonio::renishaw_rtl
