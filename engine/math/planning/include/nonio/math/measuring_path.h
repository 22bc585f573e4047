// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

/// Stops of the machine and points of reversal, in the order of a measurement, for the part program
/// of any control. Lengths in m, angles in rad.
namespace nonio::math {

struct MeasuringMove {
  std::vector<double> to;  ///< target position of each axis of the path
  double dwell = 0.0;      ///< time at rest for the reading, s; 0 for a point of reversal
  bool stop = false;       ///< whether the program then waits for the operator
};

struct MeasuringPath {
  std::string name;  ///< name of the path: "X", "D1", "PPP"
  std::vector<std::string> axes;
  std::vector<bool> rotary;
  std::vector<MeasuringMove> moves;
};

struct MeasuringRequest {
  int runs = 5;
  double dwell = 5.0;        ///< time at each target, s
  double over_travel = 0.0;  ///< travel beyond both end targets, m or rad
  bool both_directions = true;
  double resolution = 1e-6;  ///< the over-travel is an integer multiple of `resolution`, m or rad
};

/// P_i = first + (i - 1) p + r_i for `points` targets with the even interval p. With `scatter`, r_i
/// is uniform within +- min(period, 0.3 p), at the ends only inwards, because evenly spaced targets
/// would not detect an error with the period of the screw or scale. Targets are multiples of
/// `resolution`; the same seed gives the same targets on every computer. Each value of `among`,
/// between first and last, replaces the nearest target. Source: ISO 230-2:2014, test plan; the 30 %
/// is common practice. Error: p is not larger than twice the resolution.
struct AxisTargets {
  double first = 0.0, last = 0.0;
  int points = 5;
  bool scatter = false;
  double period = 0.0;  ///< expected period of an error, m or rad; 0: not known
  double resolution = 1e-6;
  std::uint64_t seed = 1;
  std::vector<double> among{};
};
Expected<std::vector<double>> axis_targets(const AxisTargets& wish);

/// Returns the number of targets for a linear axis of `length`, m, according to ISO 230-2 (M): at
/// least five and five per meter up to 2 m, one every 250 mm above.
int axis_points(double length);
/// `angle` in rad: 3, 5, 8 targets for up to 90, 180, 360 deg, 8 per turn above (ISO 230-2).
int rotary_points(double angle);
/// Angles that ISO 230-2 requires among the targets, rad: 0, 90, 180, 270 deg in every turn.
std::vector<double> cardinal_angles(double first, double last);

/// Each run contains all targets upwards, and then downwards if both directions are requested.
MeasuringPath axis_path(const std::string& axis, bool rotary, const std::vector<double>& targets,
                        const MeasuringRequest& wish);

/// Two stops at which a person reads the instrument, both approached from the side of `start`.
MeasuringPath probe_path(const std::string& axis, bool rotary, double start, double from, double to,
                         const MeasuringRequest& wish);

/// A rectangle whose diagonals are measured in n equal steps.
struct Rectangle {
  std::string x = "X", y = "Y";
  double from_x = 0.0, from_y = 0.0, step_x = 0.0, step_y = 0.0;
  int n = 0;
};
/// Returns the paths D1 (both axes upwards) and D2 (X upwards, Y downwards). The over-travel is
/// that of the axis that moves further, and is on the diagonal itself.
std::vector<MeasuringPath> diagonal_paths(const Rectangle& r, const MeasuringRequest& wish);
/// Returns the path D3, from the start of D1 to half of Y at the end of X, with every second stop
/// along X. `r.n` must be even.
MeasuringPath half_diagonal_path(const Rectangle& r, const MeasuringRequest& wish);

/// Step diagonals PPP NPP PNP PPN (P: the axis moves upwards, N: downwards): a step in X, one in Y
/// and one in Z, with a reading after each, n times. `axes`: in the order of the steps. Readings
/// are taken only from the start to the end of a diagonal, not on the way back.
struct Volume {
  std::vector<std::string> axes;
  std::vector<double> from, step;
  int n = 0;
};
std::vector<MeasuringPath> step_diagonal_paths(const Volume& v, const MeasuringRequest& wish);

}  // namespace nonio::math
