// SPDX-License-Identifier: Apache-2.0
#include "ballbar.h"

NONIO_PLUGIN(registry) { registry.add(nonio::ballbar::reader()); }
