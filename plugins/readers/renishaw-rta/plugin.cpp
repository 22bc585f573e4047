// SPDX-License-Identifier: Apache-2.0
#include "rta.h"

NONIO_PLUGIN(registry) { registry.add(nonio::renishaw::rta_reader()); }
