// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "nonio/model/comparison.h"

/// Conversion of measurements to the lines of one table.
namespace nonio::model {

using Vector = std::array<double, 3>;
inline double dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Returns whether the table has one axis, and all readings sense the motion along this axis, or
/// the angle if the axis is rotary. False if a direction of approach is missing.
bool sensed_along_one_axis(const Observations&);
/// Returns whether lengths are sensed, each in a known direction, while at least one linear axis
/// and no other axis moves. If `sensed_along_one_axis` is false, such readings are across the
/// motion or over several axes at once.
bool across(const Observations&);
/// Whether some direction of sensing has several components, as on a diagonal.
bool senses_several(const Observations&);
/// Returns the coordinates (0, 1, 2) along which axes move or readings are sensed.
std::vector<std::size_t> coordinates_of(const Observations&);

/// Appends a measurement of the part's axis, with its lines, in the order in which its readings
/// were taken. A single line gets the name of the measurement.
void append_run(Part& part, const Observations& listed, const Measurement& m);

/// Appends the measurements `members` of a campaign to a part in space. An axis that is not in the
/// readings has the position that the measurement states (`at`, `from`), otherwise NaN.
void append_space(Part& part, const Campaign& campaign, const std::vector<Observations>& read,
                  const std::vector<std::size_t>& members);

}  // namespace nonio::model
