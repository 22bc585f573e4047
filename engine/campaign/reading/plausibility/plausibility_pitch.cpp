// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "campaign/reading/plausibility/plausibility.h"
#include "campaign/reading/plausibility/plausibility_strokes.h"

namespace nonio::reading {
namespace {

constexpr double mm_per_inch = 25.4, most_in_inch = 2.0;
// A stated pitch of `most_in_inch` or more is assumed to be in mm.

/// Share of a wave in the sum of squares about a line, 0 to 1.
double share_of_wave(const std::vector<double>& at, const std::vector<double>& values,
                     double period) {
  std::vector<double> c, s;
  for (const double t : at) {
    const double phase = 2.0 * std::numbers::pi * t / period;
    c.push_back(std::cos(phase)), s.push_back(std::sin(phase));
  }
  take_line_out(at, c);
  take_line_out(at, s);
  double cc = 0.0, ss = 0.0, cs = 0.0, cv = 0.0, sv = 0.0, vv = 0.0;
  for (std::size_t i = 0; i < at.size(); ++i) {
    cc += c[i] * c[i], ss += s[i] * s[i], cs += c[i] * s[i];
    cv += c[i] * values[i], sv += s[i] * values[i], vv += values[i] * values[i];
  }
  const double determinant = cc * ss - cs * cs;
  if (vv <= 0.0 || determinant <= 1e-9 * cc * ss) return 0.0;
  return (cv * cv * ss - 2.0 * cv * sv * cs + sv * sv * cc) / (determinant * vv);
}

}  // namespace

void implausible_pitch(const Campaign& c, std::vector<Finding>& out) {
  constexpr double nearly = 1e-3;
  constexpr double usual[] = {1,  1.5,  2,  2.5, 3,  4,  5,  6,  8,  10,
                              12, 12.5, 15, 16,  20, 25, 30, 32, 40, 50};
  const auto near = [](double a, double b) { return std::fabs(a / b - 1.0) < nearly; };
  for (const Axis& axis : c.machine.axes) {
    if (!axis.screw_pitch || axis.rotary) continue;
    const double pitch = 1e3 * *axis.screw_pitch;  // mm
    if (pitch <= 0.0 || pitch >= most_in_inch) continue;
    const double decade = std::pow(10.0, std::floor(std::log10(pitch)) - 1.0);
    const double two_digits = decade * std::round(pitch / decade);
    const bool of_catalogue = near(two_digits, pitch) && std::fabs(two_digits / pitch - 1.0) < 1e-9;
    const bool metric =
        !of_catalogue && std::any_of(std::begin(usual), std::end(usual),
                                     [&](double u) { return near(mm_per_inch * pitch, u); });
    const bool of_other =
        std::any_of(c.machine.axes.begin(), c.machine.axes.end(), [&](const Axis& a) {
          return !a.rotary && a.screw_pitch && near(mm_per_inch * pitch, 1e3 * *a.screw_pitch);
        });
    if (!metric && !of_other) continue;
    out.push_back({.id = "plausibility.pitch-in-inch",
                   .attention = true,
                   .evidence = {{"pitch", *axis.screw_pitch, Quantity::length},
                                {"times", mm_per_inch * *axis.screw_pitch, Quantity::length}},
                   .texts = {{"axis", axis.name}}});
  }
}

/// Searches a period of 25.4 times the pitch if the targets are dense enough.
void period_against_pitch(const Axis& axis, const Observations& o, std::vector<Finding>& out) {
  constexpr std::size_t fewest_targets = 12, waves = 3;
  constexpr double chance = 1e-7, least_share = 0.3, of_finer = 0.25;
  if (!axis.screw_pitch || axis.rotary || o.axes.size() != 1) return;
  const double pitch = *axis.screw_pitch, period = mm_per_inch * pitch;
  if (pitch <= 0.0 || 1e3 * pitch >= most_in_inch) return;
  std::map<double, std::pair<double, double>> cells;
  for (std::size_t i = 0; i < o.size(); ++i) {
    auto& cell = cells[o.axes.front().position[i]];
    cell.first += o.deviation[i], cell.second += 1.0;
  }
  if (cells.size() < fewest_targets) return;
  std::vector<double> at, values, gaps;
  for (const auto& [target, cell] : cells) {
    if (!at.empty()) gaps.push_back(target - at.back());
    at.push_back(target);
    values.push_back(cell.first / cell.second);
  }
  if (*std::max_element(gaps.begin(), gaps.end()) > period / static_cast<double>(waves) ||
      at.back() - at.front() < static_cast<double>(waves) * period)
    return;
  take_line_out(at, values);
  const double share = share_of_wave(at, values, period);
  // Probability that a wave explains more than this share of noise alone.
  const double p =
      std::pow(1.0 - std::min(share, 1.0), (static_cast<double>(at.size()) - 4.0) / 2.0);
  if (share < least_share || p > chance || share_of_wave(at, values, pitch) > of_finer * share)
    return;
  out.push_back({.id = "plausibility.period-against-pitch",
                 .attention = true,
                 .evidence = {{"period", period, Quantity::length},
                              {"pitch", pitch, Quantity::length},
                              {"share", share, Quantity::ratio}},
                 .texts = {{"axis", axis.name}}});
}

}  // namespace nonio::reading
