// SPDX-License-Identifier: Apache-2.0
// A plugin of another compiler. Its registration must never be called.
#include <cstdlib>

#include "nonio/sdk/plugin.h"

extern "C" __attribute__((visibility("default"))) const nonio::PluginEntry nonio_plugin;
const nonio::PluginEntry nonio_plugin = {"nonio-sdk 0; another compiler",
                                         [](nonio::Registry&) { std::abort(); }};
