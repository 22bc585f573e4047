// SPDX-License-Identifier: Apache-2.0
#include "camonitor.h"

NONIO_PLUGIN(registry) { registry.add(nonio::camonitor::reader()); }
