// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dlfcn.h>

#include <stdexcept>
#include <utility>

#include "nonio/sdk/plugin.h"

namespace nonio {

/// The analysis of a plugin that is linked in.
inline Analysis analysis_of(const PluginEntry& plugin) {
  struct Taker final : Registry {
    Analysis analysis;
    void add(Method) override {}
    void add(Reader) override {}
    void add(Effect) override {}
    void add(Analysis a) override { analysis = std::move(a); }
    void add(Output) override {}
    void add(Controller) override {}
  } taker;
  plugin.add_to(taker);
  return taker.analysis;
}

/// The analysis of a plugin as it was built.
inline Analysis loaded_analysis(const char* path) {
  void* library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw std::runtime_error(dlerror());
  return analysis_of(*static_cast<const PluginEntry*>(dlsym(library, "nonio_plugin")));
}

}  // namespace nonio
