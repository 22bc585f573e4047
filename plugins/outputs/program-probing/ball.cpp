// SPDX-License-Identifier: Apache-2.0
#include "ball.h"

#include <cmath>
#include <numbers>

namespace nonio::program_probing {

Vector Turning::direction(const Vector& v, double angle) const {
  const std::size_t k = about(), i = (k + 1) % 3, j = (k + 2) % 3;
  const double t = (with ? angle : -angle) * std::numbers::pi / 180.0;
  Vector out = v;
  out[i] = v[i] * std::cos(t) - v[j] * std::sin(t);
  out[j] = v[i] * std::sin(t) + v[j] * std::cos(t);
  return out;
}

Vector Turning::point(const Vector& p, double angle) const {
  Vector from{};
  for (std::size_t i = 0; i < 3; ++i) from[i] = p[i] - centre[i];
  Vector out = direction(from, angle);
  for (std::size_t i = 0; i < 3; ++i) out[i] += centre[i];
  return out;
}

Place place_of(const Ball& ball, double height, double angle, std::optional<double> carrier) {
  Vector at = ball.at;
  at[ball.table.about()] += height;
  Place out{angle, carrier, ball.table.point(at, angle), ball.table.direction(ball.stem, angle)};
  if (!carrier || !ball.carrier) return out;
  out.ball = ball.carrier->point(out.ball, *carrier);
  out.stem = ball.carrier->direction(out.stem, *carrier);
  return out;
}

std::vector<Touch> touches(const Ball& ball, const Place& place) {
  constexpr double diagonal = std::numbers::sqrt2 / 2.0, nearest = 0.5;  // cos 60 deg
  const auto is_free = [&](const Vector& way) {
    return way[0] * place.stem[0] + way[1] * place.stem[1] + way[2] * place.stem[2] <
           nearest - 1e-9;
  };
  const Vector above{0.0, 0.0, 1.0};
  if (!is_free(above)) return {};
  std::vector<Vector> ways{above};
  const Vector sides[] = {{1.0, 0.0, 0.0}, {-1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, -1.0, 0.0}};
  for (const Vector& side : sides)
    if (is_free(side)) ways.push_back(side);
  if (ways.size() < 5)
    for (const double x : {diagonal, -diagonal})
      for (const double y : {diagonal, -diagonal})
        if (is_free({x, y, 0.0})) ways.push_back({x, y, 0.0});
  std::vector<Touch> out;
  for (const Vector& way : ways) {
    Touch t{place.ball, place.ball};
    for (std::size_t k = 0; k < 3; ++k) {
      t.from[k] += way[k] * (ball.radius + ball.approach);
      t.to[k] += way[k] * (ball.radius - ball.beyond);
    }
    out.push_back(t);
  }
  return out;
}

}  // namespace nonio::program_probing
