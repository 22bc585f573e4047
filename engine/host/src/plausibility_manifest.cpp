// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>

#include "nonio/sdk/format.h"
#include "plausibility.h"
#include "traceability.h"

namespace nonio::host {
namespace {

constexpr double micrometre = 1e-6, arc_second = 1.0 / arcsec_per_rad;

/// What somebody stated, and what is ordinary. 0 is a statement too. Confidence of the bounds:
/// inferred; see docs/wrong-inputs.md.
struct Statement {
  std::string key;
  std::optional<double> value;
  double least, most;
  Quantity quantity;
};

std::vector<Statement> statements(const Campaign& c) {
  const Instrument& i = c.instrument;
  const Environment& e = c.environment;
  constexpr double finest = 1e-3 * micrometre, finest_angle = 1e-3 * arc_second;
  std::vector<Statement> all{
      {"instrument.U_fixed_um", i.U_fixed, finest, 200 * micrometre, Quantity::deviation},
      {"instrument.U_per_m_um", i.U_per_length, 1e-8, 5e-5, Quantity::deviation_per_length},
      {"instrument.U_arcsec", i.U_angle, finest_angle, 60 * arc_second,
       Quantity::angular_deviation},
      {"instrument.sphere_um", i.sphere, finest, 50 * micrometre, Quantity::deviation},
      {"instrument.probe_um", i.probe, finest, 100 * micrometre, Quantity::deviation},
      {"instrument.expansion_um_per_m_K", i.expansion, 1e-9, 3e-5, Quantity::expansion},
      {"instrument.temperature_range_K", i.temperature_range, 1e-3, 10,
       Quantity::temperature_difference},
      {"instrument.expansion_range_um_per_m_K", i.expansion_range, 1e-9, 6e-6, Quantity::expansion},
      {"environment.misalignment_mm", e.misalignment, 1e-6, 0.05, Quantity::length},
      {"environment.temperature_range_K", e.temperature_range, 1e-3, 10,
       Quantity::temperature_difference},
      {"environment.temperature_difference_K", e.temperature_difference, 1e-3, 15,
       Quantity::temperature_difference},
      {"environment.expansion_range_um_per_m_K", e.expansion_range, 1e-9, 6e-6,
       Quantity::expansion},
      {"environment.drift_um", e.drift, finest, 200 * micrometre, Quantity::deviation},
      {"environment.drift_arcsec", e.drift_angle, finest_angle, 120 * arc_second,
       Quantity::angular_deviation}};
  for (const Axis& a : c.machine.axes)
    all.push_back({"machine.axes." + a.name + ".expansion_um_per_m_K", a.expansion, -2e-6, 3e-5,
                   Quantity::expansion});
  return all;
}

/// A place of the axes that stood still, or an end of a diagonal, where the machine cannot be.
void implausible_places(const Campaign& c, std::vector<Finding>& out) {
  for (const Measurement& m : c.measurements)
    for (const auto* places : {&m.at, &m.from, &m.to})
      for (const auto& [name, place] : *places) {
        const Axis* axis = c.machine.axis(name);
        if (axis == nullptr || !axis->travel || axis->rotary) continue;
        const auto [from, to] = *axis->travel;
        const double spare = 0.02 * (to - from);
        if (place >= from - spare && place <= to + spare) continue;
        out.push_back({.id = "plausibility.place-outside-travel",
                       .attention = true,
                       .evidence = {{"place", place, Quantity::length},
                                    {"from", from, Quantity::length},
                                    {"to", to, Quantity::length}},
                       .texts = {{"axis", name}, {"of", m.id}}});
      }
}

}  // namespace

std::vector<Finding> implausible_campaign(const Manifest& manifest, const std::string& today) {
  std::vector<Finding> out;
  const Campaign& c = manifest.campaign;
  for (const std::string& axis : manifest.undeclared_axes) {
    std::string known;
    for (const Axis& a : c.machine.axes)
      if (std::find(manifest.undeclared_axes.begin(), manifest.undeclared_axes.end(), a.name) ==
          manifest.undeclared_axes.end())
        known += (known.empty() ? "" : ", ") + a.name;
    out.push_back({.id = "plausibility.unknown-axis",
                   .attention = true,
                   .texts = {{"axis", axis}, {"known", known}}});
  }
  for (const auto& [key, day] :
       {std::pair{"campaign.date", &c.date}, {"campaign.end_date", &c.end_date}})
    if (!today.empty() && *day > today)
      out.push_back({.id = "plausibility.day-to-come",
                     .attention = true,
                     .texts = {{"key", key}, {"day", *day}, {"today", today}}});
  for (Finding& f : traceability_findings(c))
    if (f.id == "traceability.calibrated-later") {
      f.id = "plausibility.calibrated-later";
      out.push_back(std::move(f));
    }
  for (const Statement& s : statements(c))
    if (s.value && *s.value != 0.0 && (*s.value < s.least || *s.value > s.most))
      out.push_back({.id = "plausibility.unusual-statement",
                     .attention = true,
                     .evidence = {{"value", *s.value, s.quantity},
                                  {"least", s.least, s.quantity},
                                  {"most", s.most, s.quantity}},
                     .texts = {{"key", s.key}}});
  implausible_places(c, out);
  return out;
}

}  // namespace nonio::host
