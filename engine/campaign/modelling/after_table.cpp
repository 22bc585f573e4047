// SPDX-License-Identifier: Apache-2.0
#include "campaign/modelling/after_table.h"

#include <algorithm>
#include <cmath>

#include "nonio/math/iso230_2.h"

namespace nonio::modelling {

namespace {

constexpr double k = 2.0;  // coverage factor of ISO 230-2 since 1997

/// Returns the weighted RMS about the mean of each line, without the parts of the set-up (zeros,
/// slopes, rotations).
double rms_about_zeros(const Observations& o, std::vector<double> values, const model::Fit& fit) {
  const std::vector<double>& weight = fit.weight;
  for (std::size_t t = 0; t < fit.terms.size(); ++t)
    if (fit.terms[t].effect->is_nuisance)
      for (std::size_t i = 0; i < values.size(); ++i) values[i] -= fit.part[t][i];
  const auto weight_of = [&](std::size_t i) { return i < weight.size() ? weight[i] : 1.0; };
  std::vector<double> sum(std::max<std::size_t>(o.lines.size(), 1)), weights(sum.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum[o.line_of(i)] += weight_of(i) * values[i];
    weights[o.line_of(i)] += weight_of(i);
  }
  double squares = 0.0, all = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(weight_of(i) > 0.0)) continue;
    const double left = values[i] - sum[o.line_of(i)] / weights[o.line_of(i)];
    squares += weight_of(i) * left * left;
    all += weight_of(i);
  }
  return all > 0.0 ? std::sqrt(squares / all) : std::nan("");
}

Observations readings_of(const model::Part& part, std::size_t measurement,
                         const std::vector<double>& deviation) {
  Observations o;
  o.angular = part.table.angular;
  o.axes.push_back({part.axes.front().name, part.axes.front().rotary, {}, {}});
  for (std::size_t i = 0; i < deviation.size(); ++i) {
    if (part.measurement[i] != measurement) continue;
    o.axes.front().position.push_back(part.along[i]);
    o.axes.front().approach.push_back(part.way[i]);
    o.deviation.push_back(deviation[i]);
    o.run.push_back(part.table.run_of(i));
  }
  return o;
}

AfterTable::Positioning positioning(const Observations& readings) {
  const auto result = math::evaluate_iso230_2(math::AxisTest::arrange(readings), k);
  return {result.E, result.A, result.R};
}

}  // namespace

AfterTable after_table(const PartModel& model, const model::Fit& fit) {
  const model::Part& part = model.part;
  AfterTable out;
  const std::vector<double> measured = model.measured();
  std::vector<double> left = measured;
  for (std::size_t t = 0; t < fit.terms.size(); ++t) {
    if (!fit.terms[t].effect->compensable) continue;
    out.effects.push_back(fit.terms[t].name());
    for (std::size_t i = 0; i < left.size(); ++i) left[i] -= fit.part[t][i];
  }
  out.rms_before = rms_about_zeros(part.table, measured, fit);
  out.rms = rms_about_zeros(part.table, left, fit);
  if (part.kind != model::Part::Kind::axis) return out;
  for (std::size_t m = 0; m < part.measurements.size(); ++m)
    out.tests.push_back({part.measurements[m], positioning(readings_of(part, m, measured)),
                         positioning(readings_of(part, m, left))});
  return out;
}

}  // namespace nonio::modelling
