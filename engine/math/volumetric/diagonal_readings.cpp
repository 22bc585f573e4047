// SPDX-License-Identifier: Apache-2.0
#include "diagonal_readings.h"

#include <cmath>
#include <string>

namespace nonio::math {

namespace {

constexpr std::size_t most_stops = 1000;

Expected<void> check_curve(const MeanCurve& curve, std::size_t length, const std::string& what) {
  if (curve.mean.size() != length)
    return fail(what + ": expected " + std::to_string(length) + " means, found " +
                std::to_string(curve.mean.size()));
  for (const double v : curve.mean)
    if (!std::isfinite(v)) return fail(what + ": expected numbers, found one that is not finite");
  if (!(curve.u >= 0.0)) return fail(what + ": expected an uncertainty that is not negative");
  return {};
}

Expected<void> check_line(const GridLine& line, std::size_t n, const std::string& what) {
  if (auto ok = check_curve(line, line.ix.size(), what); !ok) return ok;
  if (line.iy.size() != line.ix.size() || line.ix.size() < 2)
    return fail(what + ": expected two stops or more, each with a place in x and in y");
  for (const auto* places : {&line.ix, &line.iy})
    for (const std::size_t i : *places)
      if (i > n) return fail(what + ": a stop is outside the grid");
  return {};
}

Expected<void> check_positioning(const DiagonalReadings& r, const GridLine& line,
                                 const std::string& what) {
  const auto X = of_direction(r.X, line.x_direction);
  if (X.empty() || X.size() > 2)
    return fail(what + ": expected positioning of X on one line or two");
  if (X.size() == 2 && !(std::fabs(r.X[X[1]].across - r.X[X[0]].across) > 0.0))
    return fail(what + ": expected two different lines of X");
  if (of_direction(r.Y, line.y_direction).size() != 1)
    return fail(what + ": expected one positioning of Y");
  if (!r.ECX.empty() && of_direction(r.ECX, line.x_direction).size() != 1)
    return fail(what + ": expected one yaw of X");
  return {};
}

}  // namespace

Expected<void> check(const DiagonalReadings& r) {
  if (!(r.Lx > 0.0 && r.Ly > 0.0)) return fail("expected lengths above 0");
  if (r.n < 3 || r.n > most_stops)
    return fail("expected 3 to " + std::to_string(most_stops) + " steps, found " +
                std::to_string(r.n));
  if (r.D1.mean.size() != r.n + 1 || r.D2.mean.size() != r.n + 1)
    return fail("expected " + std::to_string(r.n + 1) + " stops on each diagonal");
  std::vector<std::pair<const GridLine*, std::string>> lines{{&r.D1, "D1"}, {&r.D2, "D2"}};
  for (const GridLine& line : r.third) lines.emplace_back(&line, "third line");
  for (const auto& [line, what] : lines) {
    if (auto ok = check_line(*line, r.n, what); !ok) return ok;
    if (auto ok = check_positioning(r, *line, what); !ok) return ok;
  }
  std::vector<std::pair<const MeanCurve*, std::string>> curves;
  for (const PitchLine& line : r.X) curves.emplace_back(&line, "X");
  for (const PitchLine& line : r.Y) curves.emplace_back(&line, "Y");
  for (const MeanCurve& yaw : r.ECX) curves.emplace_back(&yaw, "ECX");
  for (const auto& [direct, what] : {std::pair{&r.EYX, "EYX"}, std::pair{&r.EXY, "EXY"}}) {
    if (!*direct) continue;
    curves.emplace_back(&**direct, what);
    if ((*direct)->reversed)
      curves.emplace_back(&*(*direct)->reversed, std::string(what) + " turned over");
  }
  for (const auto& [curve, what] : curves)
    if (auto ok = check_curve(*curve, r.n + 1, what); !ok) return ok;
  return {};
}

}  // namespace nonio::math
