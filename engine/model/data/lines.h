// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "nonio/model/comparison.h"

namespace nonio::model {

using Vector = std::array<double, 3>;
inline double dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Whether all readings sense along the only axis, or its angle, with directions of approach.
bool sensed_along_one_axis(const Observations&);
/// Whether lengths are sensed, each in a known direction, while only linear axes move. Unless
/// `sensed_along_one_axis`, they are across the motion or over several axes.
bool across(const Observations&);
/// Whether some direction of sensing has several components, as on a diagonal.
bool senses_several(const Observations&);
/// Returns the coordinates (0, 1, 2) along which axes move or readings are sensed.
std::vector<std::size_t> coordinates_of(const Observations&);

/// Keeps the order in which the readings were taken. A single line has the name of the measurement.
void append_run(Part& part, const Observations& listed, const Measurement& m);

/// An axis that is not in the readings has the position that the measurement states, otherwise NaN.
void append_space(Part& part, const Campaign& campaign, const std::vector<Observations>& read,
                  const std::vector<std::size_t>& members);

}  // namespace nonio::model
