// SPDX-License-Identifier: Apache-2.0
// Crashes before anything in it is called.
#include <csignal>

#include "nonio/sdk/plugin.h"

namespace {
const int dead = std::raise(SIGSEGV);
}

NONIO_PLUGIN(registry) { (void)registry, (void)dead; }
