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

/// Deviations of circular paths (ISO 230-4), and their causes.
///
/// t: angle from the first axis of the plane toward the second (X, Y; Y, Z; Z, X), rad; r(t):
/// radial deviation from the commanded radius R, m; d = +1 counter-clockwise, -1 clockwise. Causes,
/// to first order (u: first axis, v: second):
///
///     a cos t + b sin t + r0                              set-up, radius
///     + (eu - ev) R/2 cos 2t                              scale mismatch
///     - g R/2 sin 2t                                      squareness: g > 0 turns +v toward -u
///     + d w/2 sin 2t                                      servo mismatch, w = F (1/Kvu - 1/Kvv)
///     - d Bu/2 sgn(sin t) cos t + d Bv/2 sgn(cos t) sin t reversal (B < 0: lost motion)
///     - d Lu/2 sgn(sin t) sin t + d Lv/2 sgn(cos t) cos t lateral play: v moves when u reverses
///     + (A1 sin q + A2 cos q) cos t, q = 2 pi R cos t/p   cyclic error of u (v: sin t)
///     + k R^2 cos^2 t sin t                               bow of u: e_v = k u^2 (v: sin^2 t cos t)
///
/// Sources: ISO 230-4:2005 (names of G, G(b), F, D; H of 1996), whose texts were not available; the
/// decomposition is derived (docs/formulas.md) for deviations much smaller than R.
namespace nonio::math {

struct CircleReading {
  double angle = 0.0;      ///< angle t from the first axis, rad
  double deviation = 0.0;  ///< radial deviation r, m
  int direction = 1;
  std::uint32_t run = 1;
};

/// Distances of the readings of a path, m, from a center that is relative to the commanded one.
struct PathCircle {
  std::array<double, 2> centre{};
  /// Mean distance from the center, minus R: the radius deviation of the least-squares circle.
  double radius = 0.0;
  double inner = 0.0, outer = 0.0;  ///< smallest and largest distance from the center, minus R
  std::size_t innermost = 0, outermost = 0;
  double width() const { return outer - inner; }
};

/// Returns the least-squares circle through the path (geometric distances).
PathCircle least_squares_circle(std::span<const CircleReading>, double R);
/// Returns the pair of concentric circles with the smallest radial distance that contains the path;
/// for fewer than four readings, the least-squares circle.
PathCircle minimum_zone(std::span<const CircleReading>, double R);
/// Returns the mean, smallest and largest distance of the path from a given center.
PathCircle about(std::span<const CircleReading>, double R, std::array<double, 2> centre);

/// Circular hysteresis H, m: largest difference of the radii of the two directions at one angle,
/// rad; `circular_hysteresis` returns std::nullopt without such an angle. Readings at most `step`,
/// rad, apart are interpolated.
struct Hysteresis {
  double H = 0.0, angle = 0.0;
};
std::optional<Hysteresis> circular_hysteresis(std::span<const CircleReading>, double R,
                                              std::array<double, 2> centre, double step);

enum class Cause : std::uint8_t {
  centre_u,
  centre_v,
  radius,
  zero_change,      ///< half of the difference of the radius between the two directions
  centre_change_u,  ///< half of the difference of the centre: a drift from one path to the other
  centre_change_v,
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
  double R = 0.0;                          ///< commanded radius, m
  std::array<double, 2> centre{};          ///< center in machine coordinates, m
  std::array<double, 2> pitch{};           ///< pitches of the drives, m; 0: not known
  std::array<bool, cause_count> wanted{};  ///< causes to be fitted; set by `all_causes`
  double leave_out = 0.0;  ///< readings closer than this to a reversal are omitted, rad
  bool correlated = true;  ///< if false, noise at adjacent angles is treated as independent
  /// Returns whether `angle`, rad, is within `leave_out` of a reversal.
  bool leaves_out(double angle) const;
};
/// Sets `wanted` to all causes that the readings can determine: zero change and servo mismatch need
/// both directions, and a cyclic error needs the pitch of its axis.
void all_causes(CircleModel&, bool both_directions);

/// Returns the radial deviation, m, for a cause of size 1: 1 m, 1 rad (squareness), or 1 m/m (scale
/// mismatch). The size of a bow is k R^2, m.
double cause_at(Cause, const CircleModel&, double angle, int direction);

struct CauseFit {
  struct Value {
    bool fitted = false;
    double value = 0.0, u = 0.0, dof = 0.0;
    double inflation = 1.0;        ///< variance relative to that of a fit of this cause alone
    std::vector<double> by_bin{};  ///< derivative of the value by the mean of each bin
  };
  std::array<Value, cause_count> of;
  /// Mean of the readings within one degree. Bins of the counter-clockwise path come first; each
  /// direction is in the order of travel.
  struct Bin {
    double angle = 0.0, deviation = 0.0, residual = 0.0;
    int direction = 1;
  };
  std::vector<Bin> bins;
  double s = 0.0;            ///< standard deviation of the residual of a bin
  double s_reading = 0.0;    ///< standard deviation of the residual of a reading
  double correlation = 0.0;  ///< correlation of adjacent bins (1 deg apart)
  /// effective degrees of freedom: the smaller of those of mean and half difference
  double dof = 0.0;
  double covariance(Cause a, Cause b) const;
  /// Radial deviation that the fitted causes predict, and its standard uncertainty, m.
  double radius_at(const CircleModel&, double angle, int direction) const;
  double u_at(const CircleModel&, double angle, int direction) const;
  std::vector<double> covariance_of{};  ///< row by row; 0 for causes that are not fitted
};

/// Fits the causes by least squares weighted by the correlation of the residuals. The noise of the
/// mean and that of the half difference of both directions are estimated separately as white noise
/// plus a first-order autoregressive process (REML). Only the direction with more bins is fitted if
/// fewer than a third of the bins have both. Error: too few readings.
Expected<CauseFit> fit_causes(std::span<const CircleReading>, const CircleModel&);

/// Bias of extreme values of a path, which noise always increases. Simulated paths are the fit with
/// its residuals, rotated by the same fraction of the turn in each direction and run, so that noise
/// shared by both directions stays shared. Readings outside of the fit keep their residual, reduced
/// by the contribution of the noise, and noise is added to them.
class CircleNoise {
 public:
  static constexpr std::size_t times = 36;
  CircleNoise(std::span<const CircleReading>, const CircleModel&, const CauseFit&);
  const std::vector<CircleReading>& truth() const { return truth_; }
  /// Returns simulated path k = 0 .. times - 1, in the order of the readings.
  std::vector<CircleReading> turned(std::size_t k) const;
  /// Returns the bias of value(path): its mean over all simulated paths minus value(truth()), m.
  template <class Value>
  double adds(const Value& value) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < times; ++k) sum += value(turned(k));
    return sum / static_cast<double>(times) - value(truth_);
  }

 private:
  struct From {
    /// range of residuals_: start and length; index within this range
    std::size_t first = 0, count = 0, place = 0;
  };
  std::vector<CircleReading> truth_;
  std::vector<From> from_;
  std::vector<double> residuals_;
};

/// A reversal spike: the largest residual from 0.5 deg before to 5 deg after a reversal. One for
/// each reversal and direction that has readings at three or more angles in this range.
struct Spike {
  double at = 0.0;  ///< angle of the reversal, rad
  int direction = 1;
  bool of_v = false;                 ///< whether the second axis reverses at this angle
  double height = 0.0, width = 0.0;  ///< height, m; width at half height, rad
  double u = 0.0;                    ///< standard uncertainty of the height
};
std::vector<Spike> reversal_spikes(std::span<const CircleReading>, const CircleModel&,
                                   const CauseFit&);

/// Widens the zone around reversals, `model.leave_out`, in steps of 1 deg up to `most`, rad, as
/// long as spikes extend significantly beyond the zone and enough readings remain.
Expected<CauseFit> fit_causes_without_spikes(std::span<const CircleReading>, CircleModel& model,
                                             double most);

}  // namespace nonio::math
