// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dlfcn.h>

#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "nonio/sdk/plugin.h"

namespace nonio {

/// The analysis of a plugin that is linked in; the one of this name, if a name is given.
inline Analysis analysis_of(const PluginEntry& plugin, std::string_view name = {}) {
  struct Taker final : Registry {
    std::string_view name;
    std::vector<Analysis> taken;
    void add(Method) override {}
    void add(Reader) override {}
    void add(Effect) override {}
    void add(Analysis a) override {
      if (name.empty() || a.info.name == name) taken.push_back(std::move(a));
    }
    void add(Output) override {}
    void add(Controller) override {}
  } taker;
  taker.name = name;
  plugin.add_to(taker);
  if (taker.taken.empty()) throw std::runtime_error("no analysis " + std::string(name));
  return std::move(taker.taken.back());
}

/// An analysis of a library as it was built.
inline Analysis loaded_analysis(const char* path, std::string_view name) {
  void* library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw std::runtime_error(dlerror());
  return analysis_of(*static_cast<const PluginEntry*>(dlsym(library, "nonio_plugin")), name);
}

}  // namespace nonio
