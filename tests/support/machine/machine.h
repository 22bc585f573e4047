// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <functional>
#include <string>

/// A machine with three linear axes by exact homogeneous transforms, for tests: what instruments
/// would read on it. None of the linear formulas that are under test is used here.
namespace machine {

using Curve = std::function<double(double)>;
using Vector = Eigen::Vector3d;

inline double zero(double) { return 0.0; }

/// Chain bed - X - Y - Z - tool. m and rad over the position of the axis in m; letters of
/// ISO 230-1: EYX is the error along Y of axis X. Each carriage turns about the line on which its
/// positioning error is measured (y_ref, z_ref). C0Y > 0 turns +Y towards -X, B0Z > 0 turns +Z
/// towards +X, A0Z > 0 turns +Z towards -Y.
struct Errors {
  Curve EXX = zero, EYX = zero, EZX = zero, EAX = zero, EBX = zero, ECX = zero;
  Curve EXY = zero, EYY = zero, EZY = zero, EAY = zero, EBY = zero, ECY = zero;
  Curve EXZ = zero, EYZ = zero, EZZ = zero, EAZ = zero, EBZ = zero, ECZ = zero;
  double C0Y = 0.0, B0Z = 0.0, A0Z = 0.0;
  double y_ref = 0.0, z_ref = 0.0;

  Curve& operator[](const std::string& name);
};

/// Position and orientation of the spindle at commanded x, y, z (m), in the frame of the bed.
Eigen::Isometry3d pose(const Errors& errors, const Vector& commanded);

/// The point of the tool; `tool`: its offset in the frame of the spindle, m.
Vector point(const Errors& errors, const Vector& commanded, const Vector& tool = Vector::Zero());

/// A retroreflector in the spindle, an interferometer `gap` before the first stop, its beam along
/// the line of commanded stops: change of length since the first stop, less the nominal one, m.
std::vector<double> interferometer(const Errors& errors, const std::vector<Vector>& stops,
                                   const Vector& tool = Vector::Zero(), double gap = 0.5);

/// A flat mirror in the spindle, perpendicular to `beam` (unit vector) but for the small set-up
/// turns `tilt` about two axes across it; the beam is fixed in the bed's frame and meets the
/// mirror at the first stop's tool point. Readings as above.
std::vector<double> flat_mirror(const Errors& errors, const std::vector<Vector>& stops,
                                const Vector& beam, const Eigen::Vector2d& tilt);

}  // namespace machine
