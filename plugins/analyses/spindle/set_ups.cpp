// SPDX-License-Identifier: Apache-2.0
#include "set_ups.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace nonio::spindle {

namespace {

constexpr double full = 2.0 * std::numbers::pi;
constexpr double grain = full / 360e3;  // a thousandth of a degree

/// In [0, 360): 360 is where 0 is.
double rounded(double angle) {
  const double turned = std::fmod(std::fmod(angle, full) + full, full);
  const double steps = std::round(turned / grain);
  return steps >= 360e3 ? 0.0 : steps * grain;
}

bool same(double a, double b) { return std::fabs(std::remainder(a - b, full)) < 1.5 * grain; }

math::SpindleTrack track_of(const Observations& o, std::vector<std::size_t> rows) {
  const auto& angle = o.axes[0].position;
  std::stable_sort(rows.begin(), rows.end(),
                   [&](std::size_t a, std::size_t b) { return angle[a] < angle[b]; });
  math::SpindleTrack out;
  double n = 0.0;
  for (const std::size_t i : rows) {
    if (out.angle.empty() || angle[i] > out.angle.back()) {
      out.angle.push_back(angle[i]), out.r.push_back(0.0);
      n = 0.0;
    }
    n += 1.0;
    out.r.back() += (o.deviation[i] - out.r.back()) / n;
  }
  return out;
}

}  // namespace

SetUps set_ups_of(const Observations& o) {
  SetUps out;
  if (o.axes.size() < 3) return out;
  std::vector<std::vector<std::size_t>> rows(o.lines.size());
  for (std::size_t i = 0; i < o.size(); ++i) rows[o.line_of(i)].push_back(i);
  for (std::size_t line = 0; line < o.lines.size(); ++line) {
    if (rows[line].empty()) continue;
    const std::string name = o.lines[line].name.substr(0, o.lines[line].name.find(' '));
    const std::size_t first = rows[line].front(), count = rows[line].size();
    const Place place{rounded(o.axes[1].position[first]), rounded(o.axes[2].position[first])};
    auto turns = math::turns_of(track_of(o, std::move(rows[line])));
    if (!turns) {
      out.findings.push_back(
          {.id = "spindle.no-turns",
           .attention = true,
           .evidence = {{"readings", static_cast<double>(count), Quantity::count}},
           .texts = {{"sensor", o.lines[line].name}}});
      continue;
    }
    out.resampled = out.resampled || turns->resampled;
    out.of[name].insert_or_assign(place, std::move(*turns));
  }
  return out;
}

Separation separation_of(const std::map<Place, math::Turns>& places) {
  Separation out;
  const double half = full / 2.0;
  for (const auto& [one, turns] : places)
    for (const auto& [two, other] : places)
      if (turns.n == other.n && same(one.ball + half, two.ball) &&
          same(one.sensor + half, two.sensor)) {
        out.kind = Separation::Kind::donaldson;
        out.places = {one, two};
        return out;
      }
  if (places.size() < 3) return out;
  std::size_t k = 0;
  const auto& [first, of_first] = *places.begin();
  const double step = full / static_cast<double>(places.size());
  for (const auto& [place, turns] : places) {
    if (turns.n != of_first.n || !same(place.sensor, first.sensor) ||
        !same(place.ball, first.ball + step * static_cast<double>(k)))
      return out;
    ++k;
    out.places.push_back(place);
  }
  out.kind = Separation::Kind::multi_step;
  return out;
}

}  // namespace nonio::spindle
