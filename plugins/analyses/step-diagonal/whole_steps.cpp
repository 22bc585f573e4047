// SPDX-License-Identifier: Apache-2.0
//
// The four diagonals as they are drawn: deviations at whole steps, where the set-up angles of the
// mirror have no say (nu.u = 0).
#include "whole_steps.h"

#include <cmath>

namespace nonio::step_diagonal {

namespace {

std::string short_name(const std::string& pass) {
  const std::size_t space = pass.rfind(' ');
  return space == std::string::npos ? pass : pass.substr(space + 1);
}

PointTable table_of(const Passes& p) {
  const math::StepDiagonals& d = p.readings;
  PointTable table;
  table.columns.push_back({"target", Quantity::length, {}});
  for (std::size_t i = 0; i <= d.n; ++i)
    table.columns.back().values.push_back(d.diagonal() * static_cast<double>(i) /
                                          static_cast<double>(d.n));
  for (std::size_t k = 0; k < d.passes.size(); ++k) {
    table.columns.push_back({short_name(p.names[k]), Quantity::deviation, {0.0}});
    for (std::size_t i = 1; i <= d.n; ++i)
      table.columns.back().values.push_back(d.passes[k].reading[3 * i - 1]);
  }
  return table;
}

}  // namespace

void put_whole_steps(const Passes& p, const math::StepSolution& s, const math::ReadingModel& model,
                     math::BudgetOf* budget, Evaluation& out) {
  PointTable table = table_of(p);
  double most = 0.0;
  std::size_t pass = 0, step = 0;
  bool whole = true;
  for (std::size_t k = 1; k < table.columns.size(); ++k)
    for (std::size_t i = 0; i <= p.readings.n; ++i) {
      const double v = table.columns[k].values[i];
      whole = whole && std::isfinite(v);
      if (std::fabs(v) > most) most = std::fabs(v), pass = k - 1, step = i;
    }
  if (budget != nullptr && step > 0) {
    // The reading there less that before the first move.
    std::vector<double> row(model.readings(), 0.0);
    const std::size_t zero = pass * (3 * p.readings.n + 1);
    row[zero + 3 * step] = 1.0;
    row[zero] = -1.0;
    out.values.push_back(budget->value("D_max", most, Quantity::deviation,
                                       std::sqrt(2.0) * s.u_reading, model.shares(row)));
  } else {
    out.values.push_back({"D_max", most, Quantity::deviation});
  }
  if (whole) out.points = std::move(table);
}

}  // namespace nonio::step_diagonal
