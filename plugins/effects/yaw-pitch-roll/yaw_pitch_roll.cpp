// SPDX-License-Identifier: Apache-2.0
// Angular errors of the carriages of X and Y. Chain bed - X - Y - Z - tool, x, y, z from the corner
// of the measured volume (where positions are assumed to be measured), tool in the spindle axis:
//     yaw:X   (ECX)  e_x = -y a(x)            pitch:X (EBX)  e_x = +z a(x)
//     roll:X  (EAX)  e_y = -z a(x), e_z = +y a(x)
//     pitch:Y (EAY)  e_y = -z a(y)            roll:Y  (EBY)  e_x = +z a(y)
// with a flat mirror on the tool (step diagonals), which rotates with the tool, in addition
//     (w x n) . (P - Q) a,  w: axis of the angle, n: direction of sensing, Q: a point on the beam
// and, if one carriage follows its bent guide (structure single-column), its lateral motion:
//     yaw:X   e_y = +integral of a dx         pitch:X  e_z = -integral of a dx
// a = sum c_k s_k; s_k without constant, which is squareness: the straight line, then the smooth
// basis (nonio/math/spline.h), rms 1 over the measured positions; c_k: rad. ECY and the angles of Z
// have no lever in this chain: they need a tool offset.
#include <numeric>

#include "nonio/math/spline.h"
#include "nonio/sdk/space_readings.h"

