// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

/// Which of the 21 errors of three linear axes straight lines through a volume do not determine.
///
/// Chain bed - X - Y - Z - tool, no tool offset, small errors (ISO 230-1 names); y, z from the
/// middle of the volume:
///
///     e_x = EXX + EXY + EXZ - y ECX + z (EBX + EBY + B0Z) - y C0Y
///     e_y = EYX + EYY + EYZ - z (EAX + EAY + A0Z)
///     e_z = EZX + EZY + EZZ + y EAX
///
/// Each error counts with its simplest shape: positioning grows evenly, a straightness is a bow (0
/// at both ends), an angle turns evenly through 0 at mid-travel; the constant angles are the
/// squarenesses. A size of 1 makes at most 1 somewhere in the volume. The null space of the
/// readings is what stays unseen. Derived; tests move exact transforms by every combination.
namespace nonio::math {

using Corner = std::array<double, 3>;  ///< m

struct ThroughVolume {
  Corner from{}, to{};
};

struct Blindness {
  std::size_t errors = 0, rank = 0;
  std::vector<std::string> unseen;  ///< errors that no line shows at all
  /// Sizes of errors that together change no reading, the first one 1.
  std::vector<std::vector<std::pair<std::string, double>>> combinations;
};

/// The volume is the box that holds all lines; an axis that does not move has no errors.
Blindness blind_to(const std::vector<ThroughVolume>& lines);

}  // namespace nonio::math
