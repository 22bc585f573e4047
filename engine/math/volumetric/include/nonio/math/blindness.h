// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

/// Determines which of the 21 errors of three linear axes straight lines through a volume do not
/// determine. Chain and symbols are those of rigid_body.h. Positioning and angles are linear over
/// the travel (an angle is 0 at mid-travel), a straightness is an arc (0 at both ends), and the
/// constant angles are the squarenesses. A coefficient of 1 causes an error of at most 1 in the
/// volume. The null space of the readings contains the errors that are not determined. Derived.
namespace nonio::math {

using Corner = std::array<double, 3>;  ///< coordinates X, Y, Z of a point, m

struct ThroughVolume {
  Corner from{}, to{};
};

struct Blindness {
  std::size_t errors = 0, rank = 0;
  std::vector<std::string> unseen;  ///< errors that affect no line
  /// Coefficients of errors that together change no reading, the first one 1.
  std::vector<std::vector<std::pair<std::string, double>>> combinations;
};

/// The volume is the box that contains all lines; an axis that does not move has no errors.
Blindness blind_to(const std::vector<ThroughVolume>& lines);

}  // namespace nonio::math