namespace nonio::yaw_pitch_roll {

namespace {

struct Lever {
  std::size_t error, along;
  double sign;
};
struct Angle {
  const char* kind;
  std::size_t axis, about;
  std::vector<Lever> levers;
  std::size_t guided;  // direction of a bent guide's effect; 3 without such an effect
  double guide_sign;
};

const std::vector<Angle>& angles() {
  static const std::vector<Angle> all = {
      {"yaw", 0, 2, {{0, 1, -1.0}}, 1, +1.0},
      {"pitch", 0, 1, {{0, 2, +1.0}}, 2, -1.0},
      {"roll", 0, 0, {{1, 2, -1.0}, {2, 1, +1.0}}, 3, 0.0},
      {"pitch", 1, 0, {{1, 2, -1.0}}, 3, 0.0},
      {"roll", 1, 1, {{0, 2, +1.0}}, 3, 0.0},
  };
  return all;
}

const Angle* angle_of(const std::string& kind, const std::string& axis) {
  for (const Angle& a : angles())
    if (kind == a.kind && axis.size() == 1 && axis[0] == letter_of(a.axis)) return &a;
  return nullptr;
}

bool follows_its_guide(const Observations& o, const Angle& a) {
  return o.structure == "single-column" && a.guided < 3;
}

/// Whether readings that sense the error of the angle move along a lever and the axis.
bool shown(const Observations& o, const SpaceReadings& s, const Angle& a) {
  if (!s.moves(a.axis)) return false;
  for (const Lever& lever : a.levers)
    if (s.moves(lever.along) && varies_where_sensed(o, s, a.axis, lever.error, lever.along))
      return true;
  return false;
}

Expected<Effect::Columns> basis_at(const std::vector<double>& x, const std::vector<double>& places,
                                   int knots) {
  const auto n = static_cast<double>(places.size());
  const double mean = std::accumulate(places.begin(), places.end(), 0.0) / n;
  double square = 0.0;
  for (const double p : places) square += (p - mean) * (p - mean) / n;
  Effect::Columns out(1);
  for (const double at : x) out[0].push_back((at - mean) / std::sqrt(square));
  if (knots < 2) return out;
  NONIO_TRY(auto smooth, math::smooth_basis(x, places, knots));
  for (auto& column : smooth) out.push_back(std::move(column));
  return out;
}

/// Integrals of the basis from the first position: two-point Gauss rule in 16 parts of each
/// interval (exact for cubics; a part may contain a knot).
Expected<Effect::Columns> integrals(const std::vector<double>& places, int knots) {
  constexpr std::size_t parts = 16;
  const double offset = 0.5 / std::sqrt(3.0);
  std::vector<double> x;
  for (std::size_t j = 0; j + 1 < places.size(); ++j)
    for (std::size_t part = 0; part < parts; ++part)
      for (const double side : {-offset, offset})
        x.push_back(places[j] + (places[j + 1] - places[j]) *
                                    (static_cast<double>(part) + 0.5 + side) /
                                    static_cast<double>(parts));
  NONIO_TRY(auto values, basis_at(x, places, knots));
  Effect::Columns out(values.size(), std::vector<double>(places.size(), 0.0));
  for (std::size_t k = 0; k < out.size(); ++k)
    for (std::size_t j = 0; j + 1 < places.size(); ++j) {
      double sum = 0.0;
      for (std::size_t q = 0; q < 2 * parts; ++q) sum += values[k][2 * parts * j + q];
      out[k][j + 1] =
          out[k][j] + sum * (places[j + 1] - places[j]) / (2.0 * static_cast<double>(parts));
    }
  return out;
}

/// Change of each reading per unit of the angle, m/rad.
std::vector<double> levers_of(const Observations& o, const SpaceReadings& s, const Angle& a) {
  std::vector<double> out(o.size(), 0.0);
  for (std::size_t i = 0; i < o.size(); ++i)
    for (const Lever& l : a.levers) out[i] += l.sign * s.lever(l.along, i) * o.sense_of(i)[l.error];
  SpaceLine::Vector about{};
  about[a.about] = 1.0;
  for (std::size_t number = 0; number < o.lines.size(); ++number) {
    const SpaceLine line = space_line(o, s, number);
    const bool one_sense = std::all_of(line.rows.begin(), line.rows.end(), [&](std::size_t i) {
      return SpaceLine::dot(o.sense_of(i), line.sense) > 1.0 - 1e-9;
    });
    if (!one_sense || !line.is_stepwise()) continue;  // circles are not sensed in one direction
    const auto turned = SpaceLine::cross(about, line.sense);
    // The beam meets the far corner, at which all axes have made all steps.
    const auto far = *std::max_element(
        line.way.begin(), line.way.end(), [&](const auto& one, const auto& other) {
          return SpaceLine::dot(one, line.sense) < SpaceLine::dot(other, line.sense);
        });
    for (std::size_t i = 0; i < line.rows.size(); ++i)
      out[line.rows[i]] += SpaceLine::dot(turned, line.way[i]) - SpaceLine::dot(turned, far);
  }
  return out;
}

Expected<Effect::Columns> columns(const Observations& o, const Angle& a, int knots) {
  const SpaceReadings s = space_of(o);
  if (!s.moves(a.axis)) return fail(std::string(a.kind) + ": these readings do not move the axis");
  const std::vector<double> places = places_of(s, a.axis);
  NONIO_TRY(const auto basis, basis_at(finite_or_zero(s.r[a.axis]), places, knots));
  const std::vector<double> levers = levers_of(o, s, a);
  const bool guided = follows_its_guide(o, a);
  NONIO_TRY(const auto ways, guided ? integrals(places, knots) : Expected<Effect::Columns>{});
  Effect::Columns out(basis.size(), std::vector<double>(o.size(), 0.0));
  for (std::size_t i = 0; i < o.size(); ++i) {
    if (!std::isfinite(s.r[a.axis][i])) continue;
    const auto above =
        std::lower_bound(places.begin(), places.end(), s.r[a.axis][i] - 1e-6 * s.length[a.axis]);
    const auto place = static_cast<std::size_t>(std::min(above, places.end() - 1) - places.begin());
    for (std::size_t k = 0; k < out.size(); ++k) {
      out[k][i] = levers[i] * basis[k][i];
      if (guided) out[k][i] += a.guide_sign * ways[k][place] * o.sense_of(i)[a.guided];
    }
  }
  return out;
}

Effect effect_of(const char* kind, const char* summary) {
  Effect e;
  e.info = {kind, "1.0.0", summary};
  e.linear = {{"a", "rms of the angle over the places", Quantity::small_angle}};
  const auto grid = [kind](const Observations& o, const Axis& place) {
    const Angle* a = angle_of(kind, place.name);
    if (a == nullptr) return std::vector<double>{};
    std::vector<double> knots = knots_over(places_of(space_of(o), a->axis));
    if (knots.size() == 1 && knots.front() < 3.0) knots.clear();  // too few places for an angle
    knots.insert(knots.begin(), 0.0);
    return knots;
  };
  e.shapes = {{{"knots", "knots of the spline in addition to the straight line; 0: the line alone",
                Quantity::count},
               grid,
               false}};
  e.curve = true;
  e.applies = [](const Observations&, const Axis&) { return true; };
  e.columns = [kind](const Observations& o, const Axis& place,
                     const std::vector<double>& shape) -> Expected<Effect::Columns> {
    const Angle* a = angle_of(kind, place.name);
    if (a == nullptr)
      return fail(std::string(kind) + ": expected X or Y, whose angles have a lever; found " +
                  place.name);
    if (shape.size() != 1 || !(shape[0] >= 0.0 && shape[0] <= 1000.0))
      return fail(std::string(kind) + ": expected a number of knots, 0 to 1000");
    return columns(o, *a, static_cast<int>(std::lround(shape[0])));
  };
  e.instances = [kind](const Observations& o) {
    std::vector<std::string> names;
    if (of_ball_centres(o)) return names;
    const SpaceReadings s = space_of(o);
    for (const Angle& a : angles())
      if (std::string_view(kind) == a.kind && shown(o, s, a)) names.push_back({letter_of(a.axis)});
    return names;
  };
  return e;
}

}  // namespace

NONIO_PLUGIN(registry) {
  Effect yaw = effect_of(
      "yaw", "The carriage turns about the vertical as it travels (on a gantry: racking)");
  yaw.of_part = "part-yaw";
  registry.add(yaw);
  registry.add(in_frame_of_parts(
      yaw, {"part-yaw", "1.0.0",
            "A twist that turns with the part: of fixture, clamping or measuring machine"}));
  registry.add(effect_of("pitch", "The carriage nods as it travels"));
  registry.add(effect_of("roll", "The carriage turns about its own direction of travel"));
}

}  // namespace nonio::yaw_pitch_roll
