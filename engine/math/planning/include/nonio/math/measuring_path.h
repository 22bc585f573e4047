// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

/// Where a machine stops to be measured, in which order, and where it reverses: the content of a
/// part program of a measurement, for any control. Lengths in m, angles in rad.
namespace nonio::math {

struct MeasuringMove {
  std::vector<double> to;  ///< one position for each axis of the path
  double dwell = 0.0;      ///< s at rest, in which the instrument reads; 0: a point of turning
  bool stop = false;       ///< after that the program waits for the operator
};

struct MeasuringPath {
  std::string name;  ///< "X", "D1", "PPP"
  std::vector<std::string> axes;
  std::vector<bool> rotary;  ///< by axis
  std::vector<MeasuringMove> moves;
};

struct MeasuringRequest {
  int runs = 5;
  double dwell = 5.0;        ///< s
  double over_travel = 0.0;  ///< beyond both ends, so that every target is reached from one side
  bool both_directions = true;
  double resolution = 1e-6;  ///< the over-travel is a whole multiple of it
};

/// Targets of an axis test: P_i = first + (i - 1) p + r_i for `points` targets, p = even interval.
/// With `scatter`, r_i is random, uniform within +- min(period, 0.3 p), at the ends only inwards:
/// even steps would not see an error with the period of the screw or of the scale. Multiples of
/// `resolution` between first and last; the same seed gives the same targets on every computer.
/// Those of `among` that lie in the range take the place of the nearest target.
/// Source: ISO 230-2:2014, test plan; the 30 % where no period is known is common practice. Range:
/// points >= 2, last > first, resolution > 0. An error if two targets would lie closer than twice
/// the resolution.
struct AxisTargets {
  double first = 0.0, last = 0.0;
  int points = 5;
  bool scatter = false;
  double period = 0.0;  ///< expected period of an error; 0: not known
  double resolution = 1e-6;
  std::uint64_t seed = 1;
  std::vector<double> among{};
};
Expected<std::vector<double>> axis_targets(const AxisTargets& wish);

/// How many targets ISO 230-2 requires for a linear axis: five a metre up to 2 m and five at least,
/// then one every 250 mm. length: m, above 0. Source: its test plan (docs/formulas.md, M).
int axis_points(double length);
/// The same of a rotary axis: 3, 5, 8 for up to 90, 180, 360 deg; 8 a turn beyond. angle: rad.
int rotary_points(double angle);
/// Angles that it requires among the targets: 0, 90, 180, 270 deg in every turn of the range, rad.
std::vector<double> cardinal_angles(double first, double last);

/// Each run: all targets upwards, and downwards if both directions are requested.
MeasuringPath axis_path(const std::string& axis, bool rotary, const std::vector<double>& targets,
                        const MeasuringRequest& wish);

/// Two stops of an axis at which a person reads the instrument, both reached from `start`'s side.
MeasuringPath probe_path(const std::string& axis, bool rotary, double start, double from, double to,
                         const MeasuringRequest& wish);

/// A rectangle with n equal steps.
struct Rectangle {
  std::string x = "X", y = "Y";
  double from_x = 0.0, from_y = 0.0, step_x = 0.0, step_y = 0.0;
  int n = 0;
};
/// D1: both axes upwards; D2: X upwards while Y goes down. The over-travel is that of the axis
/// which goes further, on the diagonal itself.
std::vector<MeasuringPath> diagonal_paths(const Rectangle& r, const MeasuringRequest& wish);
/// D3, from the start of D1 to half of Y at the end of X, with every second stop along X. n even.
MeasuringPath half_diagonal_path(const Rectangle& r, const MeasuringRequest& wish);

/// Step diagonals: X, then Y, then Z, a reading after each, n times; PPP NPP PNP PPN (P: the axis
/// goes upwards, N: downwards). Three axes in the order of the steps. Always from the start to the
/// end, which it comes back from without a reading.
struct Volume {
  std::vector<std::string> axes;
  std::vector<double> from, step;
  int n = 0;
};
std::vector<MeasuringPath> step_diagonal_paths(const Volume& v, const MeasuringRequest& wish);

}  // namespace nonio::math
