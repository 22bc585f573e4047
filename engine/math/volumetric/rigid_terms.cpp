// SPDX-License-Identifier: Apache-2.0
#include "rigid_terms.h"

#include <algorithm>
#include <cmath>

namespace nonio::math {

namespace {

using Kind = RigidTerm::Kind;

struct Named {
  const char* name;
  Kind kind;
  std::size_t axis, along;
};
/// If several errors explain the same readings, a later one is reported as undetermined.
constexpr std::array<Named, 21> all_named{{
    {"EXX", Kind::positioning, 0, 0},  {"EYY", Kind::positioning, 1, 1},
    {"EZZ", Kind::positioning, 2, 2},  {"C0Y", Kind::squareness, 1, 2},
    {"B0Z", Kind::squareness, 2, 1},   {"A0Z", Kind::squareness, 2, 0},
    {"EYX", Kind::straightness, 0, 1}, {"EZX", Kind::straightness, 0, 2},
    {"EXY", Kind::straightness, 1, 0}, {"EZY", Kind::straightness, 1, 2},
    {"EXZ", Kind::straightness, 2, 0}, {"EYZ", Kind::straightness, 2, 1},
    {"EAX", Kind::angle, 0, 0},        {"EBX", Kind::angle, 0, 1},
    {"ECX", Kind::angle, 0, 2},        {"EAY", Kind::angle, 1, 0},
    {"EBY", Kind::angle, 1, 1},        {"ECY", Kind::angle, 1, 2},
    {"EAZ", Kind::angle, 2, 0},        {"EBZ", Kind::angle, 2, 1},
    {"ECZ", Kind::angle, 2, 2},
}};

Corner cross_product(const Corner& a, const Corner& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double dot_product(const Corner& a, const Corner& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Corner unit_along(std::size_t k) {
  Corner out{};
  out[k] = 1.0;
  return out;
}

/// Returns the position relative to the center of the box, with the coordinates of the axes that
/// the moving axis carries; for a squareness, with that of the second axis itself.
Corner carried(const RigidTerm& term, const RigidBox& box, const Corner& at) {
  Corner out{};
  if (term.kind == Kind::squareness)
    out[term.axis] = box.lever(term.axis, at);
  else
    for (std::size_t k = term.axis + 1; k < 3; ++k) out[k] = box.lever(k, at);
  return out;
}

double largest_in(const RigidTerm& term, const RigidBox& box) {
  double most = 0.0;
  for (const Corner& place : lattice(box.low, box.high, 2))
    for (const double e : error_of_term(term, box, place)) most = std::max(most, std::fabs(e));
  return most;
}

std::array<Corner, 2> across_of(const Corner& sense) {
  const Corner up = std::fabs(sense[2]) < 0.9 ? unit_along(2) : unit_along(0);
  Corner level = cross_product(up, sense);
  const double size = std::sqrt(dot_product(level, level));
  for (double& v : level) v /= size;
  return {level, cross_product(sense, level)};
}

Corner way_of(const RigidLine& line, std::size_t i) {
  Corner out = line.readings[i].at;
  for (std::size_t k = 0; k < 3; ++k) out[k] -= line.readings.front().at[k];
  return out;
}

/// Returns the vector from the first reading to the reading that is farthest along the beam.
Corner farthest_way(const RigidLine& line) {
  Corner best{};
  for (std::size_t i = 0; i < line.readings.size(); ++i) {
    const Corner way = way_of(line, i);
    if (dot_product(way, line.readings[i].sense) > dot_product(best, line.readings[i].sense))
      best = way;
  }
  return best;
}

/// Unit vector from the first reading to the reading farthest from it.
Corner travel_of(const RigidLine& line) {
  Corner best{};
  for (std::size_t i = 0; i < line.readings.size(); ++i)
    if (const Corner way = way_of(line, i); dot_product(way, way) > dot_product(best, best))
      best = way;
  const double size = std::sqrt(dot_product(best, best));
  for (double& v : best) v = size > 0.0 ? v / size : 0.0;
  return best;
}

bool both_ways(const RigidLine& line) {
  bool up = false, down = false;
  for (const RigidReading& r : line.readings) up |= r.way > 0, down |= r.way < 0;
  return up && down;
}

double seen(const RigidLine& line, std::size_t i, const RigidTerm& term, const RigidBox& box,
            const Corner& far) {
  const RigidReading& r = line.readings[i];
  if (line.kind == RigidLine::Kind::stated) return 0.0;
  if (line.kind == RigidLine::Kind::angle)
    return term.kind == Kind::angle && term.axis == line.of && term.along == line.about
               ? shape_of(term, box, r.at)
               : 0.0;
  double out = dot_product(error_of_term(term, box, r.at), r.sense);
  if (line.kind == RigidLine::Kind::mirror && term.kind == Kind::angle) {
    const Corner turned = cross_product(unit_along(term.along), r.sense);
    out += (dot_product(turned, way_of(line, i)) - dot_product(turned, far)) *
           shape_of(term, box, r.at);
  }
  return out;
}

}  // namespace

const std::vector<std::string>& rigid_errors() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out;
    for (const Named& n : all_named) out.emplace_back(n.name);
    return out;
  }();
  return names;
}

double legendre(std::size_t degree, double t) {
  double before = 1.0, now = t;
  if (degree == 0) return 1.0;
  for (std::size_t k = 2; k <= degree; ++k) {
    const auto n = static_cast<double>(k);
    const double next = ((2.0 * n - 1.0) * t * now - (n - 1.0) * before) / n;
    before = now, now = next;
  }
  return now;
}

double shape_of(const RigidTerm& term, const RigidBox& box, const Corner& at) {
  return legendre(term.degree, box.part(term.axis, at));
}

Corner error_of_term(const RigidTerm& term, const RigidBox& box, const Corner& at) {
  const double shape = shape_of(term, box, at);
  if (term.kind == Kind::positioning || term.kind == Kind::straightness) {
    Corner out{};
    out[term.along] = shape;
    return out;
  }
  Corner out = cross_product(unit_along(term.along), carried(term, box, at));
  for (double& v : out) v *= shape;
  return out;
}

std::vector<RigidTerm> rigid_terms(const RigidBox& box, const std::vector<std::string>& errors,
                                   std::size_t degree) {
  std::vector<RigidTerm> out;
  for (const Named& n : all_named) {
    const bool wanted =
        errors.empty() || std::find(errors.begin(), errors.end(), n.name) != errors.end();
    if (!wanted || !(box.length(n.axis) > 0.0)) continue;
    const std::size_t from = n.kind == Kind::squareness ? 0 : n.kind == Kind::straightness ? 2 : 1;
    const std::size_t to = n.kind == Kind::squareness ? 0 : degree;
    for (std::size_t k = from; k <= to; ++k) {
      RigidTerm term{n.name, n.kind, n.axis, n.along, k};
      double most = largest_in(term, box);
      if (n.kind == Kind::angle && !(most > 0.0))
        most = std::max({box.length(0), box.length(1), box.length(2)}) / 2.0;
      term.scale = most > 0.0 ? 1.0 / most : 1.0;
      out.push_back(std::move(term));
    }
  }
  return out;
}

RigidRows rows_of(const RigidLine& line, const std::vector<RigidTerm>& terms, const RigidBox& box) {
  RigidRows out;
  const bool zero = line.kind != RigidLine::Kind::point && line.kind != RigidLine::Kind::stated;
  const bool reversed = zero && both_ways(line);
  const Corner far = farthest_way(line), travel = travel_of(line);
  for (std::size_t i = 0; i < line.readings.size(); ++i) {
    std::vector<double> row;
    for (const RigidTerm& term : terms) row.push_back(term.scale * seen(line, i, term, box, far));
    out.terms.push_back(std::move(row));
    std::vector<double> own;
    if (zero) own.push_back(1.0);
    if (reversed) own.push_back(line.readings[i].way / 2.0);
    const Corner way = way_of(line, i);
    if (line.kind == RigidLine::Kind::across && line.own_slope)
      own.push_back(dot_product(way, travel));
    if (line.kind == RigidLine::Kind::mirror)
      for (const Corner& side : across_of(line.readings[i].sense))
        own.push_back(dot_product(way, side));
    out.set_up.push_back(std::move(own));
  }
  return out;
}

Corner rigid_term(const std::string& error, std::size_t degree, const Corner& at, const Corner& low,
                  const Corner& high) {
  const RigidBox box{low, high};
  for (const Named& n : all_named)
    if (error == n.name) return error_of_term({n.name, n.kind, n.axis, n.along, degree}, box, at);
  return {};
}

}  // namespace nonio::math
