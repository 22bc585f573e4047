// SPDX-License-Identifier: Apache-2.0
#include "rtl.h"

NONIO_PLUGIN(registry) { registry.add(nonio::renishaw::rtl_reader()); }
