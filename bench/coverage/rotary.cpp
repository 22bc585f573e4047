// SPDX-License-Identifier: Apache-2.0
//
// Rotary axes from ball centres on a table that turns exactly.
#include <cmath>

#include "coverage.h"
#include "table.h"

namespace nonio::coverage {
namespace {

using turntable::Table;

constexpr double bound = 3 * urad;  // of squareness and scale differences of the linear axes

/// The linear axes of the machine as they read a ball: the same for all circles of a campaign.
class Reader {
 public:
  Reader(const Scenario&, Day& day, std::size_t touches) : day_(day) {
    for (auto& one : axes_) one = day.coordinate(touches);
    for (const auto& [i, k] : {std::pair{0, 1}, {0, 2}, {1, 2}, {0, 0}, {1, 1}, {2, 2}})
      shear_(i, k) = day.uniform(bound);
  }

  /// Exact centres as they are read, one after the other. Squareness errors are zero at `about`.
  void read(std::vector<math::BallCentre>& centres, const Eigen::Vector3d& about) {
    for (auto& centre : centres) {
      const Eigen::Vector3d p(centre.at[0], centre.at[1], centre.at[2]);
      const Eigen::Vector3d sheared = shear_ * (p - about);
      for (std::size_t k = 0; k < 3; ++k)
        centre.at[k] += axes_[k].offset + axes_[k].stretch * centre.at[k] + axes_[k].drift[next_] +
                        sheared[static_cast<Eigen::Index>(k)] + day_.touch();
      ++next_;
    }
  }

 private:
  Day& day_;
  std::array<Day::Coordinate, 3> axes_;
  Eigen::Matrix3d shear_ = Eigen::Matrix3d::Zero();
  std::size_t next_ = 0;
};

Settings settings_of(const Analysis& a) {
  Settings s = defaults(a);
  s.values["linear_axes_urad"] = bound / urad;
  s.values["tolerance_um"] = 1e5;
  s.values["tolerance_urad"] = 1e5;
  s.values["circle_limit"] = 1e6;
  return s;
}

const Analysis& rotary() {
  static const Analysis analysis = loaded_analysis(NONIO_ANALYSES, "rotary-kinematics");
  return analysis;
}

Table table_of(const Scenario& s, std::mt19937& rng) {
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  Table table;
  table.radius = s.size / 4.0;
  table.centre = s.size * Eigen::Vector3d(0.4 + 0.1 * u(rng), 0.3, 0.2);
  table.direction = Eigen::Vector3d(0.3 * u(rng), 0.3 * u(rng), 1.0).normalized();
  table.phase = 3.0 * u(rng);
  return table;
}

void put(const Evaluation& e, const Table& table, Tally& tally) {
  for (const Value& v : e.values) {
    if (!v.U) continue;
    const auto k = static_cast<Eigen::Index>(v.name.back() - 'x'),
               d = static_cast<Eigen::Index>(v.name.back() - 'i');
    if (v.name.starts_with("centre")) tally.put("centre", v.value - table.centre[k], *v.U);
    if (v.name.starts_with("direction") && d < 2)
      tally.put("direction", v.value - table.direction[d], *v.U);
    if (v.name == "radius") tally.put("radius", v.value - table.radius, *v.U);
  }
  for (const Series& curve : e.series)
    for (std::size_t i = 0; i < curve.U.size(); ++i)
      tally.put(curve.name, curve.value[i], curve.U[i]);
}

void circle(const Scenario& s, unsigned seed, double size, Tally& tally, int points, double arc,
            bool told) {
  std::mt19937 rng(seed);
  const Table table = table_of(s, rng);
  auto centres =
      table.at(arc > 0.0 ? turntable::arc(0.0, arc, points) : turntable::full_turn(points));
  Day day(s, seed, size);
  Reader(s, day, centres.size()).read(centres, table.centre);
  Campaign c = stated(s);
  c.measurements.push_back(named("C", "ball-centres", "C"));
  Settings settings = settings_of(rotary());
  if (told) settings.values["sigma_um"] = s.repeatability;
  put(evaluated(rotary(), c, 0, {turntable::observed(centres)}, settings), table, tally);
}

void eight(const Scenario& s, unsigned seed, double size, Tally& t) {
  circle(s, seed, size, t, 8, 0.0, false);
}
void eight_told(const Scenario& s, unsigned seed, double size, Tally& t) {
  circle(s, seed, size, t, 8, 0.0, true);
}
void four(const Scenario& s, unsigned seed, double size, Tally& t) {
  circle(s, seed, size, t, 4, 0.0, false);
}
void half_turn(const Scenario& s, unsigned seed, double size, Tally& t) {
  circle(s, seed, size, t, 11, std::numbers::pi, false);
}

void two_axes(const Scenario& s, unsigned seed, double size, Tally& tally) {
  std::mt19937 rng(seed);
  const Table c = table_of(s, rng);
  Table a = table_of(s, rng);
  a.direction = Eigen::Vector3d(1.0, 0.1, 0.05).normalized();
  a.centre += s.size * Eigen::Vector3d(0.0, 0.05, -0.1);
  Day day(s, seed, size);
  auto on_a = a.at(turntable::full_turn(8)), on_c = c.at(turntable::full_turn(8));
  Reader reader(s, day, on_a.size() + on_c.size());
  const Eigen::Vector3d middle = (a.centre + c.centre) / 2.0;
  reader.read(on_a, middle);
  reader.read(on_c, middle);
  Campaign campaign = stated(s);
  campaign.measurements = {named("A", "ball-centres", "A"), named("C", "ball-centres", "C")};
  Settings settings = settings_of(rotary());
  settings.values["same_reference"] = std::vector<std::string>{"A", "C"};
  const Evaluation e =
      evaluated(rotary(), campaign, 1,
                {turntable::observed(on_a, "A"), turntable::observed(on_c, "C")}, settings);
  const Eigen::Vector3d across = a.direction.cross(c.direction);
  const double distance = std::fabs((c.centre - a.centre).dot(across)) / across.norm(),
               angle = std::atan2(across.norm(), a.direction.dot(c.direction));
  for (const Value& v : e.values) {
    if (v.name == "distance_A" && v.U) tally.put("distance", v.value - distance, *v.U);
    if (v.name == "angle_A" && v.U) tally.put("angle", v.value - angle, *v.U);
  }
}

}  // namespace

const std::vector<Method> rotary_methods{{"rotary axis, 8 points", eight},
                                         {"rotary axis, 8 points, sigma stated", eight_told},
                                         {"rotary axis, 4 points", four},
                                         {"rotary axis, 11 points on a half turn", half_turn},
                                         {"two rotary axes", two_axes}};

}  // namespace nonio::coverage
