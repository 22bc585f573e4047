// SPDX-License-Identifier: Apache-2.0
#include "camonitor.h"

namespace nonio::camonitor {

NONIO_PLUGIN(registry) { registry.add(camonitor::reader()); }

}  // namespace nonio::camonitor
