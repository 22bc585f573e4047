// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

/// A ball on a rotary axis, or on one that another carries, and how it is touched. mm and deg.
namespace nonio::program_probing {

using Vector = std::array<double, 3>;

/// A rotary axis: what turns about a line along a coordinate.
struct Turning {
  std::string axis;
  Vector centre{};
  bool with = true;  ///< right-handed about +X, +Y or +Z
  std::size_t about() const { return static_cast<std::size_t>(axis.front() - 'A'); }
  Vector direction(const Vector&, double angle) const;
  Vector point(const Vector&, double angle) const;
};

struct Ball {
  Turning table;                      ///< which carries the ball
  std::optional<Turning> carrier;     ///< on the bed, which carries the table
  Vector at{}, stem{0.0, 0.0, -1.0};  ///< with the axes at 0; from the ball along its stem
  double radius = 0.0, approach = 0.0, beyond = 0.0;
};

/// The ball at one position of the axes.
struct Place {
  double angle = 0.0;
  std::optional<double> carrier{};
  Vector ball{}, stem{};
};
/// The ball set on by `height` along the table's axis, turned about the table's line as it is with
/// the carrier at 0, then about the carrier's.
Place place_of(const Ball&, double height, double angle, std::optional<double> carrier);

/// One touch: from next to the ball to inside it.
struct Touch {
  Vector from{}, to{};
};
/// From above, then from four sides at the height of the centre. A side to which the stem leans by
/// less than 60 deg gives way to those between the sides that are free. None where the stem is above.
std::vector<Touch> touches(const Ball&, const Place&);

}  // namespace nonio::program_probing
