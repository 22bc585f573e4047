// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

/// Error motion of an axis of rotation: displacement r of a ball relative to a sensor over the
/// angle t of the spindle, N turns with n angles each.
///
///     r(t) = m + a cos t + b sin t + error motion         least squares over all turns
///     total          max - min of the error motion, all turns and angles
///     synchronous    mean over the turns at each angle; value: its range
///     asynchronous   error motion minus mean; value: largest range over the turns at one angle
///     eccentricity   sqrt(a^2 + b^2), of the ball's set-up; radial motion excludes it
///     axial, face    the once-per-turn part is an error and is included: fundamental
///                    2 sqrt(a^2 + b^2), range of synchronous motion with it, residual without it
///     fixed sensitive direction     r = X  (tool at rest: turning)
///     rotating sensitive direction  r = X cos t + Y sin t  (tool turns: milling)
///
/// Donaldson reversal: T1 is read before and T2 after ball and sensor are turned by half a turn.
/// The error of the spindle is S = (T1 - T2)/2 and that of the ball P = (T1 + T2)/2; a reading is
/// positive if the surface of the ball moves toward the sensor. Multi-step: the ball is turned to
/// K positions k 360/K while the sensor is at rest, and S is the mean of the readings T_k;
/// components of the ball with K, 2K, ... waves per turn remain in S.
///
/// Lengths in m, t in rad. Sources: ISO 230-7, ASME B89.3.4 (definitions from general knowledge,
/// the text was not available); Donaldson 1972; multi-step: Estler, Evans, Shao 1997.
namespace nonio::math {

/// Readings of one sensor over the spindle angle, in order: the angles ascend over all turns.
struct SpindleTrack {
  std::vector<double> angle, r;
};

/// Whole turns at common angles: r[turn n + i] at angle i 2 pi/n of the spindle.
struct Turns {
  std::size_t n = 0, N = 0;
  std::vector<double> r;
  bool resampled = false;  ///< interpolated, by a cubic through the four nearest readings
  double angle(std::size_t i) const;
};

/// Returns nothing for fewer than two whole turns, fewer than 16 readings in a turn, or a gap of
/// more than an eighth of a turn.
std::optional<Turns> turns_of(const SpindleTrack&);

/// Returns r = X cos t + Y sin t, if t grows from X to Y; for `sense` -1, t grows from X to -Y, r =
/// X cos t - Y sin t. Returns std::nullopt if X and Y differ in the number of turns or of angles.
std::optional<Turns> rotating(const Turns& X, const Turns& Y, int sense = 1);

struct ErrorMotion {
  double mean = 0.0, a = 0.0, b = 0.0;
  double u_ab = 0.0;  ///< standard uncertainty of a and b, from the differences between turns
  double total = 0.0, synchronous = 0.0, asynchronous = 0.0;
  std::vector<double> motion;  ///< mean over the turns at each angle, without m, a, b
  std::size_t low = 0, high = 0;
  double s = 0.0;                 ///< standard deviation of the asynchronous motion at one angle
  double u_mean = 0.0;            ///< standard uncertainty of the mean at one angle
  double dof = 0.0;               ///< effective number of turns minus 1, at least 1
  std::vector<double> with_once;  ///< synchronous motion with the once-per-turn part
  double synchronous_with_once = 0.0, total_with_once = 0.0;
  double fundamental() const;
  double eccentricity() const;
};
ErrorMotion error_motion(const Turns&);

/// Both inputs of `donaldson` must have the same number of angles.
struct Separated {
  std::vector<double> spindle, ball;
};
Separated donaldson(std::span<const double> T1, std::span<const double> T2);
/// T[k]: readings with the ball turned by k 360 deg/K.
Separated multi_step(std::span<const std::vector<double>> T);

/// Returns the sense in which t grows, from the eccentricity that X and Y measure 90 deg apart:
///
///     f = |(aX + bY) + i (bX - aY)|/2     it turns from X to Y    a, b of r = a cos t + b sin t
///     g = |(aX - bY) + i (bX + aY)|/2     it turns from X to -Y
///
/// +1 if f >= 3 g, -1 if g >= 3 f; 0 (not known) otherwise. It is also 0 if the larger one does not
/// exceed the range of the synchronous motion, because an error of two waves per turn contributes
/// to it as well, or if it does not exceed four times its standard uncertainty.
int sense_of(const ErrorMotion& X, const ErrorMotion& Y);

double range_of(std::span<const double>);

}  // namespace nonio::math
