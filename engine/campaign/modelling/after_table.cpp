// SPDX-License-Identifier: Apache-2.0
#include "campaign/modelling/after_table.h"

#include <cmath>

#include "nonio/math/iso230_2.h"

namespace nonio::modelling {

namespace {

constexpr double k = 2.0;  // coverage factor of ISO 230-2 since 1997

/// Returns the weighted RMS of what the set-up (zeros, slopes, rotations) does not explain. It is
/// fitted to these values, because their RMS must not depend on the other effects of the model.
double rms_of(Observations o, const std::vector<double>& values, const model::Fit& fit) {
  o.deviation = values;
  std::vector<model::Term> set_up;
  for (const model::Term& term : fit.terms)
    if (term.effect->is_nuisance) set_up.push_back(term);
  const auto fitted = model::fit(o, std::move(set_up), fit.weight);
  return fitted ? fitted->rms : std::nan("");
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

/// Returns the prediction of a term that one table of the axis can compensate. Of values of each
/// measurement, such as of several lines, this is their mean; `name` is then without the group.
std::vector<double> of_one_table(const model::Part& part, const model::Fit& fit, std::size_t t,
                                 std::string& name) {
  model::Term term = fit.terms[t];
  if (!term.grouping || term.grouping->by != "measurement" || term.differences) return fit.part[t];
  const auto columns = term.effect->columns(part.table, term.axis, term.shape);
  if (!columns || columns->empty()) return fit.part[t];
  std::vector<double> mean(columns->size(), 0.0);
  std::size_t values = 0;
  const auto groups = static_cast<double>(term.grouping->name.size());
  for (const model::Parameter& p : fit.parameters)
    if (p.effect == name && !p.shape) mean[values++ % mean.size()] += p.value / groups;
  term.grouping.reset(), name = term.name();
  std::vector<double> out(part.table.size(), 0.0);
  for (std::size_t c = 0; c < mean.size(); ++c)
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += mean[c] * (*columns)[c][i];
  return out;
}

}  // namespace

AfterTable after_table(const PartModel& model, const model::Fit& fit) {
  const model::Part& part = model.part;
  AfterTable out;
  const std::vector<double> measured = model.measured();
  std::vector<double> left = measured;
  for (std::size_t t = 0; t < fit.terms.size(); ++t) {
    if (!fit.terms[t].effect->compensable) continue;
    std::string& name = out.effects.emplace_back(fit.terms[t].name());
    const std::vector<double> said = of_one_table(part, fit, t, name);
    for (std::size_t i = 0; i < left.size(); ++i) left[i] -= said[i];
  }
  out.rms_before = rms_of(part.table, measured, fit);
  out.rms = rms_of(part.table, left, fit);
  if (part.kind != model::Part::Kind::axis) return out;
  for (std::size_t m = 0; m < part.measurements.size(); ++m)
    out.tests.push_back({part.measurements[m], positioning(readings_of(part, m, measured)),
                         positioning(readings_of(part, m, left))});
  return out;
}

}  // namespace nonio::modelling
