// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/drift.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "nonio/math/distributions.h"
#include "nonio/math/reversal.h"
#include "nonio/math/statistics.h"
#include "pass_model.h"

namespace nonio::math {
namespace {

struct Runs {
  std::vector<double> number, y;
  std::vector<double> pass_number[2], pass_y[2];
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
    if (n == 0.0) continue;
    runs.number.push_back(model.passes[p].run);
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
  const Line passes = common_line(
      {{&runs.pass_number[0], &runs.pass_y[0]}, {&runs.pass_number[1], &runs.pass_y[1]}});
  if (!(passes.xx > 0.0) || runs.number.size() < 2) return part;
  part.known = true;
  part.per_run = passes.slope;
  part.total = passes.slope * (runs.number.back() - runs.number.front());
  part.u = std::sqrt(std::max(per_pass, passes.variance) / passes.xx);
  if (dof > 0.0)
    part.p_scatter = t_two_sided(test_ratio(passes.slope, std::sqrt(per_pass / passes.xx)), dof);
  if (passes.dof > 0.0) part.p_passes = t_two_sided(passes.t, passes.dof);
  if (runs.number.size() >= 3) {
    const Line of_runs = common_line({{&runs.number, &runs.y}});
    part.p_runs = t_two_sided(of_runs.t, of_runs.dof);
  }
  part.monotone = goes_one_way(runs.y);
  const Line one[2] = {common_line({{&runs.pass_number[0], &runs.pass_y[0]}}),
                       common_line({{&runs.pass_number[1], &runs.pass_y[1]}})};
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

std::vector<double> lags(const AxisTest& test) {
  std::vector<double> lag;
  if (!test.bidirectional()) return lag;
  const double turn = minus_first(test) ? 0.0 : -1.0;
  const double m = static_cast<double>(test.targets.size());
  for (std::size_t i = 0; i < test.targets.size(); ++i)
    lag.push_back((static_cast<double>(i) + 0.5) / m + turn);
  return lag;
}

double square_of(double x) { return x * x; }

// Fits B_i = constant + fraction b_i, because drift within the passes adds b_i to the reversal.
void compare_with_reversal(const AxisTest& test, double variance, double dof, Drift& drift) {
  std::vector<double> B, b;
  double per = 0.0;
  const double m = static_cast<double>(test.targets.size());
  for (std::size_t i = 0; i < drift.lag.size(); ++i) {
    const auto plus = test.plus(i), minus = test.minus(i);
    if (plus.empty() || minus.empty()) continue;
    B.push_back(mean(deviations(plus)) - mean(deviations(minus)));
    b.push_back(drift.per_run_at(test.targets[i]) * drift.lag[i]);
    drift.in_B_mean += b.back() / m;
    per += 1.0 / static_cast<double>(plus.size()) + 1.0 / static_cast<double>(minus.size());
  }
  if (B.size() < 3 || !(dof > 0.0)) return;
  const double B_mean = mean(B), b_mean = mean(b);
  double bb = 0.0, bB = 0.0;
  for (std::size_t i = 0; i < B.size(); ++i)
    bb += square_of(b[i] - b_mean), bB += (b[i] - b_mean) * (B[i] - B_mean);
  if (!(bb > 0.0)) return;
  drift.seen_in_reversal = bB / bb;
  const double of_B = variance * per / static_cast<double>(B.size());
  drift.p_reversal = t_two_sided(test_ratio(drift.seen_in_reversal, std::sqrt(of_B / bb)), dof);
}

// Factor that the largest of `values` normal values exceeds at 4.55 %, at least 2.
double factor_of_largest(std::size_t values) {
  const double tail = 0.0455 / static_cast<double>(values);
  double low = 2.0, high = 10.0;
  for (int halved = 0; halved < 40; ++halved) {
    const double k = (low + high) / 2.0;
    (t_two_sided(k, 1e6) / 2.0 > tail ? low : high) = k;
  }
  return low;
}

/// The last result is kept, because analyses, uncertainties and the table of each control need it.
/// Results of long tests are not kept, to save memory.
template <auto compute>
auto kept(const AxisTest& test) {
  constexpr std::size_t most_readings = 10'000;
  if (test.readings().size() > most_readings) return compute(test);
  thread_local std::pair<AxisTest, decltype(compute(test))> last;
  if (last.first != test) last = {test, compute(test)};
  return last.second;
}

Drift fit_drift(const AxisTest& test) {
  Drift drift;
  if (test.targets.size() < 2 || test.most_approaches() < 2) return drift;
  const bool slopes = test.targets.size() >= 4;
  const PassModel model = fit_passes(test, slopes);
  double squares = 0.0, dof = 0.0, passes = 0.0, readings = 0.0;
  for (const auto& side : model.side) {
    if (side.readings > 0 && side.passes > 1) squares += side.squares, dof += side.dof;
    passes += static_cast<double>(side.passes), readings += static_cast<double>(side.readings);
  }
  drift.scatter = dof > 0.0 ? std::sqrt(squares / dof) : 0.0;
  drift.middle = model.middle;
  drift.lag = lags(test);
  double spread = 0.0;
  for (const double x : test.targets) spread += square_of(x - model.middle);
  const double filled = readings / passes / static_cast<double>(test.targets.size());
  const double variance = square_of(drift.scatter);
  const Runs offsets = by_run(model, false);
  drift.runs = offsets.number.size();
  drift.offset = part_of(offsets, variance * passes / readings, dof);
  if (slopes) drift.slope = part_of(by_run(model, true), variance / (spread * filled), dof);
  compare_with_reversal(test, variance, dof, drift);
  return drift;
}

// Returns the contribution of drift to the largest s of a direction: s minus the square root of s^2
// minus the mean square that drift may contribute. Among equal values of s the larger contribution
// is used, so that rounding does not decide.
double in_scatter(const AxisTest& test, const Drift& drift, bool minus) {
  constexpr double equal = 1e-9;
  double largest = 0.0, share = 0.0;
  for (std::size_t i = 0; i < test.targets.size(); ++i) {
    const auto part = minus ? test.minus(i) : test.plus(i);
    if (part.size() < 2) continue;
    const double s = standard_deviation(deviations(part));
    if (s < largest * (1.0 - equal)) continue;
    std::vector<double> runs;
    for (const auto& reading : part) runs.push_back(reading.run);
    const double rate = std::hypot(drift.per_run_at(test.targets[i]), drift.u_at(test.targets[i]));
    const double left = s * s - square_of(rate * standard_deviation(runs));
    const double own = s - std::sqrt(std::max(0.0, left));
    share = s > largest * (1.0 + equal) ? own : std::max(share, own);
    largest = std::max(largest, s);
  }
  return share;
}

DriftShare share_of_drift(const AxisTest& test) {
  constexpr double k = 2.0;
  DriftShare share;
  const Drift drift = estimate_drift(test);
  if (!drift.offset.known) return share;
  const Reversal reversal = assess_reversal(test);
  const double u_mean = std::isfinite(reversal.u_mean) ? reversal.u_mean : 0.0;
  share.s = std::max(in_scatter(test, drift, false), in_scatter(test, drift, true));
  const double k_largest = factor_of_largest(test.targets.size());
  double by_offset = 0.0, by_slope = 0.0;
  for (std::size_t i = 0; i < test.targets.size(); ++i) {
    const double x = test.targets[i], rate = std::fabs(drift.per_run_at(x)), u = drift.u_at(x);
    if (drift.lag.empty() || test.plus(i).empty() || test.minus(i).empty()) continue;
    const double lag = drift.lag[i], m = static_cast<double>(test.targets.size());
    const double of_B_i =
        square_of(drift.scatter) * (1.0 / static_cast<double>(test.plus(i).size()) +
                                    1.0 / static_cast<double>(test.minus(i).size()));
    share.B = std::max(share.B,
                       rate * std::fabs(lag) +
                           k_largest * std::sqrt(square_of(lag * u) + of_B_i + square_of(u_mean)));
    by_offset += lag / m, by_slope += lag * (x - drift.middle) / m;
  }
  if (!drift.lag.empty())
    share.B_mean = std::fabs(drift.in_B_mean) +
                   k * std::sqrt(square_of(by_offset * drift.offset.u) +
                                 square_of(by_slope * drift.slope.u) + square_of(u_mean));
  return share;
}

}  // namespace

double Drift::u_at(double x) const { return std::hypot(offset.u, slope.u * (x - middle)); }

Drift estimate_drift(const AxisTest& test) { return kept<fit_drift>(test); }

DriftShare drift_share(const AxisTest& test) { return kept<share_of_drift>(test); }

}  // namespace nonio::math
