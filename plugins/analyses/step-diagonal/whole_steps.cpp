// SPDX-License-Identifier: Apache-2.0
//
// The four diagonals as they are drawn: deviations at whole steps, where the set-up angles of the
// mirror have no say (nu.u = 0), and what tables of the curves would leave of them.
#include "whole_steps.h"

#include <cmath>

namespace nonio::step_diagonal {

namespace {

/// Error of the point at i moves of each axis of a pass, less that of its start, along its beam.
double modelled(const math::StepDiagonals& d, const math::StepDiagonals::Pass& pass,
                const math::StepSolution& s, std::size_t i) {
  double sum = 0.0;
  const auto node = [&](std::size_t k, std::size_t moves) {
    return pass.sign[k] > 0 ? moves : d.n - moves;
  };
  const auto u = [&](std::size_t k) { return pass.sign[k] * d.travel[k] / d.diagonal(); };
  for (const math::StepCurve& c : s.curves) {
    const std::size_t along = static_cast<std::size_t>(c.name[1] - 'X');
    sum += u(along) * (c.value[node(c.axis, i)] - c.value[node(c.axis, 0)]);
  }
  const auto way = [&](std::size_t k) {
    return pass.sign[k] * d.travel[k] * static_cast<double>(i) / static_cast<double>(d.n);
  };
  sum -= u(0) * s.squareness[0].value * way(1);  // C0Y turns +Y towards -X
  sum += u(0) * s.squareness[1].value * way(2);  // B0Z turns +Z towards +X
  sum -= u(1) * s.squareness[2].value * way(2);  // A0Z turns +Z towards -Y
  return sum;
}

std::string short_name(const std::string& pass) {
  const std::size_t space = pass.rfind(' ');
  return space == std::string::npos ? pass : pass.substr(space + 1);
}

}  // namespace

std::vector<WholeSteps> whole_steps(const math::StepDiagonals& d, const math::StepSolution* s) {
  std::vector<WholeSteps> out;
  const bool known = s != nullptr && s->scales_known();
  for (const auto& pass : d.passes) {
    WholeSteps w;
    for (std::size_t i = 0; i <= d.n; ++i) {
      w.deviation.push_back(i == 0 ? 0.0 : pass.reading[3 * i - 1]);
      if (known) w.left.push_back(w.deviation.back() - modelled(d, pass, *s, i));
    }
    out.push_back(std::move(w));
  }
  return out;
}

PointTable whole_step_table(const Passes& p, const std::vector<WholeSteps>& steps) {
  PointTable table;
  table.columns.push_back({"target", Quantity::length, {}});
  for (std::size_t i = 0; i <= p.readings.n; ++i)
    table.columns.back().values.push_back(p.readings.diagonal() * static_cast<double>(i) /
                                          static_cast<double>(p.readings.n));
  for (std::size_t k = 0; k < steps.size(); ++k)
    table.columns.push_back({short_name(p.names[k]), Quantity::deviation, steps[k].deviation});
  for (std::size_t k = 0; k < steps.size(); ++k)
    if (!steps[k].left.empty())
      table.columns.push_back(
          {"left " + short_name(p.names[k]), Quantity::deviation, steps[k].left});
  return table;
}

LargestStep largest_step(const std::vector<WholeSteps>& steps, bool left) {
  LargestStep out;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const auto& values = left ? steps[k].left : steps[k].deviation;
    for (std::size_t i = 0; i < values.size(); ++i)
      if (std::fabs(values[i]) > out.value) out = {std::fabs(values[i]), k, i};
  }
  return out;
}

void put_whole_steps(const Passes& p, const math::StepSolution& s, const math::ReadingModel& model,
                     math::BudgetOf* budget, Evaluation& out) {
  const std::vector<WholeSteps> steps = whole_steps(p.readings, &s);
  const LargestStep most = largest_step(steps, false);
  const std::size_t each = 3 * p.readings.n + 1;
  if (budget != nullptr && most.step > 0) {
    // The reading there less that before the first move.
    std::vector<double> row(model.readings(), 0.0);
    row[most.pass * each + 3 * most.step] = 1.0;
    row[most.pass * each] = -1.0;
    out.values.push_back(budget->value("D_max", most.value, Quantity::deviation,
                                       std::sqrt(2.0) * s.u_reading, model.shares(row)));
  } else {
    out.values.push_back({"D_max", most.value, Quantity::deviation});
  }
  if (!steps.empty() && !steps.front().left.empty())
    out.values.push_back({"D_left", largest_step(steps, true).value, Quantity::deviation});
  bool whole = true;
  for (const WholeSteps& w : steps)
    for (const double v : w.deviation) whole = whole && std::isfinite(v);
  if (whole) out.points = whole_step_table(p, steps);
}

}  // namespace nonio::step_diagonal
