// SPDX-License-Identifier: Apache-2.0
#include "machine.h"

#include <map>
#include <stdexcept>

namespace machine {

namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;

Eigen::Matrix3d turned(double a, double b, double c) {
  return (AngleAxisd(c, Vector::UnitZ()) * AngleAxisd(b, Vector::UnitY()) *
          AngleAxisd(a, Vector::UnitX()))
      .toRotationMatrix();
}

/// A carriage: shifted, and turned about a pivot that moves with it.
Isometry3d carriage(const Vector& shift, const Eigen::Matrix3d& turn, const Vector& pivot) {
  Isometry3d t = Isometry3d::Identity();
  t.linear() = turn;
  t.translation() = shift + pivot - turn * pivot;
  return t;
}

/// Two unit vectors across `beam`.
std::array<Vector, 2> across(const Vector& beam) {
  const Vector one = beam.unitOrthogonal();
  return {one, beam.cross(one)};
}

}  // namespace

Curve& Errors::operator[](const std::string& name) {
  const std::map<std::string, Curve*> all{
      {"EXX", &EXX}, {"EYX", &EYX}, {"EZX", &EZX}, {"EAX", &EAX}, {"EBX", &EBX}, {"ECX", &ECX},
      {"EXY", &EXY}, {"EYY", &EYY}, {"EZY", &EZY}, {"EAY", &EAY}, {"EBY", &EBY}, {"ECY", &ECY},
      {"EXZ", &EXZ}, {"EYZ", &EYZ}, {"EZZ", &EZZ}, {"EAZ", &EAZ}, {"EBZ", &EBZ}, {"ECZ", &ECZ}};
  return *all.at(name);
}

Isometry3d pose(const Errors& e, const Vector& at) {
  const double x = at.x(), y = at.y(), z = at.z();
  // The frame of each carriage has its origin where the tool would be at x = y = z = 0, so the
  // reference line of X is at (0, y_ref, z_ref) in the frame of the X carriage.
  const Isometry3d X = carriage({x + e.EXX(x), e.EYX(x), e.EZX(x)},
                                turned(e.EAX(x), e.EBX(x), e.ECX(x)), {0.0, e.y_ref, e.z_ref});
  const Vector along_y = turned(0.0, 0.0, e.C0Y) * Vector(0.0, y, 0.0);
  const Isometry3d Y = carriage(along_y + Vector(e.EXY(y), e.EYY(y), e.EZY(y)),
                                turned(e.EAY(y), e.EBY(y), e.ECY(y)), {0.0, 0.0, e.z_ref});
  // Out of square from the reference plane on, not from z = 0.
  const Vector along_z = turned(e.A0Z, e.B0Z, 0.0) * Vector(0.0, 0.0, z - e.z_ref);
  const Isometry3d Z =
      carriage(Vector(0.0, 0.0, e.z_ref) + along_z + Vector(e.EXZ(z), e.EYZ(z), e.EZZ(z)),
               turned(e.EAZ(z), e.EBZ(z), e.ECZ(z)), Vector::Zero());
  return X * Y * Z;
}

Vector point(const Errors& errors, const Vector& commanded, const Vector& tool) {
  return pose(errors, commanded) * tool;
}

std::vector<double> interferometer(const Errors& errors, const std::vector<Vector>& stops,
                                   const Vector& tool, double gap) {
  const Vector beam = (stops.back() - stops.front()).normalized();
  const Vector first = point(errors, stops.front(), tool), source = first - gap * beam;
  std::vector<double> readings;
  for (const Vector& stop : stops)
    readings.push_back((point(errors, stop, tool) - source).norm() - gap -
                       (stop - stops.front()).norm());
  return readings;
}

std::vector<double> flat_mirror(const Errors& errors, const std::vector<Vector>& stops,
                                const Vector& beam, const Eigen::Vector2d& tilt) {
  const auto [one, two] = across(beam);
  const Vector normal =
      AngleAxisd(tilt[0], one) * (AngleAxisd(tilt[1], two) * Vector(beam));  // in the spindle
  const Vector first = point(errors, stops.front());
  double start = 0.0;
  std::vector<double> readings;
  for (const Vector& stop : stops) {
    const Isometry3d at = pose(errors, stop);
    const Vector n = at.linear() * normal;
    // The beam first + s beam meets the plane of the mirror, which passes the tool point.
    const double s = n.dot(at.translation() - first) / n.dot(beam);
    if (readings.empty()) start = s;
    readings.push_back(s - start - (stop - stops.front()).dot(beam));
  }
  return readings;
}

}  // namespace machine
