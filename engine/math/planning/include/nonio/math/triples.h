// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/results.h"

/// Plans stops for two axes and both diagonals of their rectangle such that the steps of all three
/// are integer multiples of the control's resolution r. The legs of primitive Pythagorean triples
/// are coprime, so that the steps are q (a, b, c) r with q integer; a resolution for each axis:
/// docs/dev/estimators.md, Plans of diagonals.
///
///     U = travel - 2 over-travel    usable length of an axis, m
///     n = steps; n + 1 stops        n q a r <= Ux, n q b r <= Uy
///     length = n step               coverage = length / U, by axis
///
/// With the measured lengths Lx, Ly and L (diagonal), c = Lx / L and s = Ly / L, a scatter u of one
/// reading of the diagonals gives EXY the scatter u L / (2 Lx) and its even part 0.61 u / c; EYX u
/// L / (2 Ly) and 0.61 u / s. Source: Euclid, Elements X, 29 (lemma); the rest derived.
namespace nonio::math {

struct Triple {
  std::int64_t a = 0, b = 0, c = 0;  ///< legs a and b, hypotenuse c: a^2 + b^2 = c^2
};

/// Returns all primitive triples with a < b and c <= `hypotenuse`, sorted by c, then a.
std::vector<Triple> primitive_triples(std::int64_t hypotenuse);

/// An even number of steps has a stop at mid-travel, and allows the third diagonal, to half of Y,
/// which separates errors that two diagonals cannot separate.
enum class EvenSteps : std::uint8_t {
  any,
  prefer,  ///< an odd plan ranks before an even one only if it covers 0.01 more of the worse axis
  require,
};

struct TripleRequest {
  double x = 0.0, y = 0.0;   ///< travel of each axis, m
  double over_travel = 0.0;  ///< reserve at each end of both axes, m
  double resolution = 1e-3;  ///< r, m; steps are integer multiples of r
  /// Resolution of each axis, m; 0: `resolution`, which always applies to the diagonal.
  double resolution_x = 0.0, resolution_y = 0.0;
  double largest_step = 0.0;  ///< largest step of either axis, m; 0: no limit
  std::int64_t max_points = 1500;
  /// periods of screw, rack or scale, m; no step may be a multiple of a period
  std::vector<double> pitch_x{}, pitch_y{};
  /// Whether ISO 230-2 sampling is required: five targets per meter up to 2 m, above 2 m one every
  /// 250 mm.
  bool density = false;
  EvenSteps even = EvenSteps::any;
  std::int64_t hypotenuse = 5000;
  std::size_t count = 5;
};

enum class TripleReason : std::uint8_t {
  best,           ///< largest coverage of the worse axis; if equal, area, number of stops, c
  area,           ///< the largest measured rectangle
  even,           ///< the best plan with an even number of steps
  dense,          ///< the best plan with the sampling of ISO 230-2
  fewest_stops,   ///< fewest stops among plans near the best
  small_numbers,  ///< smallest c among plans near the best
  next,           ///< next triple in the order of preference
};
/// Share of the best coverage of the worse axis from which a plan is near the best:
/// docs/dev/constants.md, A10.
inline constexpr double near_best = 0.95;

struct TriplePlan {
  std::int64_t a = 0, b = 0, c = 0;  ///< legs along X and Y, hypotenuse along the diagonal
  std::int64_t q = 0, n = 0;
  double step_x = 0.0, step_y = 0.0, step_d = 0.0;  ///< steps along X, Y and the diagonal, m
  /// measured lengths along X, Y and the diagonal, m
  double length_x = 0.0, length_y = 0.0, length_d = 0.0;
  double cover_x = 0.0, cover_y = 0.0;  ///< measured fraction of the usable length of X and of Y
  bool dense = false;                   ///< whether the stops are as dense as ISO 230-2 requires
  std::vector<TripleReason> reasons;

  bool even() const { return n % 2 == 0; }
  double worst_cover() const { return cover_x < cover_y ? cover_x : cover_y; }
  double area() const { return length_x * length_y; }
  double gain_EYX() const { return length_d / (2.0 * length_y); }
  double gain_EXY() const { return length_d / (2.0 * length_x); }
  double gain_EYX_even() const;
  double gain_EXY_even() const;
  /// Returns whether a straightness would have more than three times the scatter of a reading.
  bool flat() const { return gain_EYX() > 3.0 || gain_EXY() > 3.0; }
};

enum class TripleLimit : std::uint8_t {
  travel,  ///< the travel is too short for four steps of the smallest triple
  largest_step,
  max_points,
  pitch,
  density,
  even,
  hypotenuse,
};

struct TriplePlans {
  std::vector<TriplePlan> plans;  ///< the best first; empty if no plan fits
  /// Reason if no plan fits: each limit whose removal alone (for max_points and hypotenuse: a
  /// factor of 20) would allow a plan, or `travel` if no plan fits even without all limits. If only
  /// their combination excludes every plan, `together` contains all limits of the request.
  std::vector<TripleLimit> blocked_by, together;
  std::int64_t tried = 0;
};

/// A search with more plans than this is rejected before it begins.
inline constexpr std::int64_t most_tried = 20'000'000;

Expected<TriplePlans> plan_triples(const TripleRequest& wish);

struct MeasuringCost {
  std::int64_t runs = 5;   ///< number of runs; each is in both directions
  double feed = 2.0 / 60;  ///< speed of travel, m/s
  double dwell = 5.0;      ///< time at each stop, s
};
/// Returns the duration of measuring X, Y and both diagonals, forward and back in each run, s.
double measuring_time(const TriplePlan&, const MeasuringCost&);

/// Returns, for each triple and order of its legs, the plan with the shortest `measuring_time` that
/// covers at least `least_cover` of both axes, with the largest step that fits; empty if no plan
/// fits. Errors: an invalid request, more than `most_tried` plans.
Expected<std::vector<TriplePlan>> cheapest_plans(const TripleRequest& wish, double least_cover,
                                                 const MeasuringCost&);

/// Returns a table with one row per plan.
PointTable triple_table(const std::vector<TriplePlan>& plans);

bool comes_before(const TriplePlan& one, const TriplePlan& other, EvenSteps even);

}  // namespace nonio::math
