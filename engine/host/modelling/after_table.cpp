// SPDX-License-Identifier: Apache-2.0
#include "host/modelling/after_table.h"

#include <cmath>

#include "nonio/math/iso230_2.h"

namespace nonio::host::modelling {

namespace {

constexpr double k = 2.0;  // ISO 230-2 since 1997

double rms_of(const std::vector<double>& values, const std::vector<double>& weight) {
  double sum = 0.0, weights = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double w = i < weight.size() ? weight[i] : 1.0;
    sum += w * values[i] * values[i];
    weights += w;
  }
  return weights > 0.0 ? std::sqrt(sum / weights) : std::nan("");
}

/// The readings of one measurement, along its axis.
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

AfterTable after_table(const model::Part& part, const model::Fit& fit) {
  AfterTable out;
  const std::vector<double>& measured = part.table.deviation;
  std::vector<double> left = measured;
  for (std::size_t t = 0; t < fit.terms.size(); ++t) {
    if (!fit.terms[t].effect->compensable) continue;
    out.effects.push_back(fit.terms[t].name());
    for (std::size_t i = 0; i < left.size(); ++i) left[i] -= fit.part[t][i];
  }
  out.rms_before = rms_of(measured, fit.weight);
  out.rms = rms_of(left, fit.weight);
  if (part.kind != model::Part::Kind::axis) return out;
  for (std::size_t m = 0; m < part.measurements.size(); ++m)
    out.tests.push_back({part.measurements[m], positioning(readings_of(part, m, measured)),
                         positioning(readings_of(part, m, left))});
  return out;
}

}  // namespace nonio::host::modelling
