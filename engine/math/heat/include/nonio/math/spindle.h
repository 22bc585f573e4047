// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

/// Error motion of an axis of rotation: displacement r of a ball against a sensor over the angle t of
/// the spindle, N turns with n angles each.
///
///     r(t) = m + a cos t + b sin t + error motion           least squares over all turns
///     total          max - min of the error motion, all turns and angles
///     synchronous    mean over the turns at each angle; value: its range
///     asynchronous   error motion less the mean; value: largest range over the turns at one angle
///     eccentricity   sqrt(a^2 + b^2), of the ball's set-up; radial motion is without it
///     axial, face    the once-per-turn part is an error and stays: fundamental 2 sqrt(a^2 + b^2),
///                    range of the synchronous motion with it, residual without it
///     fixed sensitive direction     r = X        (tool at rest: turning)
///     rotating sensitive direction  r = X cos t + Y sin t  (tool turns: milling)
///
/// Donaldson reversal: ball and sensor turned by half a turn, S = (T1 - T2)/2, P = (T1 + T2)/2; a
/// reading is positive where the surface of the ball comes towards the sensor. Multi-step: ball
/// turned to K places k 360/K, sensor at rest: S = mean of the T_k; what the ball has of K, 2K, ...
/// waves a turn stays in it.
///
/// Symbols: r, a, b in m, t in rad. Source: ISO 230-7, ASME B89.3.4 (names; definitions after common
/// knowledge, the text was not available); Donaldson 1972; multi-step: Estler, Evans, Shao 1997.
namespace nonio::math {

/// Readings of one sensor over the angle, as they come: angles ascend over all turns.
struct SpindleTrack {
  std::vector<double> angle, r;
};

/// Whole turns on the same angles: r[turn n + i] at angle i 2 pi/n of the spindle.
struct Turns {
  std::size_t n = 0, N = 0;
  std::vector<double> r;
  bool resampled = false;  ///< not as read: by a cubic through the four neighbours
  double angle(std::size_t i) const;
};

/// None: fewer than two whole turns, or fewer than 16 readings in a turn, or a gap of more than an
/// eighth of a turn.
std::optional<Turns> turns_of(const SpindleTrack&);

/// r = X cos t + Y sin t, t growing from X to Y; `sense` -1: t grows from X to -Y, r = X cos t - Y sin
/// t. None if the turns of both differ.
std::optional<Turns> rotating(const Turns& X, const Turns& Y, int sense = 1);

struct ErrorMotion {
  double mean = 0.0, a = 0.0, b = 0.0;
  double u_ab = 0.0;  ///< standard uncertainty of a and b, from turn to turn
  double total = 0.0, synchronous = 0.0, asynchronous = 0.0;
  std::vector<double> motion;     ///< mean over the turns at each angle, without m, a, b
  std::size_t low = 0, high = 0;  ///< of the synchronous motion
  double s = 0.0;                 ///< of the asynchronous motion at one angle
  double u_mean = 0.0;            ///< of the mean at one angle: correlated turns count less
  double dof = 0.0;               ///< of u_mean: effective number of turns less 1
  std::vector<double> with_once;  ///< synchronous motion with the once-per-turn part
  double synchronous_with_once = 0.0, total_with_once = 0.0;
  double fundamental() const;
  double eccentricity() const;
};
ErrorMotion error_motion(const Turns&);

/// Curves over one turn of the same length, the first two equal in number of angles.
struct Separated {
  std::vector<double> spindle, ball;
};
Separated donaldson(std::span<const double> T1, std::span<const double> T2);
/// T[k]: with the ball at k 360/K.
Separated multi_step(std::span<const std::vector<double>> T);

/// The sense in which t grows, from the eccentricity of the ball, which X and Y see a quarter of a
/// turn apart:
///
///     f = |(aX + bY) + i (bX - aY)|/2     it turns from X to Y       a, b of r = a cos t + b sin t
///     g = |(aX - bY) + i (bX + aY)|/2     it turns from X to -Y
///
/// +1 if f >= 3 g, -1 if g >= 3 f; 0, not known, otherwise, or where the larger is not more than the
/// range of the synchronous motion: an error of two waves per turn has such a part too.
int sense_of(const ErrorMotion& X, const ErrorMotion& Y);

double range_of(std::span<const double>);

}  // namespace nonio::math
