// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/rotary_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "common/constants.h"
#include "nonio/math/rotary.h"
#include "nonio/sdk/splitmix64.h"

namespace nonio::math {

namespace {

/// Generates independent standard normal numbers, two at a time (Box and Muller 1958).
class NormalNumbers {
 public:
  explicit NormalNumbers(std::uint64_t seed) : random_(seed) {}
  double operator()() {
    if (has_second_) {
      has_second_ = false;
      return second_;
    }
    const double r = std::sqrt(-2.0 * std::log1p(-random_.uniform())),
                 t = full_turn * random_.uniform();
    second_ = r * std::sin(t);
    has_second_ = true;
    return r * std::cos(t);
  }

 private:
  SplitMix64 random_;
  double second_ = 0.0;
  bool has_second_ = false;
};

Expected<void> sound(const RotaryPlan& p) {
  if (p.balls < 3 || p.balls > 10000)
    return fail("expected 3 to 10000 balls, found " + std::to_string(p.balls));
  if (!(p.arc > 0.0 && p.arc <= full_turn * (1.0 + 1e-9)))
    return fail("expected an arc above 0 and up to 360 degrees");
  if (!(p.sigma > 0.0) || !(p.radius > 100.0 * p.sigma))
    return fail("expected a radius of more than 100 times the uncertainty of the probe");
  return {};
}

std::vector<BallCentre> places_of(const RotaryPlan& p) {
  const bool full = p.arc > full_turn * (1.0 - 1e-9);
  const double n = static_cast<double>(p.balls), step = full ? p.arc / n : p.arc / (n - 1.0);
  std::vector<BallCentre> out;
  for (std::size_t i = 0; i < p.balls; ++i) {
    const double angle = step * static_cast<double>(i);
    out.push_back({{p.radius * std::cos(angle), p.radius * std::sin(angle), 0.0}, angle, 1.0});
  }
  return out;
}

/// Returns the larger eigenvalue of [a b; b c].
double larger(double a, double b, double c) { return (a + c) / 2.0 + std::hypot((a - c) / 2.0, b); }

}  // namespace

Expected<RotaryPlanU> expected_of(const RotaryPlan& plan) {
  if (auto ok = sound(plan); !ok) return fail(ok.error());
  const auto fit = fit_rotary(places_of(plan), false);
  if (!fit) return fail("expected places that determine an axis: the arc is too short");
  const auto& C = fit->cofactor;
  RotaryPlanU u;
  u.across = plan.sigma * std::sqrt(larger(C[0][0], C[0][1], C[1][1]));
  u.along = plan.sigma * std::sqrt(C[2][2]);
  u.centre_rms = plan.sigma * std::sqrt(C[0][0] + C[1][1] + C[2][2]);
  u.tilt = plan.sigma * std::sqrt(larger(C[3][3], C[3][4], C[4][4]));
  u.direction_rms = plan.sigma * std::sqrt(C[3][3] + C[4][4]);
  return u;
}

Expected<RotaryPlanU> simulated(const RotaryPlan& plan, std::size_t trials, std::uint64_t seed) {
  if (auto ok = sound(plan); !ok) return fail(ok.error());
  if (trials < 10) return fail("expected 10 trials or more, found " + std::to_string(trials));
  const auto exact = places_of(plan);
  NormalNumbers normal(seed);
  std::array<double, 6> squares{};  // sums of xx, xy, yy: of the center, then of the tilt
  double along = 0.0, distance = 0.0, angle = 0.0;
  for (std::size_t t = 0; t < trials; ++t) {
    auto read = exact;
    for (BallCentre& ball : read)
      for (double& coordinate : ball.at) coordinate += plan.sigma * normal();
    const auto fit = fit_rotary(read, false);
    if (!fit) return fail("expected places that determine an axis: the arc is too short");
    const auto& c = fit->centre;
    const double side = fit->direction[2] < 0.0 ? -1.0 : 1.0, i = side * fit->direction[0],
                 j = side * fit->direction[1];
    squares[0] += c[0] * c[0], squares[1] += c[0] * c[1], squares[2] += c[1] * c[1];
    squares[3] += i * i, squares[4] += i * j, squares[5] += j * j;
    along += c[2] * c[2];
    distance += std::sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
    angle += std::asin(std::min(1.0, std::hypot(i, j)));
  }
  const double n = static_cast<double>(trials);
  RotaryPlanU u;
  u.across = std::sqrt(larger(squares[0], squares[1], squares[2]) / n);
  u.along = std::sqrt(along / n);
  u.centre_rms = std::sqrt((squares[0] + squares[2] + along) / n);
  u.centre_mean = distance / n;
  u.tilt = std::sqrt(larger(squares[3], squares[4], squares[5]) / n);
  u.direction_rms = std::sqrt((squares[3] + squares[5]) / n);
  u.direction_mean = angle / n;
  return u;
}

Expected<std::size_t> cheapest(RotaryPlan plan, double U_centre, double U_direction,
                               std::size_t most) {
  for (plan.balls = 3; plan.balls <= most; ++plan.balls) {
    NONIO_TRY(const auto u, expected_of(plan));
    const bool centre = U_centre == 0.0 || 2.0 * u.across <= U_centre * (1.0 + 1e-9),
               direction = U_direction == 0.0 || 2.0 * u.tilt <= U_direction * (1.0 + 1e-9);
    if (centre && direction) return plan.balls;
  }
  return fail("expected an uncertainty that up to " + std::to_string(most) +
              " balls reach on this radius and arc");
}

}  // namespace nonio::math
