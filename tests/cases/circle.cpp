// SPDX-License-Identifier: Apache-2.0
// A circular path as positions of two axes, for cases of circles: the path is
//
//     x = (R + dR) cos t + a + ex R cos t - g R sin t + Bx/2 sgn(v_x) - T F v_x/|v|
//     y = (R + dR) sin t + b + ey R sin t + By/2 sgn(v_y)
//
// at t_j = 2 pi (j + 1/2)/points, counter-clockwise, clockwise or both.
#include "circle.h"

#include <cmath>
#include <numbers>

#include "nonio/math/circle.h"

namespace {

using namespace nonio::math;

class Path {
 public:
  explicit Path(const Case& c) : c_(c) {}

  double R() const { return get("radius_mm") * 1e-3; }
  double feed() const { return get("feed_mm_per_min") * 1e-3 / 60.0; }

  /// `actual`: the angle is that of the actual point, not the commanded one.
  CircleReading at(double t, int d, bool actual) const {
    constexpr double um = 1e-6;
    const double k = std::cos(t), s = std::sin(t), vx = -d * s, vy = d * k;
    const double r = R() + get("radius_error_um") * um;
    const double x = r * k + get("centre_X_um") * um + get("scale_X_ppm") * um * R() * k -
                     get("squareness_urad") * um * R() * s +
                     get("B_X_um") * um / 2.0 * (vx > 0.0 ? 1.0 : -1.0) -
                     get("servo_ms") * 1e-3 * feed() * vx;
    const double y = r * s + get("centre_Y_um") * um + get("scale_Y_ppm") * um * R() * s +
                     get("B_Y_um") * um / 2.0 * (vy > 0.0 ? 1.0 : -1.0);
    return {actual ? std::atan2(y, x) : t, std::hypot(x, y) - R(), d, 1};
  }

  std::vector<CircleReading> readings(bool actual) const {
    std::vector<CircleReading> out;
    const auto way = c_.options.find("directions");
    const std::string which = way == c_.options.end() ? "both" : way->second;
    const int points = static_cast<int>(get("points"));
    for (const int d : {1, -1})
      for (int j = 0; j < points && which != (d > 0 ? "cw" : "ccw"); ++j)
        out.push_back(at(2.0 * std::numbers::pi * (j + 0.5) / points, d, actual));
    return out;
  }

  /// What a public program takes for the squareness of one direction, um/m.
  double by_four_points(int d) const {
    const auto r = [&](double degrees) {
      return at(degrees * std::numbers::pi / 180.0, d, false).deviation;
    };
    return (r(45) + r(225) - r(135) - r(315)) / (2.0 * R()) * 1e6;
  }

 private:
  double get(const std::string& name) const {
    const auto found = c_.numbers.find(name);
    return found == c_.numbers.end() ? 0.0 : found->second;
  }
  const Case& c_;
};

void put_fit(const Path& path, const Case& c, Outcome& out) {
  CircleModel model;
  model.R = path.R();
  model.correlated = false;
  const auto readings = path.readings(false);
  bool plus = false, minus = false;
  for (const CircleReading& r : readings) (r.direction > 0 ? plus : minus) = true;
  all_causes(model, plus && minus);
  if (c.options.contains("eight"))
    for (const Cause more : {Cause::zero_change, Cause::centre_change_u, Cause::centre_change_v,
                             Cause::lateral_u, Cause::lateral_v, Cause::bow_u, Cause::bow_v})
      model.wanted[static_cast<std::size_t>(more)] = false;
  const auto fit = fit_causes(readings, model);
  if (!fit) return;
  const auto put = [&](const char* name, Cause cause, double factor) {
    const auto& v = fit->of[static_cast<std::size_t>(cause)];
    if (v.fitted) out.values[name] = v.value * factor;
  };
  put("a", Cause::centre_u, 1e6), put("b", Cause::centre_v, 1e6), put("r0", Cause::radius, 1e6);
  put("scale_mismatch", Cause::scale_mismatch, 1e6);
  put("squareness", Cause::squareness, 1e6);
  put("servo_mismatch_ms", Cause::servo_mismatch, 1e3 / path.feed());
  put("B_X", Cause::reversal_u, 1e6), put("B_Y", Cause::reversal_v, 1e6);
  put("lateral_X", Cause::lateral_u, 1e6), put("bow_X", Cause::bow_u, 1e6);
  double squares = 0.0;
  for (const auto& bin : fit->bins) squares += bin.residual * bin.residual;
  out.values["residual_nm"] = 1e9 * std::sqrt(squares / static_cast<double>(fit->bins.size()));
}

}  // namespace

Outcome evaluate_circle(const Case& c) {
  Outcome out;
  const Path path(c);
  const auto readings = path.readings(true);
  const double R = path.R(), um = 1e6;
  const PathCircle ls = least_squares_circle(readings, R), mz = minimum_zone(readings, R),
                   commanded = about(readings, R, {});
  out.values["centre_X"] = ls.centre[0] * um, out.values["centre_Y"] = ls.centre[1] * um;
  out.values["radius"] = ls.radius * um;
  out.values["G_LS"] = ls.width() * um, out.values["G_MZ"] = mz.width() * um;
  out.values["F_min"] = commanded.inner * um, out.values["F_max"] = commanded.outer * um;
  out.values["F_min_LS"] = ls.inner * um, out.values["F_max_LS"] = ls.outer * um;
  if (const auto h = circular_hysteresis(readings, R, ls.centre, 0.02)) out.values["H"] = h->H * um;
  out.values["four_points_ccw"] = path.by_four_points(1);
  out.values["four_points_cw"] = path.by_four_points(-1);
  out.values["four_points_mean"] = (path.by_four_points(1) + path.by_four_points(-1)) / 2.0;
  put_fit(path, c, out);
  return out;
}
