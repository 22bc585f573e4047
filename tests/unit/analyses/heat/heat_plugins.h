// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dlfcn.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "nonio/sdk/plugin.h"

/// The three analyses as the host has them.
namespace heat {

struct Loaded : nonio::Registry {
  nonio::Analysis analysis;
  void add(nonio::Method) override {}
  void add(nonio::Reader) override {}
  void add(nonio::Effect) override {}
  void add(nonio::Analysis a) override { analysis = std::move(a); }
  void add(nonio::Output) override {}
  void add(nonio::Controller) override {}
  explicit Loaded(const char* path) {
    void* library = dlopen(path, RTLD_NOW);
    if (library == nullptr) {
      std::fprintf(stderr, "%s\n", dlerror());
      std::abort();
    }
    static_cast<const nonio::PluginEntry*>(dlsym(library, "nonio_plugin"))->add_to(*this);
  }
};

inline const nonio::Analysis& thermal() {
  static const Loaded loaded(NONIO_THERMAL_PLUGIN);
  return loaded.analysis;
}
inline const nonio::Analysis& spindle() {
  static const Loaded loaded(NONIO_SPINDLE_PLUGIN);
  return loaded.analysis;
}
inline const nonio::Analysis& lengths() {
  static const Loaded loaded(NONIO_LENGTHS_PLUGIN);
  return loaded.analysis;
}

struct Made {
  nonio::Campaign campaign;
  nonio::Observations o;
};

/// Nothing where it fails: the caller says so.
inline nonio::Evaluation evaluated(
    const nonio::Analysis& a, const Made& t,
    std::map<std::string, nonio::Setting, std::less<>> changed = {}) {
  nonio::Settings settings;
  for (const nonio::Option& o : a.info.options) settings.values[o.name] = o.default_value;
  for (auto& [name, value] : changed) settings.values[name] = value;
  auto out = a.analyse({t.campaign, t.campaign.measurements.front(), t.o, settings});
  return out ? *out : nonio::Evaluation{};
}

inline const nonio::Value* value(const nonio::Evaluation& e, const std::string& name) {
  for (const nonio::Value& v : e.values)
    if (v.name == name) return &v;
  return nullptr;
}

inline const nonio::Finding* finding(const nonio::Evaluation& e, const std::string& id) {
  for (const nonio::Finding& f : e.findings)
    if (f.id == id) return &f;
  return nullptr;
}

inline double evidence(const nonio::Finding& f, const std::string& name) {
  for (const nonio::Number& n : f.evidence)
    if (n.name == name) return n.value;
  return NAN;
}

}  // namespace heat
