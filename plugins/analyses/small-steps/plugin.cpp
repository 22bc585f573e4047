// SPDX-License-Identifier: Apache-2.0
// Small steps of a linear axis: deviations of the shortest and the longest step, and the loss of
// the first step after a reversal.
#include "nonio/sdk/plugin.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "nonio/math/differences.h"
#include "nonio/math/fine_motion.h"

namespace nonio::small_steps {
namespace {

using math::Difference;
using math::SmallSteps;
using math::SteppedReading;

bool applies(const Campaign& c, const Measurement& m) {
  if (m.kind != "axis") return false;
  const Axis* axis = c.machine.axis(m.axis);
  return axis == nullptr || !axis->rotary;
}

Difference of_step(const SmallSteps& all, const SmallSteps::One& s, std::string name) {
  return {.name = std::move(name),
          .value = s.error,
          .u = all.s,
          .dof = all.dof,
          .from = s.from,
          .to = s.to,
          .scale = static_cast<double>(s.direction)};
}

PointTable table(const SmallSteps& all) {
  struct Errors {
    double least = NAN, largest = NAN;
    void add(double e) {
      least = std::isnan(least) ? e : std::min(least, e);
      largest = std::isnan(largest) ? e : std::max(largest, e);
    }
  };
  std::map<double, std::array<Errors, 2>> targets;
  for (const SmallSteps::One& s : all.steps)
    targets[s.position][s.direction > 0 ? 0 : 1].add(s.error);
  PointTable out;
  out.columns = {{"target", Quantity::length, {}},
                 {"least+", Quantity::deviation, {}},
                 {"largest+", Quantity::deviation, {}},
                 {"least-", Quantity::deviation, {}},
                 {"largest-", Quantity::deviation, {}}};
  for (const auto& [target, errors] : targets) {
    out.columns[0].values.push_back(target);
    for (std::size_t k = 0; k < 2; ++k) {
      out.columns[1 + 2 * k].values.push_back(errors[k].least);
      out.columns[2 + 2 * k].values.push_back(errors[k].largest);
    }
  }
  return out;
}

Number count(const char* name, std::size_t n) {
  return {name, static_cast<double>(n), Quantity::count};
}

void judge(const SmallSteps& all, Evaluation& e) {
  if (all.not_followed > 0)
    e.findings.push_back({.id = "small-steps.not-followed",
                          .attention = true,
                          .evidence = {count("steps", all.not_followed),
                                       count("of", all.steps.size()),
                                       {"commanded", all.commanded, Quantity::deviation}}});
  if (all.least_first == all.steps.size())
    e.findings.push_back({.id = "small-steps.no-reversal", .attention = false});
  if (!(all.dof > 0.0)) e.findings.push_back({.id = "small-steps.no-repeats", .attention = false});
}

Expected<Evaluation> analyse(const AnalysisInput& in) {
  const Observations& o = in.observations;
  if (o.axes.empty() || o.axes.front().approach.size() != o.size())
    return fail("measurement \"" + in.measurement.id + "\": expected directions of approach");
  std::vector<SteppedReading> readings;
  for (std::size_t i = 0; i < o.size(); ++i)
    if (o.axes.front().approach[i] != 0 && std::isfinite(o.deviation[i]))
      readings.push_back(
          {o.axes.front().position[i], o.deviation[i], o.run_of(i), o.axes.front().approach[i]});
  const SmallSteps all = math::small_steps(readings);
  Evaluation e;
  if (all.answer != SmallSteps::Answer::given) {
    e.findings.push_back({.id = all.answer == SmallSteps::Answer::several_sizes
                                    ? "small-steps.several-sizes"
                                    : "small-steps.too-few",
                          .attention = true});
    return e;
  }
  std::vector<Difference> items;
  const auto put = [&](const char* name, std::size_t i) {
    items.push_back(of_step(all, all.steps[i], name));
  };
  put("step_error_min", all.least), put("step_error_max", all.largest);
  if (all.least_first < all.steps.size()) put("step_error_reversal", all.least_first);
  math::put_differences(in.campaign, items, e);
  e.points = table(all);
  judge(all, e);
  e.notes.push_back({"method.small-steps", {{"commanded", all.commanded, Quantity::deviation}}});
  return e;
}

}  // namespace

NONIO_PLUGIN(registry) {
  Analysis a;
  a.info = {"small-steps",
            "1.0.0",
            "Small steps of a linear axis: deviation of the shortest and of the longest step.",
            {},
            true};
  a.applies = applies;
  a.analyse = analyse;
  a.states_followed = true;
  registry.add(std::move(a));
}

}  // namespace nonio::small_steps
