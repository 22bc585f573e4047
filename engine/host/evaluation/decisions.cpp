// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "host/evaluation/evaluation.h"

namespace nonio::host::evaluation {

Decision decide(double value, double U, double tolerance, std::string_view rule) {
  const bool simple = rule == "ilac-g8-simple", guarded = rule == "ilac-g8-guarded";
  if (!std::isfinite(value) || !std::isfinite(U)) return Decision::cannot_be_decided;
  if (simple || guarded)
    return value <= (guarded ? tolerance - U : tolerance) ? Decision::conforms
                                                          : Decision::does_not_conform;
  if (value <= tolerance - U) return Decision::conforms;
  if (value > tolerance + U) return Decision::does_not_conform;
  return Decision::cannot_be_decided;
}

namespace {

/// One decision for each value of this name; empty if there is none.
std::vector<Conformity> decisions_on(const Campaign& campaign,
                                     const std::vector<Results::Analysed>& analyses,
                                     const Axis& axis, const std::string& measurement,
                                     const std::string& name, double tolerance) {
  std::vector<Conformity> out;
  for (const Results::Analysed& a : analyses)
    for (const Value& v : a.evaluation.values) {
      if (a.measurement != measurement || v.name != name) continue;
      Conformity c{.measurement = measurement,
                   .axis = axis.name,
                   .plugin = a.plugin,
                   .name = name,
                   .tolerance = tolerance,
                   .quantity = v.quantity,
                   .decision = Decision::cannot_be_decided,
                   .reason = {}};
      if (v.U && *v.U > 0.0) {
        c.decision =
            decide(std::fabs(v.value), *v.U, tolerance, campaign.certificate.decision_rule);
        if (c.decision == Decision::cannot_be_decided) c.reason = "near-limit";
      } else {
        c.reason = "no-uncertainty";
      }
      out.push_back(std::move(c));
    }
  return out;
}

}  // namespace

std::vector<Conformity> held_against_tolerances(const Campaign& campaign,
                                                const std::vector<Results::Analysed>& analyses) {
  std::vector<Conformity> out;
  for (const Axis& axis : campaign.machine.axes)
    for (const auto& [name, tolerance] : axis.tolerance) {
      const std::size_t before = out.size();
      for (const Measurement& m : campaign.measurements)
        if (m.axis == axis.name && m.kind == "axis")
          for (Conformity& c : decisions_on(campaign, analyses, axis, m.id, name, tolerance))
            out.push_back(std::move(c));
      if (out.size() == before)
        out.push_back({"", axis.name, "", name, tolerance, deviation_of(axis.rotary),
                       Decision::cannot_be_decided, "no-value"});
    }
  return out;
}

}  // namespace nonio::host::evaluation
