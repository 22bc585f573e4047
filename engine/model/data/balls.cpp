// SPDX-License-Identifier: Apache-2.0
#include "balls.h"

#include <cmath>
#include <map>

#include "lines.h"
#include "nonio/math/rotary.h"

namespace nonio::model {

namespace {

Vector less(Vector a, const Vector& b) {
  for (std::size_t k = 0; k < 3; ++k) a[k] -= b[k];
  return a;
}

struct Ball {
  Vector at{};
  std::size_t row = 0;  // row of its first coordinate
};

/// Combines every three rows, which sense x, y and z, into one ball center.
std::vector<Ball> gathered(const Observations& o) {
  std::vector<Ball> balls;
  for (std::size_t i = 0; i + 2 < o.size(); i += 3) {
    Ball ball{{}, i};
    for (std::size_t k = 0; k < 3; ++k) ball.at[k] = o.deviation[i + k];
    balls.push_back(ball);
  }
  return balls;
}

/// Returns the mean ball center at each angle (rad); its weight is the number of centers.
std::map<double, math::BallCentre> mean_centres(const Observations& o,
                                                const std::vector<Ball>& balls) {
  std::map<double, math::BallCentre> places;
  for (const Ball& ball : balls) {
    const double angle = o.axes.front().position[ball.row];
    auto [at, fresh] = places.try_emplace(angle, math::BallCentre{{}, angle, 0.0});
    math::BallCentre& place = at->second;
    place.weight += 1.0;
    for (std::size_t k = 0; k < 3; ++k) place.at[k] += (ball.at[k] - place.at[k]) / place.weight;
  }
  return places;
}

}  // namespace

std::optional<Part> balls_of(const Observations& read, const Axis& axis, const std::string& id) {
  if (read.axes.size() < 4 || read.size() % 3 != 0) return std::nullopt;
  const std::vector<Ball> balls = gathered(read);
  const auto places = mean_centres(read, balls);
  std::vector<math::BallCentre> centres;
  for (const auto& [angle, place] : places) centres.push_back(place);
  const auto circle = math::fit_rotary(centres, false);
  if (!circle) return std::nullopt;
  Part part;
  part.kind = Part::Kind::balls;
  part.name = id;
  part.measurements = {id};
  part.axes = {axis};
  Observations& o = part.table;
  for (const auto& column : read.axes) o.axes.push_back({column.axis, column.rotary, {}, {}});
  o.lines = {{id + " radial", {}}, {id + " axial", circle->direction}};
  const auto keep = [](std::vector<double>& to, const std::vector<double>& from, std::size_t row) {
    if (!from.empty()) to.push_back(from[row]);
  };
  for (const bool radial : {true, false})
    for (const Ball& ball : balls) {
      const double angle = read.axes.front().position[ball.row];
      const Vector& place = places.at(angle).at;
      Vector out = less(place, circle->centre);
      const double height = dot(out, circle->direction);
      for (std::size_t k = 0; k < 3; ++k) out[k] -= height * circle->direction[k];
      const double size = std::sqrt(dot(out, out));
      for (double& x : out) x /= size;
      const Vector& sense = radial ? out : circle->direction;
      const auto& approach = read.axes.front().approach;
      o.axes[0].position.push_back(angle);
      o.axes[0].approach.push_back(approach.empty() ? std::int8_t{1} : approach[ball.row]);
      // With measured positions instead of the circle, dependent effects would appear independent.
      for (std::size_t k = 0; k < 3; ++k)
        o.axes[1 + k].position.push_back(circle->centre[k] + circle->radius * out[k]);
      o.sense.push_back(sense);
      o.deviation.push_back(dot(less(ball.at, circle->centre), sense) -
                            (radial ? circle->radius : 0.0));
      o.line.push_back(radial ? 0 : 1);
      o.run.push_back(read.run.empty() ? 1 : read.run[ball.row]);
      if (!read.source_line.empty()) o.source_line.push_back(read.source_line[ball.row]);
      if (!read.u.empty()) {
        double square = 0.0;
        for (std::size_t k = 0; k < 3; ++k)
          square += sense[k] * sense[k] * read.u[ball.row + k] * read.u[ball.row + k];
        o.u.push_back(std::sqrt(square));
      }
      keep(o.time, read.time, ball.row);
      keep(o.material, read.material, ball.row);
      keep(o.air, read.air, ball.row);
      keep(o.pressure, read.pressure, ball.row);
      keep(o.humidity, read.humidity, ball.row);
      part.measurement.push_back(0);
      part.row.push_back(static_cast<std::uint32_t>(ball.row));
    }
  part.along = o.axes.front().position;
  part.way = o.axes.front().approach;
  o.missing = read.missing;
  return part;
}

}  // namespace nonio::model
