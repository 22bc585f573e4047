// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "campaign/reading/plausibility/plausibility.h"
#include "campaign/reading/plausibility/plausibility_strokes.h"
#include "campaign/reading/plausibility/running_mean.h"

namespace nonio::reading {

namespace {

/// Mean of the other passes, and variance of a reading about this mean.
struct OtherPasses {
  std::vector<double> mean;  ///< NaN if fewer than two other passes have the target
  double variance = 0.0;
};

using MeansByTarget = std::map<double, RunningMean>;
using MeansByDirection = std::map<std::pair<std::uint32_t, int>, MeansByTarget>;

MeansByDirection means_of(const std::vector<Stroke>& strokes) {
  MeansByDirection means;
  for (const Stroke& s : strokes) {
    MeansByTarget& at = means[{s.line, s.direction}];
    for (std::size_t i = 0; i < s.target.size(); ++i) at[s.target[i]].add(s.deviation[i]);
  }
  return means;
}

/// `all`: means including `own`.
OtherPasses other_passes_of(const Stroke& own, const MeansByTarget& all) {
  OtherPasses out;
  double squares = 0.0, freedom = 0.0, count = 0.0, places = 0.0;
  for (const double target : own.target) {
    RunningMean others = all.at(target);
    const auto [from, to] = std::equal_range(own.target.begin(), own.target.end(), target);
    for (auto i = from; i != to; ++i)
      others = others.without(own.deviation[static_cast<std::size_t>(i - own.target.begin())]);
    out.mean.push_back(others.count < 2.0 ? std::nan("") : others.mean);
    squares += others.squares;
    if (others.count < 2.0) continue;
    freedom += others.count - 1.0;
    count += others.count, ++places;
  }
  if (freedom > 0.0) out.variance = squares / freedom * (1.0 + places / count);
  return out;
}

/// Returns variances about the others, without the zero of the pass: as listed, and with each
/// reading assigned to the target `by` rows further. Both use the same `used` rows.
std::pair<double, double> variances(const Stroke& own, const OtherPasses& others, int by,
                                    std::size_t& used) {
  std::vector<double> listed, moved;
  for (std::size_t i = 0; i < own.target.size(); ++i) {
    const auto k = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(i) + by);
    if (k >= own.target.size()) continue;
    const double a = own.deviation[i] - others.mean[i], b = own.deviation[i] - others.mean[k];
    if (std::isfinite(a) && std::isfinite(b)) listed.push_back(a), moved.push_back(b);
  }
  used = listed.size();
  const auto variance = [&](const std::vector<double>& r) {
    double mean = 0.0, squares = 0.0;
    for (const double x : r) mean += x / static_cast<double>(r.size());
    for (const double x : r) squares += (x - mean) * (x - mean);
    return squares / (static_cast<double>(r.size()) - 1.0);
  };
  return used < 2 ? std::pair{0.0, 0.0} : std::pair{variance(listed), variance(moved)};
}

}  // namespace

void shifted_rows(const Passes& passes, Quantity deviation, std::vector<Finding>& out) {
  // Noise gives such a likelihood ratio in at most one of e^9 passes.
  constexpr double evidence = 9.0;
  constexpr std::size_t fewest = 7;
  const MeansByDirection means = means_of(passes.strokes);
  for (const Stroke& own : passes.strokes) {
    const OtherPasses others = other_passes_of(own, means.at({own.line, own.direction}));
    if (!(others.variance > 0.0)) continue;
    for (const int by : {1, -1}) {
      std::size_t used = 0;
      const auto [listed, moved] = variances(own, others, by, used);
      if (used < fewest || !(listed > 2.0 * others.variance) || !(moved < 2.0 * others.variance))
        continue;
      const double ratio = listed / std::max(moved, 1e-3 * others.variance);
      if (!(0.5 * static_cast<double>(used) * std::log(ratio) > evidence)) continue;
      out.push_back({.id = "plausibility.rows-shifted",
                     .attention = true,
                     .evidence = {{"listed", std::sqrt(listed), deviation},
                                  {"moved", std::sqrt(moved), deviation}},
                     .texts = {{"which", name_of(own)}}});
      break;
    }
  }
}

/// Compares the decimals of the last number with those above. A complete last line is not examined.
std::vector<Finding> implausible_end(std::string_view bytes, const std::string& file) {
  if (bytes.empty() || bytes.back() == '\n' || bytes.back() == '\r') return {};
  constexpr std::size_t window = 65536;
  if (bytes.size() > window) bytes = bytes.substr(bytes.size() - window);
  const auto last_field = [](std::string_view line, std::size_t& fields) {
    fields = 1 + static_cast<std::size_t>(std::count_if(line.begin(), line.end(), [](char c) {
               return c == ',' || c == ';' || c == '\t';
             }));
    const bool comma = line.find_first_of(";\t") == line.npos;
    const std::size_t at = line.find_last_of(comma ? "," : ";\t");
    return at == line.npos ? line : line.substr(at + 1);
  };
  const auto decimals = [](std::string_view number) -> std::ptrdiff_t {
    if (number.find_first_not_of("+-0123456789.,") != number.npos || number.empty()) return -1;
    const std::size_t point = number.find_first_of(".,");
    return point == number.npos ? 0 : static_cast<std::ptrdiff_t>(number.size() - point - 1);
  };
  std::vector<std::string_view> lines;
  while (!bytes.empty()) {
    const std::size_t at = bytes.rfind('\n');
    std::string_view line = at == bytes.npos ? bytes : bytes.substr(at + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    lines.push_back(line);
    bytes = at == bytes.npos ? std::string_view() : bytes.substr(0, at);
  }
  std::size_t own_fields = 0, fields = 0;
  const std::string_view own = last_field(lines.front(), own_fields);
  const std::ptrdiff_t digits = decimals(own);
  std::ptrdiff_t fewest = -1;
  std::size_t seen = 0;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::ptrdiff_t d = decimals(last_field(lines[i], fields));
    if (fields != own_fields || d < 0) continue;
    fewest = seen++ == 0 ? d : std::min(fewest, d);
  }
  const bool cut = own_fields > 1 && seen >= 3 && (digits < fewest || own == "-" || own == "+");
  if (!cut) return {};
  return {{.id = "plausibility.file-cut-short",
           .attention = true,
           .evidence = {{"digits", static_cast<double>(std::max<std::ptrdiff_t>(digits, 0)),
                         Quantity::count},
                        {"others", static_cast<double>(fewest), Quantity::count}},
           .texts = {{"file", file}, {"found", std::string(own)}}}};
}

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
