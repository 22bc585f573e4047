// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/results.h"

/// Stops for two axes and both diagonals of their rectangle such that the steps of all three are
/// whole multiples of the control's resolution.
///
/// Euclid: every primitive Pythagorean triple is (m^2 - k^2, 2 m k, m^2 + k^2) with m > k > 0
/// coprime and of opposite parity; both orders of the legs are plans. The legs are coprime, so the
/// three steps are multiples of the resolution r exactly if step = q (a, b, c) r with q integer.
/// Where X and Y have resolutions (scale factors) of their own, r is the largest common divisor of
/// all, k = rx/r, ry/r, rd/r, and q is a multiple of each k / gcd(k, leg).
///
///     U = travel - 2 over-travel          usable length of an axis, m
///     n = steps; n + 1 stops              n q a r <= Ux, n q b r <= Uy
///     length = n step                     coverage = length / U, by axis
///     Lx, Ly, L = lengths, c = Lx / L, s = Ly / L
///
/// What a scatter u of one reading of the diagonals does to the straightness computed from them:
///
///     EXY = (D1 + D2) / (2 c)   u L / (2 Lx), and of the even part, zero at both ends, 0.61 u / c
///     EYX = (D1 - D2) / (2 s)   u L / (2 Ly), likewise 0.61 u / s;   0.61 = sqrt(6) / 4
///
/// Source: Euclid, Elements X, 29 (lemma); the rest derived, checked against a brute-force search.
namespace nonio::math {

struct Triple {
  std::int64_t a = 0, b = 0, c = 0;  ///< a^2 + b^2 = c^2
};

/// All primitive triples with a < b and c <= `hypotenuse`, by c, then a.
std::vector<Triple> primitive_triples(std::int64_t hypotenuse);

/// An even number of steps has a stop at mid-travel; only then can every second stop along X make
/// the third diagonal, to half of Y, which separates what two diagonals leave together.
enum class EvenSteps : std::uint8_t {
  any,
  prefer,  ///< an odd plan must cover 0.01 more of the worse axis to precede an even one
  require,
};

struct TripleRequest {
  double x = 0.0, y = 0.0;   ///< travel, m
  double over_travel = 0.0;  ///< kept free at each end of both axes, m
  double resolution = 1e-3;  ///< r, m; steps are whole multiples of it
  /// Of the steps of one axis, m; 0: as `resolution`, of which then the diagonal's are multiples.
  double resolution_x = 0.0, resolution_y = 0.0;
  double largest_step = 0.0;  ///< of either axis, m; 0: any
  std::int64_t max_points = 1500;
  std::vector<double> pitch_x{}, pitch_y{};  ///< of screw, rack, scale: no step is a multiple, m
  /// ISO 230-2 sampling: on an axis of up to 2 m five targets a metre, above 250 mm between them.
  bool density = false;
  EvenSteps even = EvenSteps::any;
  std::int64_t hypotenuse = 5000;
  std::size_t count = 5;  ///< plans to give
};

enum class TripleReason : std::uint8_t {
  best,           ///< the worse axis is covered furthest; then area, fewest stops, smallest c
  area,           ///< the largest measured rectangle
  even,           ///< the best with an even number of steps
  dense,          ///< the best whose stops are an ISO 230-2 sampling
  fewest_stops,   ///< of plans near the best
  small_numbers,  ///< the smallest c of plans near the best
  next,           ///< the next triple in the order
};
/// How near: share of the best plan's coverage of the worse axis.
// docs/dev/constants.md, A10.
inline constexpr double near_best = 0.95;

struct TriplePlan {
  std::int64_t a = 0, b = 0, c = 0;  ///< along X, along Y, along the diagonal
  std::int64_t q = 0, n = 0;
  double step_x = 0.0, step_y = 0.0, step_d = 0.0;        ///< m
  double length_x = 0.0, length_y = 0.0, length_d = 0.0;  ///< m
  double cover_x = 0.0, cover_y = 0.0;                    ///< of the usable length
  bool dense = false;                                     ///< an ISO 230-2 sampling
  std::vector<TripleReason> reasons;

  bool even() const { return n % 2 == 0; }
  double worst_cover() const { return cover_x < cover_y ? cover_x : cover_y; }
  double area() const { return length_x * length_y; }
  double gain_EYX() const { return length_d / (2.0 * length_y); }
  double gain_EXY() const { return length_d / (2.0 * length_x); }
  double gain_EYX_even() const;
  double gain_EXY_even() const;
  /// A straightness that comes out with more than three times the scatter of a reading.
  bool flat() const { return gain_EYX() > 3.0 || gain_EXY() > 3.0; }
};

enum class TripleLimit : std::uint8_t {
  travel,  ///< shorter than five points of the smallest triple
  largest_step,
  max_points,
  pitch,
  density,
  even,
  hypotenuse,
};

struct TriplePlans {
  std::vector<TriplePlan> plans;  ///< the best first; empty if nothing fits
  /// Why nothing fits: each limit without which, alone, something would. If there is none,
  /// `together` holds the limits that only together leave nothing.
  std::vector<TripleLimit> blocked_by, together;
  std::int64_t tried = 0;  ///< plans that were looked at
};

/// A search of more than this many plans is refused, before it begins.
inline constexpr std::int64_t most_tried = 20'000'000;

Expected<TriplePlans> plan_triples(const TripleRequest& wish);

/// What the time of a measurement depends on.
struct MeasuringCost {
  std::int64_t runs = 5;   ///< there and back
  double feed = 2.0 / 60;  ///< m/s
  double dwell = 5.0;      ///< at each stop, s
};
/// Of X, Y and both diagonals, there and back in each run, s.
double measuring_time(const TriplePlan&, const MeasuringCost&);

/// The cheapest plan of each triple and order of its legs that covers so much of both axes, each
/// number of steps with the largest step that fits. Empty: none does.
Expected<std::vector<TriplePlan>> cheapest_plans(const TripleRequest& wish, double least_cover,
                                                 const MeasuringCost&);

/// A row a plan, with the names of the contract and the noise gains.
PointTable triple_table(const std::vector<TriplePlan>& plans);

/// The order of preference.
bool comes_before(const TriplePlan& one, const TriplePlan& other, EvenSteps even);

}  // namespace nonio::math
