// SPDX-License-Identifier: Apache-2.0
//
// Reversal spikes (docs/dev/constants.md, A13), and how far after a reversal they extend.
#include <algorithm>
#include <cmath>
#include <map>

#include "common/constants.h"
#include "nonio/math/circle.h"

namespace nonio::math {

namespace {

// The zone is widened if the remainder of the spikes after it exceeds `begins` times its u, and
// then further while it exceeds `goes_on` times its u, because an exponential decays slowly. `wide`
// is the width of a window, rad. docs/dev/constants.md, A23.
constexpr double normal_quartile = 0.6745;  // median of |x| for a standard normal x
constexpr double begins = 2.24, goes_on = 1.0, wide = 2.0 * full_turn / 360.0;

// Sum and number of residuals by angle since the reversal, rad.
using Residuals = std::map<double, std::pair<double, double>>;

/// Residuals of one direction at angles between `from` and `to`, rad, after a reversal.
Residuals behind(std::span<const CircleReading> readings, const CircleModel& model,
                 const CauseFit& fit, int direction, double reversal, double from, double to) {
  Residuals out;
  for (const CircleReading& r : readings) {
    if (r.direction != direction) continue;
    const double off = r.angle - reversal,
                 way = direction * (off - full_turn * std::round(off / full_turn));
    if (way < from || way > to) continue;
    auto& [sum, n] = out[std::round(way / 1e-4) * 1e-4];
    sum += r.deviation - fit.radius_at(model, r.angle, r.direction), n += 1.0;
  }
  return out;
}

}  // namespace

std::vector<Spike> reversal_spikes(std::span<const CircleReading> readings,
                                   const CircleModel& model, const CauseFit& fit) {
  constexpr double from = -0.5 * full_turn / 360.0, to = 5.0 * full_turn / 360.0;
  std::vector<Spike> out;
  for (const int direction : {1, -1})
    for (int q = 0; q < 4; ++q) {
      const double reversal = q * full_turn / 4.0;
      auto residuals = behind(readings, model, fit, direction, reversal, from, to);
      residuals.erase(0.0);  // a reading at the reversal may be before it or after it
      if (residuals.size() < 3) continue;
      Spike spike{reversal, direction, q % 2 == 1};
      double n = 1.0, peak = 0.0;
      for (const auto& [way, of] : residuals)
        if (std::fabs(of.first / of.second) > std::fabs(spike.height))
          spike.height = of.first / of.second, n = of.second, peak = way;
      spike.u = std::hypot(fit.s_reading / std::sqrt(n),
                           fit.u_at(model, reversal + direction * peak, direction));
      double first = INFINITY, last = -INFINITY;
      for (const auto& [way, of] : residuals)
        if (of.first / of.second * std::copysign(1.0, spike.height) >=
            0.5 * std::fabs(spike.height))
          first = std::min(first, way), last = std::max(last, way);
      spike.width = last - first;
      out.push_back(spike);
    }
  return out;
}

namespace {

double mean_of(const Residuals& residuals) {
  double sum = 0.0, n = 0.0;
  for (const auto& [way, of] : residuals) sum += of.first / of.second, n += 1.0;
  return sum / n;
}

/// Standard deviation of differences of residuals between windows that have one window between
/// them, m; 0 without such windows. From the median, because long spikes affect only some windows.
double scatter_of_windows(const CauseFit& fit) {
  std::map<std::pair<int, int>, std::pair<double, double>> windows;
  for (const auto& bin : fit.bins) {
    auto& [sum, n] = windows[{bin.direction, static_cast<int>(bin.angle / wide)}];
    sum += bin.residual, n += 1.0;
  }
  std::vector<double> differences;
  for (const auto& [at, of] : windows)
    if (const auto next = windows.find({at.first, at.second + 2}); next != windows.end())
      differences.push_back(
          std::fabs(of.first / of.second - next->second.first / next->second.second));
  if (differences.empty()) return 0.0;
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  return *middle / normal_quartile;
}

/// Returns the remainder of the spikes after the omitted zone for the axis with the larger one: the
/// difference between the mean residuals of the next window and of that two windows later, over
/// both directions and reversals, in u of such differences. 0 if there is no difference.
double left_over(std::span<const CircleReading> readings, const CircleModel& model,
                 const CauseFit& fit) {
  const double edge = model.leave_out, scatter = scatter_of_windows(fit);
  std::array<double, 2> sum{}, n{};
  for (const int direction : {1, -1})
    for (int q = 0; q < 4; ++q) {
      const auto mean = [&](double from) {
        return mean_of(behind(readings, model, fit, direction, q * full_turn / 4.0, edge + from,
                              edge + from + wide));
      };
      const double falls = mean(0.0) - mean(2.0 * wide);
      if (std::isfinite(falls)) sum[q % 2] += falls, n[q % 2] += 1.0;
    }
  double largest = 0.0;
  for (std::size_t k = 0; k < 2; ++k)
    if (n[k] > 0.0 && scatter > 0.0)
      largest = std::max(largest, std::fabs(sum[k]) / std::sqrt(n[k]) / scatter);
  return largest;
}

}  // namespace

Expected<CauseFit> fit_causes_without_spikes(std::span<const CircleReading> readings,
                                             CircleModel& model, double most) {
  constexpr double step = full_turn / 360.0;
  auto fit = fit_causes(readings, model);
  double enough = begins;
  while (fit && model.leave_out + step <= most && left_over(readings, model, *fit) > enough) {
    enough = goes_on;
    CircleModel wider = model;
    wider.leave_out += step;
    auto next = fit_causes(readings, wider);
    if (!next) break;
    model = wider, fit = std::move(next);
  }
  return fit;
}

}  // namespace nonio::math
