// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "pages.h"

namespace nonio::pages {

namespace {

bool has(const Results::Analysed& a, std::string_view id) {
  const auto& findings = a.evaluation.findings;
  return std::any_of(findings.begin(), findings.end(),
                     [&](const Finding& f) { return f.id == id; });
}

bool departs(const Results::Analysed& a) {
  const auto& findings = a.evaluation.findings;
  return std::any_of(findings.begin(), findings.end(), [](const Finding& f) {
    return (f.id.starts_with("plan.") && f.id != "plan.long-axis") || f.id == "direction.missing" ||
           f.id == "targets.unpaired";
  });
}

const Measurement* measurement_of(const OutputInput& in, const Results::Analysed& a) {
  for (const Measurement& m : in.campaign.measurements)
    if (m.id == a.measurement) return &m;
  return nullptr;
}

bool has_short_test(const OutputInput& in, const Results::Analysed& whole) {
  const Measurement* m = measurement_of(in, whole);
  if (m == nullptr) return false;
  return std::any_of(
      in.results.analyses.begin(), in.results.analyses.end(), [&](const Results::Analysed& other) {
        const Measurement* o = measurement_of(in, other);
        return &other != &whole && other.plugin == whole.plugin && o != nullptr &&
               o->axis == m->axis && o->kind == m->kind && o->adjustment == m->adjustment &&
               !departs(other) && !has(other, "plan.long-axis");
      });
}

}  // namespace

bool follows_plan(const OutputInput& in, const Results::Analysed& a) {
  return !departs(a) && (!has(a, "plan.long-axis") || has_short_test(in, a));
}

}  // namespace nonio::pages
