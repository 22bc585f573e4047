// SPDX-License-Identifier: Apache-2.0
//
// A warm start, and a later origin of time, change the amplitude of 1 - exp(-t/tau), but not tau.
// Several tests of one axis give the mean of ln tau with weights 1/u^2.
#include "thermal_tests.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "nonio/math/thermal.h"
#include "nonio/sdk/axis_readings.h"
#include "nonio/sdk/check.h"

namespace nonio::model {

namespace {

struct OfTest {
  std::string measurement;
  double ln_tau = 0.0, u = 0.0;
  bool given = false;
};

OfTest of_test(const Measurement& m, const Observations& o) {
  OfTest out{m.id};
  const auto timed = [](double t) { return std::isfinite(t); };
  if (o.time.size() != o.size() || !std::all_of(o.time.begin(), o.time.end(), timed)) return out;
  const math::Track growth = math::growth(math::visits_of(o));
  if (growth.size() < 2) return out;
  const auto fit = math::time_constants(growth);
  // Only a single time constant is used, because the effects that use it have exactly one.
  if (fit.answer != math::TimeConstants::Answer::resolved || fit.parts.size() != 1) return out;
  const auto& part = fit.parts.front();
  if (!(part.tau > 0.0) || !(part.u_tau > 0.0)) return out;
  return {m.id, std::log(part.tau), part.u_tau / part.tau, true};
}

TimeConstant together(const std::string& axis, const std::vector<OfTest>& tests) {
  TimeConstant out{axis, {}};
  double weights = 0.0, sum = 0.0;
  for (const OfTest& a : tests) {
    if (!a.given) continue;
    out.measurements.push_back(a.measurement);
    out.state = out.state == TimeConstant::State::none ? TimeConstant::State::known : out.state;
    weights += 1.0 / (a.u * a.u), sum += a.ln_tau / (a.u * a.u);
    for (const OfTest& b : tests)
      if (b.given && std::fabs(a.ln_tau - b.ln_tau) > time_constants_apart * std::hypot(a.u, b.u))
        out.state = TimeConstant::State::contradictory;
  }
  if (out.state == TimeConstant::State::none)
    for (const OfTest& one : tests) out.measurements.push_back(one.measurement);
  if (out.state != TimeConstant::State::known) return out;
  out.tau = std::exp(sum / weights);
  out.u = out.tau / std::sqrt(weights);
  return out;
}

}  // namespace

std::optional<std::size_t> time_constant_shape(const Effect& effect) {
  if (effect.linear.size() != 1 || effect.instances || effect.curve ||
      effect.linear.front().quantity != Quantity::deviation_per_length)
    return {};
  for (std::size_t k = 0; k < effect.shapes.size(); ++k) {
    const Effect::Shape& shape = effect.shapes[k];
    if (shape.continuous && shape.parameter.name == "tau" &&
        shape.parameter.quantity == Quantity::time)
      return k;
  }
  return {};
}

bool has_stated(const Term& term) {
  return term.stated && term.stated->shape < term.shape.size() &&
         term.shape[term.stated->shape] == term.stated->value;
}

void put_time_constants(const Campaign& campaign, const std::vector<Observations>& read,
                        std::vector<Part>& parts) {
  std::map<std::string, std::vector<OfTest>> tests;
  for (std::size_t m = 0; m < std::min(campaign.measurements.size(), read.size()); ++m) {
    const Measurement& one = campaign.measurements[m];
    if (one.motion != Measurement::Motion::time || one.axis.empty() || read[m].size() == 0 ||
        !check(read[m]))
      continue;
    const Axis* axis = campaign.machine.axis(one.axis);
    if (axis == nullptr || axis->rotary) continue;
    if (std::none_of(parts.begin(), parts.end(), [&](const Part& part) {
          return part.kind != Part::Kind::balls && part.table.axis(one.axis) != nullptr;
        }))
      continue;
    tests[one.axis].push_back(of_test(one, read[m]));
  }
  for (const auto& [axis, all] : tests) {
    const TimeConstant of_axis = together(axis, all);
    for (Part& part : parts)
      if (part.kind != Part::Kind::balls && part.table.axis(axis) != nullptr)
        part.time_constants.push_back(of_axis);
  }
}

std::optional<Term::Stated> stated_time_constant(const Part& part, const Effect& effect,
                                                 const Axis& axis) {
  const auto known = std::find_if(
      part.time_constants.begin(), part.time_constants.end(), [&](const TimeConstant& one) {
        return one.axis == axis.name && one.state == TimeConstant::State::known;
      });
  if (known == part.time_constants.end()) return {};
  const auto shape = time_constant_shape(effect);
  const auto readings = readings_of(part.table, axis);
  if (!shape || !readings || !readings->timed) return {};
  const std::vector<double> grid = effect.shapes[*shape].grid(part.table, axis);
  if (grid.size() < 2 || known->tau < grid.front() || known->tau > grid.back()) return {};
  return Term::Stated{*shape, known->tau, known->u};
}

}  // namespace nonio::model
