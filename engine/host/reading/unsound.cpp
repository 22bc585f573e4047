// SPDX-License-Identifier: Apache-2.0
#include "host/reading/unsound.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace nonio::host::reading {
namespace {

bool finite(double x) { return std::isfinite(x); }

bool all_finite(const std::vector<double>& column) {
  return std::all_of(column.begin(), column.end(), finite);
}

bool direction(const std::array<double, 3>& s) { return std::all_of(s.begin(), s.end(), finite); }

/// What is read by index: wrong numbers here would be read past the end.
std::string unsound_lines(const Observations& o) {
  if (o.size() == 0) return {};
  if (o.lines.empty()) return "readings of no line; expected one line at least";
  for (std::size_t i = 0; i < o.line.size(); ++i)
    if (o.line[i] >= o.lines.size())
      return "reading " + std::to_string(i + 1) + " of line " + std::to_string(o.line[i]) +
             "; expected 0 to " + std::to_string(o.lines.size() - 1);
  if (!std::all_of(o.sense.begin(), o.sense.end(), direction) ||
      !std::all_of(o.lines.begin(), o.lines.end(),
                   [](const Observations::Line& l) { return direction(l.sense); }))
    return "a direction of sensing that is not a number";
  return {};
}

}  // namespace

std::string unsound(const Observations& o) {
  const std::size_t n = o.size();
  const auto fits = [n](const auto& column) { return column.empty() || column.size() == n; };
  bool same = fits(o.u) && fits(o.run) && fits(o.line) && fits(o.source_line) && fits(o.time) &&
              fits(o.material) && fits(o.air) && fits(o.pressure) && fits(o.humidity) &&
              fits(o.sense);
  for (const auto& axis : o.axes) same = same && axis.position.size() == n && fits(axis.approach);
  if (!same) return "columns of different lengths";
  if (!all_finite(o.deviation)) return "a deviation that is not a number";
  for (const auto& axis : o.axes) {
    if (!all_finite(axis.position)) return "a position of " + axis.axis + " that is not a number";
    if (!std::all_of(axis.approach.begin(), axis.approach.end(),
                     [](std::int8_t a) { return a >= -1 && a <= 1; }))
      return "an approach that is none of +1, -1 and 0";
  }
  if (!std::all_of(o.u.begin(), o.u.end(), [](double u) { return finite(u) && u > 0.0; }))
    return "an uncertainty of a reading that is not a number above 0";
  for (const Finding& doubt : o.doubts)
    if (!doubt.attention || !doubt.id.starts_with("plausibility."))
      return "the doubt " + doubt.id + "; expected findings plausibility.* of attention";
  return unsound_lines(o);
}

}  // namespace nonio::host::reading
