// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/drift.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/constants.h"
#include "drift_parts.h"
#include "nonio/math/distributions.h"
#include "nonio/math/statistics.h"
#include "pass_model.h"

namespace nonio::math {
namespace {

struct Runs {
  std::vector<double> time, y;
  std::vector<double> pass_time[2], pass_y[2];
  std::vector<double> pair_time, pair_y;  ///< + minus - of each run
};

// Part of the number of runs that is the time constant: docs/dev/constants.md, M60.
constexpr double time_constants[] = {INFINITY, 1.0, 0.5, 0.25};

// Course of a drift over the time t since the first run, in runs; its slope is 1 at the start.
double course_at(double t, double time_constant) {
  return std::isinf(time_constant) ? t : time_constant * -std::expm1(-t / time_constant);
}

// Time of a target in its run, in runs: the first pass goes up if it has direction +, otherwise down.
struct Timing {
  double targets = 0.0, first_run = 0.0;
  bool minus_first = false;
  double of(std::size_t i, std::size_t d) const {
    const double share = (static_cast<double>(i) + 0.5) / (2.0 * targets);
    return (d == 0) != minus_first ? (d == 0 ? share : 0.5 - share)
                                   : (d == 0 ? 0.5 + share : 1.0 - share);
  }
  double of_pass(std::size_t d) const { return (d == 0) != minus_first ? 0.25 : 0.75; }
};

struct Line {
  double slope = 0.0, t = 0.0, dof = 0.0, xx = 0.0, variance = 0.0;
};

using Groups = std::vector<std::pair<const std::vector<double>*, const std::vector<double>*>>;

// Fits one slope with a separate intercept for each group.
Line common_line(const Groups& groups) {
  double xy = 0.0, yy = 0.0, n = 0.0, used = 1.0;
  Line line;
  for (const auto& [x, y] : groups) {
    if (x->empty()) continue;
    const double x_mean = mean(*x), y_mean = mean(*y);
    for (std::size_t k = 0; k < x->size(); ++k) {
      const double dx = (*x)[k] - x_mean, dy = (*y)[k] - y_mean;
      line.xx += dx * dx, xy += dx * dy, yy += dy * dy;
    }
    n += static_cast<double>(x->size());
    used += 1.0;
  }
  if (!(line.xx > 0.0)) return line;
  line.slope = xy / line.xx;
  line.dof = n - used;
  if (line.dof > 0.0) line.variance = std::max(0.0, yy - xy * line.slope) / line.dof;
  line.t = line.dof > 0.0 ? test_ratio(line.slope, std::sqrt(line.variance / line.xx)) : 0.0;
  return line;
}

Runs by_run(const PassModel& model, const Timing& timing, double time_constant, bool slopes) {
  Runs runs;
  for (std::size_t p = 0; p + 1 < model.passes.size(); p += 2) {
    double sum = 0.0, n = 0.0;
    for (std::size_t d = 0; d < 2; ++d) {
      const auto& pass = model.passes[p + d];
      if (pass.readings == 0) continue;
      const double y = slopes ? pass.slope : pass.offset;
      const double t = pass.run - timing.first_run + timing.of_pass(d);
      runs.pass_time[d].push_back(course_at(t, time_constant));
      runs.pass_y[d].push_back(y);
      sum += y, n += 1.0;
    }
    if (n == 0.0) continue;
    if (n == 2.0) {
      runs.pair_time.push_back(runs.pass_time[0].back() - runs.pass_time[1].back());
      runs.pair_y.push_back(runs.pass_y[0].back() - runs.pass_y[1].back());
    }
    runs.time.push_back(course_at(model.passes[p].run - timing.first_run + 0.5, time_constant));
    runs.y.push_back(sum / n);
  }
  return runs;
}

bool goes_one_way(const std::vector<double>& y) {
  bool up = true, down = true;
  for (std::size_t j = 1; j < y.size(); ++j) {
    up = up && y[j] > y[j - 1];
    down = down && y[j] < y[j - 1];
  }
  return up || down;
}

// `per_pass`: variance of the offset or slope of a pass, from the scatter of single readings.
Drift::Part part_of(const Runs& runs, double per_pass, double dof) {
  Drift::Part part;
  const Line passes =
      common_line({{&runs.pass_time[0], &runs.pass_y[0]}, {&runs.pass_time[1], &runs.pass_y[1]}});
  if (!(passes.xx > 0.0) || runs.time.size() < 2) return part;
  part.known = true;
  part.per_run = passes.slope;
  part.total = passes.slope * (runs.time.back() - runs.time.front());
  part.dof = passes.dof;
  part.variance = passes.variance;
  part.of_scatter = per_pass;
  part.u = std::sqrt(std::max(per_pass, passes.variance) / passes.xx);
  if (dof > 0.0)
    part.p_scatter = t_two_sided(test_ratio(passes.slope, std::sqrt(per_pass / passes.xx)), dof);
  if (passes.dof > 0.0) part.p_passes = t_two_sided(passes.t, passes.dof);
  if (runs.time.size() >= 3) {
    const Line of_runs = common_line({{&runs.time, &runs.y}});
    part.p_runs = t_two_sided(of_runs.t, of_runs.dof);
  }
  const Line of_pairs = common_line({{&runs.pair_time, &runs.pair_y}});
  if (of_pairs.xx > rounding && dof > 0.0 && runs.time.size() >= 3) {
    part.seen_in_pairs = test_ratio(of_pairs.slope, passes.slope);
    part.p_pairs =
        t_two_sided(test_ratio(of_pairs.slope, std::sqrt(2.0 * per_pass / of_pairs.xx)), dof);
  }
  part.monotone = goes_one_way(runs.y);
  const Line one[2] = {common_line({{&runs.pass_time[0], &runs.pass_y[0]}}),
                       common_line({{&runs.pass_time[1], &runs.pass_y[1]}})};
  if (one[0].xx > 0.0 && one[1].xx > 0.0)
    part.agree = std::fabs(one[0].slope - one[1].slope) <= std::fabs(one[0].slope + one[1].slope);
  return part;
}

// Returns whether the rows of the first run contain all of direction - before direction +.
bool minus_first(const AxisTest& test) {
  std::uint32_t low[2] = {UINT32_MAX, UINT32_MAX}, high[2] = {0, 0};
  const std::uint32_t run = test.readings().empty() ? 0 : test.readings().front().run;
  for (std::size_t i = 0; i < test.targets.size(); ++i)
    for (const std::size_t d : {0U, 1U})
      for (const auto& reading : d == 0 ? test.plus(i) : test.minus(i)) {
        if (reading.run != run) continue;
        low[d] = std::min(low[d], reading.row), high[d] = std::max(high[d], reading.row);
      }
  return high[1] < low[0];
}

Timing timing_of(const AxisTest& test, const PassModel& model) {
  return {static_cast<double>(test.targets.size()),
          model.passes.empty() ? 0.0 : static_cast<double>(model.passes.front().run),
          minus_first(test)};
}

// Fits B_i = constant + fraction b_i, because drift within the passes adds b_i to the reversal.
void compare_with_reversal(const AxisTest& test, double variance, double dof, Drift& drift) {
  std::vector<double> B, b;
  double per = 0.0;
  const double m = static_cast<double>(test.targets.size());
  for (std::size_t i = 0; i < test.targets.size(); ++i) {
    const auto plus = test.plus(i), minus = test.minus(i);
    if (plus.empty() || minus.empty()) continue;
    B.push_back(mean(deviations(plus)) - mean(deviations(minus)));
    b.push_back(drift.per_run_at(test.targets[i]) * drift.lag(i));
    drift.in_B_mean += b.back() / m;
    per += 1.0 / static_cast<double>(plus.size()) + 1.0 / static_cast<double>(minus.size());
  }
  if (B.size() < 3 || !(dof > 0.0)) return;
  const double B_mean = mean(B), b_mean = mean(b);
  double bb = 0.0, bB = 0.0;
  for (std::size_t i = 0; i < B.size(); ++i)
    bb += squared(b[i] - b_mean), bB += (b[i] - b_mean) * (B[i] - B_mean);
  if (!(bb > 0.0)) return;
  drift.seen_in_reversal = bB / bb;
  const double of_B = variance * per / static_cast<double>(B.size());
  drift.p_reversal = t_two_sided(test_ratio(drift.seen_in_reversal, std::sqrt(of_B / bb)), dof);
}

void put_course(const AxisTest& test, const Timing& timing, Drift& drift) {
  for (const std::size_t d : {0U, 1U})
    for (std::size_t i = 0; i < test.targets.size(); ++i) {
      std::vector<double> courses;
      for (const auto& reading : d == 0 ? test.plus(i) : test.minus(i))
        courses.push_back(
            course_at(reading.run - timing.first_run + timing.of(i, d), drift.time_constant));
      const double s = courses.size() > 1 ? standard_deviation(courses) : 0.0;
      drift.course[d].push_back({courses.empty() ? 0.0 : mean(courses), s * s});
    }
}

std::vector<Drift> fit_drifts(const AxisTest& test) {
  if (test.targets.size() < 2 || test.most_approaches() < 2) return {};
  const bool slopes = test.targets.size() >= 4;
  const PassModel model = fit_passes(test, slopes);
  double squares = 0.0, dof = 0.0, passes = 0.0, readings = 0.0, spread = 0.0;
  for (const auto& side : model.side) {
    if (side.readings > 0 && side.passes > 1) squares += side.squares, dof += side.dof;
    passes += static_cast<double>(side.passes), readings += static_cast<double>(side.readings);
  }
  for (const double x : test.targets) spread += squared(x - model.middle);
  const double filled = readings / passes / static_cast<double>(test.targets.size()),
               variance = dof > 0.0 ? squares / dof : 0.0;
  const Timing timing = timing_of(test, model);
  std::vector<Drift> out;
  for (const double part : time_constants) {
    Drift& drift = out.emplace_back();
    drift.scatter = std::sqrt(variance), drift.scatter_dof = dof;
    drift.middle = model.middle;
    const Runs even = by_run(model, timing, INFINITY, false);
    drift.runs = even.time.size();
    drift.time_constant = part * static_cast<double>(drift.runs);
    drift.offset = part_of(by_run(model, timing, drift.time_constant, false),
                           variance * passes / readings, dof);
    if (slopes)
      drift.slope = part_of(by_run(model, timing, drift.time_constant, true),
                            variance / (spread * filled), dof);
    put_course(test, timing, drift);
    compare_with_reversal(test, variance, dof, drift);
    if (!drift.offset.known) return {};
  }
  return out;
}

}  // namespace

double Drift::u_at(double x) const { return std::hypot(offset.u, slope.u * (x - middle)); }

double Drift::misfit() const {
  const auto chi2 = [](const Part& part) {
    return part.known ? test_ratio(part.dof * part.variance, part.of_scatter) : 0.0;
  };
  return chi2(offset) + chi2(slope);
}

std::vector<Drift> estimate_drifts(const AxisTest& test) { return kept<fit_drifts>(test); }

}  // namespace nonio::math
