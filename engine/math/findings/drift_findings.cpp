// SPDX-License-Identifier: Apache-2.0
//
// Drift: passes that shift in the same direction from run to run.
//   o_j, q_j   offset and slope of run j (mean of its passes; model of pass_model.h), m and m/m
//   trend      line through o_j (or q_j) over the run number, t test at 1 % with n - 2 degrees of
//              freedom, so that offsets that are random from run to run are no drift
//   or         five runs or more, each further in the same direction than the one before (by chance
//              2/n!, 1.7 % for n = 5), and the line through the single passes significant at 1 %:
//              a machine that warms up does not drift in a straight line
//   and        the shift from the first run to the last exceeds the scatter of a single reading
// A drift of less than a fifth of A is information: it is in the scatter already.
// Parallel: the whole travel shifts. Wedge: the far end shifts, the near end does not.
#include <algorithm>
#include <cmath>
#include <vector>

#include "axis/pass_model.h"
#include "common/constants.h"
#include "common/finding_builder.h"
#include "nonio/math/axis_findings.h"
#include "nonio/math/distributions.h"
#include "nonio/math/statistics.h"

namespace nonio::math {
namespace {

struct Runs {  // by run; of passes: one entry each
  std::vector<double> number, y;
  std::vector<double> pass_number[2], pass_y[2];
};

struct Trend {
  bool found = false;
  double per_run = 0.0, total = 0.0, p = 1.0;
};

struct Line {
  double slope = 0.0, t = 0.0, dof = 0.0;
};

// One slope, an intercept for each group.
Line common_line(
    const std::vector<std::pair<const std::vector<double>*, const std::vector<double>*>>& groups) {
  double xx = 0.0, xy = 0.0, yy = 0.0, n = 0.0, used = 1.0;
  for (const auto& [x, y] : groups) {
    if (x->empty()) continue;
    const double x_mean = mean(*x), y_mean = mean(*y);
    for (std::size_t k = 0; k < x->size(); ++k) {
      const double dx = (*x)[k] - x_mean, dy = (*y)[k] - y_mean;
      xx += dx * dx, xy += dx * dy, yy += dy * dy;
    }
    n += static_cast<double>(x->size());
    used += 1.0;
  }
  Line line;
  if (!(xx > 0.0)) return line;
  line.slope = xy / xx;
  line.dof = n - used;
  const double left = std::max(0.0, yy - xy * line.slope);
  line.t = line.dof > 0.0 ? test_ratio(line.slope, std::sqrt(left / line.dof / xx)) : 0.0;
  return line;
}

Runs by_run(const PassModel& model, bool slopes) {
  Runs runs;
  for (std::size_t p = 0; p + 1 < model.passes.size(); p += 2) {
    double sum = 0.0, n = 0.0;
    for (std::size_t d = 0; d < 2; ++d) {
      const auto& pass = model.passes[p + d];
      if (pass.readings == 0) continue;
      const double y = slopes ? pass.slope : pass.offset;
      runs.pass_number[d].push_back(pass.run);
      runs.pass_y[d].push_back(y);
      sum += y, n += 1.0;
    }
    runs.number.push_back(model.passes[p].run);
    runs.y.push_back(sum / n);
  }
  return runs;
}

bool monotone(const std::vector<double>& y) {
  bool up = true, down = true;
  for (std::size_t j = 1; j < y.size(); ++j) {
    up = up && y[j] > y[j - 1];
    down = down && y[j] < y[j - 1];
  }
  return up || down;
}

Trend trend_of(const Runs& runs) {
  Trend trend;
  if (runs.number.size() < 3) return trend;
  const Line of_runs = common_line({{&runs.number, &runs.y}});
  const Line of_passes = common_line(
      {{&runs.pass_number[0], &runs.pass_y[0]}, {&runs.pass_number[1], &runs.pass_y[1]}});
  trend.per_run = of_runs.slope;
  trend.total = of_runs.slope * (runs.number.back() - runs.number.front());
  trend.p = t_two_sided(of_runs.t, of_runs.dof);
  trend.found = significant(trend.p, significance);
  const double p_passes = t_two_sided(of_passes.t, of_passes.dof);
  if (!trend.found && runs.y.size() >= 5 && monotone(runs.y) &&
      significant(p_passes, significance)) {
    trend.found = true;
    trend.p = p_passes;
  }
  return trend;
}

double scatter_of_reading(const PassModel& model) {
  double squares = 0.0, dof = 0.0;
  for (const auto& side : model.side)
    if (side.readings > 0) squares += side.squares, dof += side.dof;
  return dof > 0.0 ? std::sqrt(squares / dof) : 0.0;
}

}  // namespace

void drift_findings(const AxisTest& test, std::vector<Finding>& findings) {
  if (test.targets.size() < 2 || test.most_approaches() < 3) return;
  const bool slopes = test.targets.size() >= 4;
  const PassModel model = fit_passes(test, slopes);
  const double scatter = std::max(scatter_of_reading(model), rounding);
  const Trend shift = trend_of(by_run(model, false));
  const Trend turn = slopes ? trend_of(by_run(model, true)) : Trend{};
  const double wedge = turn.total * test.length();
  const double near = shift.total + turn.total * (test.targets.front() - model.middle);
  const double far = shift.total + turn.total * (test.targets.back() - model.middle);
  const double largest = std::max(std::fabs(near), std::fabs(far));
  const double common = near * far > 0.0 ? std::min(std::fabs(near), std::fabs(far)) : 0.0;

  const bool is_wedge =
      turn.found && std::fabs(wedge) > scatter && std::fabs(wedge) >= 0.25 * largest;
  const bool is_parallel = shift.found && std::fabs(shift.total) > scatter &&
                           (!is_wedge || common > std::max(scatter, 0.5 * std::fabs(wedge)));
  const std::size_t runs = model.passes.size() / 2;  // one pass each way
  // The directions of a run follow one another, so the mean shift of half a run is in B_mean.
  const double in_B = std::fabs(shift.per_run) / 2.0;
  const auto finding = [&](const char* id, double total, const Trend& trend, double per_run) {
    return FindingBuilder(id, matters(test, std::fabs(total)), test.rotary)
        .deviation("total", total)
        .deviation("per_run", per_run)
        .slope("wedge", turn.total)
        .deviation("in_B", in_B)
        .deviation("scatter", scatter)
        .number("p", trend.p, Quantity::probability)
        .count("runs", static_cast<double>(runs))
        .done();
  };
  if (is_parallel) findings.push_back(finding("drift.parallel", shift.total, shift, shift.per_run));
  if (is_wedge)
    findings.push_back(finding("drift.wedge", wedge, turn, turn.per_run * test.length()));
}

}  // namespace nonio::math
