// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "nonio/model/comparison.h"

/// How the readings of measurements become lines of one table.
namespace nonio::model {

using Vector = std::array<double, 3>;
inline double dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Readings of one axis, sensed along it (or as its angle).
bool sensed_along_one_axis(const Observations&);
/// Lengths sensed in directions of space while linear axes move: across them, or several at once.
bool across(const Observations&);
/// Whether some reading is sensed in several coordinates at once, as on a diagonal.
bool senses_several(const Observations&);
/// Coordinates (0, 1, 2) that its axes move along or that it senses.
std::vector<std::size_t> coordinates_of(const Observations&);

/// One more measurement of the part's axis, with its lines, in the order in which its readings were
/// taken. A single line has the name of the measurement.
void append_run(Part& part, const Observations& listed, const Measurement& m);

/// The measurements `members` of a campaign as the table of a part in space. The position of an
/// axis at rest is the one that the measurement states (`at`, `from`), else NaN.
void append_space(Part& part, const Campaign& campaign, const std::vector<Observations>& read,
                  const std::vector<std::size_t>& members);

}  // namespace nonio::model
