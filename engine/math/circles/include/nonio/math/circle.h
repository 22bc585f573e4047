// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"

/// Circular paths (ISO 230-4): their deviations, and the causes of them.
///
/// t: angle from the first axis of the plane towards the second (X, Y; Y, Z; Z, X), rad; r(t): radial
/// deviation from the commanded radius R, m; d = +1 counter-clockwise, -1 clockwise. Causes, to first
/// order (u: first axis, v: second):
///
///     a cos t + b sin t + r0                         set-up, radius
///     + (eu - ev) R/2 cos 2t                         scale mismatch
///     - g R/2 sin 2t                                 squareness: g > 0 turns +v towards -u
///     + d w/2 sin 2t                                 servo mismatch, w = F (1/Kvu - 1/Kvv)
///     - d Bu/2 sgn(sin t) cos t + d Bv/2 sgn(cos t) sin t    reversal (B < 0: lost motion)
///     - d Lu/2 sgn(sin t) sin t + d Lv/2 sgn(cos t) cos t    lateral play: v moves when u reverses
///     + (A1 sin q + A2 cos q) cos t, q = 2 pi R cos t/p      cyclic error of u (v: sin t)
///     + k R^2 cos^2 t sin t                          bow of u: e_v = k u^2 (v: sin^2 t cos t)
///
/// Sources: ISO 230-4:2005 (names of G, G(b), F, D; H of 1996); the standards' texts were not
/// available. The decomposition is derived (docs/formulas.md). Range: deviations far below R.
namespace nonio::math {

struct CircleReading {
  double angle = 0.0;      ///< t, rad
  double deviation = 0.0;  ///< r, m
  int direction = 1;       ///< +1 counter-clockwise, -1 clockwise
  std::uint32_t run = 1;
};

/// About one centre: m from the commanded one; radii less R.
struct PathCircle {
  std::array<double, 2> centre{};
  double radius = 0.0;                       ///< of the least-squares circle, less R
  double inner = 0.0, outer = 0.0;           ///< least and largest distance, less R
  std::size_t innermost = 0, outermost = 0;  ///< readings
  double width() const { return outer - inner; }
};

/// Least-squares circle through the path (geometric distances).
PathCircle least_squares_circle(std::span<const CircleReading>, double R);
/// Two concentric circles of least radial distance that hold the path.
PathCircle minimum_zone(std::span<const CircleReading>, double R);
/// Distances from a given centre.
PathCircle about(std::span<const CircleReading>, double R, std::array<double, 2> centre);

/// H: the largest distance of the two paths at one angle, about one centre; where. Absent where no
/// angle has both. `step`: widest gap of readings that is bridged, rad.
struct Hysteresis {
  double H = 0.0, angle = 0.0;
};
std::optional<Hysteresis> circular_hysteresis(std::span<const CircleReading>, double R,
                                              std::array<double, 2> centre, double step);

enum class Cause : std::uint8_t {
  centre_u,
  centre_v,
  radius,
  zero_change,  ///< of the radius between the two directions, half of it
  scale_mismatch,
  squareness,
  servo_mismatch,
  reversal_u,
  reversal_v,
  lateral_u,
  lateral_v,
  bow_u,
  bow_v,
  cyclic_u_sin,
  cyclic_u_cos,
  cyclic_v_sin,
  cyclic_v_cos,
  count
};
constexpr std::size_t cause_count = static_cast<std::size_t>(Cause::count);

struct CircleModel {
  double R = 0.0;                          ///< m
  std::array<double, 2> centre{};          ///< of the circle, machine coordinates, m
  std::array<double, 2> pitch{};           ///< of the drives, m; 0: not known
  std::array<bool, cause_count> wanted{};  ///< set by `all_causes`
  double leave_out = 0.0;                  ///< rad, on both sides of each reversal
  bool correlated = true;                  ///< false: as if each mean had noise of its own only
  /// Whether a reading at this angle is too near to a reversal for the fit.
  bool leaves_out(double angle) const;
};
/// Limits for readings of these directions and pitches.
void all_causes(CircleModel&, bool both_directions);

/// What a cause of size 1 makes of the radius: m/m, or m/rad.
double cause_at(Cause, const CircleModel&, double angle, int direction);

struct CauseFit {
  struct Value {
    bool fitted = false;
    double value = 0.0, u = 0.0, dof = 0.0;
    double inflation = 1.0;        ///< variance against that of the column alone
    std::vector<double> by_bin{};  ///< derivative by the mean of each bin
  };
  std::array<Value, cause_count> of;
  /// Means that were fitted: direction, angle, deviation, residual; counter-clockwise first, each in
  /// the order of the travel.
  struct Bin {
    double angle = 0.0, deviation = 0.0, residual = 0.0;
    int direction = 1;
  };
  std::vector<Bin> bins;
  double s = 0.0;            ///< standard deviation of a bin's residual
  double s_reading = 0.0;    ///< of a single reading's: a bin is the mean of several
  double correlation = 0.0;  ///< of neighbouring bins (1 deg apart)
  double dof = 0.0;          ///< effective, the least of all causes
  double covariance(Cause a, Cause b) const;
  /// The radial deviation that the fitted causes make.
  double radius_at(const CircleModel&, double angle, int direction) const;
  double u_at(const CircleModel&, double angle, int direction) const;
  std::vector<double> covariance_of{};  ///< cause_count x cause_count; 0 where not fitted
};

/// Least squares weighted by the correlation of the residuals themselves: noise of the mean and of
/// the difference of both directions apart, each white noise and a first-order autoregressive
/// process (REML). An error where readings are too few.
Expected<CauseFit> fit_causes(std::span<const CircleReading>, const CircleModel&);

/// What noise adds to the largest of many readings, of which it always takes the noisiest. Paths are
/// made from the fit and its residuals, which are given back turned by parts of the turn in each
/// direction and run (the same for all, so that what both directions share stays shared). Readings
/// that are not in the fit keep what they read and get noise besides.
class CircleNoise {
 public:
  static constexpr std::size_t times = 36;
  CircleNoise(std::span<const CircleReading>, const CircleModel&, const CauseFit&);
  const std::vector<CircleReading>& truth() const { return truth_; }
  /// k: 0 .. times - 1. In the order of the readings.
  std::vector<CircleReading> turned(std::size_t k) const;
  /// Mean over all turns of value(path) less value(truth()), m.
  template <class Value>
  double adds(const Value& value) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < times; ++k) sum += value(turned(k));
    return sum / static_cast<double>(times) - value(truth_);
  }

 private:
  struct From {
    std::size_t first = 0, count = 0, place = 0;  ///< of residuals_
  };
  std::vector<CircleReading> truth_;
  std::vector<From> from_;  ///< by reading
  std::vector<double> residuals_;
};

/// A reversal spike: the largest residual within 5 deg behind a reversal, and its width at half
/// height.
struct Spike {
  double at = 0.0;  ///< angle of the reversal, rad
  int direction = 1;
  bool of_v = false;                 ///< the second axis reverses there
  double height = 0.0, width = 0.0;  ///< m, rad
  double u = 0.0;                    ///< of the height
};
std::vector<Spike> reversal_spikes(std::span<const CircleReading>, const CircleModel&,
                                   const CauseFit&);

/// The fit, with a zone next to the reversals that is widened, from `model.leave_out` to `most` at
/// most, until no spike above 6 u is left outside of it. The zone is stored in the model.
Expected<CauseFit> fit_causes_without_spikes(std::span<const CircleReading>, CircleModel& model,
                                             double most);

}  // namespace nonio::math
