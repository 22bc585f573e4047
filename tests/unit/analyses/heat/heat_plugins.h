// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "loaded_analysis.h"
#include "nonio/sdk/plugin.h"

/// The three analyses as the host has them.
namespace heat {

inline const nonio::Analysis& thermal() {
  static const nonio::Analysis analysis = nonio::loaded_analysis(NONIO_ANALYSES, "thermal");
  return analysis;
}
inline const nonio::Analysis& spindle() {
  static const nonio::Analysis analysis = nonio::loaded_analysis(NONIO_ANALYSES, "spindle");
  return analysis;
}
inline const nonio::Analysis& lengths() {
  static const nonio::Analysis analysis = nonio::loaded_analysis(NONIO_ANALYSES, "lengths");
  return analysis;
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
