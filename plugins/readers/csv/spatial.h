// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "nonio/sdk/plugin.h"

/// Measurements of several axes at once: diagonals, step diagonals, ball centres, and the general
/// table that all of them are rows of.
namespace nonio::csv {

/// The line of a diagonal: from one corner to another.
struct Span {
  struct Side {
    std::string axis;
    std::size_t coordinate = 0;   ///< 0, 1, 2: along X, Y, Z
    double from = 0.0, to = 0.0;  ///< m
  };
  std::vector<Side> sides;  ///< of the axes that move, in the order X, Y, Z
  double length = 0.0;      ///< m
};

/// The number of a finding that counts something.
inline nonio::Number count(const char* name, std::uint64_t n) {
  return {name, static_cast<double>(n), Quantity::count};
}

/// From the manifest's `from` and `to`; an error if they do not span a line of linear axes.
Expected<Span> span_of(const Campaign& campaign, const Measurement& measurement);

/// Readings over the distance along a span (in axes[0]) become readings over the positions of its
/// axes.
void spread(Observations& observations, const Span& span);

Expected<Observations> read_step_diagonal(const ReadInput& input);
Expected<Observations> read_artefact(const ReadInput& input);
Expected<Observations> read_artefact_certificate(const ReadInput& input);
Expected<Observations> read_ball_centres(const ReadInput& input);
Expected<Observations> read_circle(const ReadInput& input);
Expected<Observations> read_lengths(const ReadInput& input);
Expected<Observations> read_spindle(const ReadInput& input);
Expected<Observations> read_thermal(const ReadInput& input);
Expected<Observations> read_tool_centre(const ReadInput& input);
Expected<Observations> read_general(const ReadInput& input);
/// The columns that the method of the measurement declares.
Expected<Observations> read_declared(const ReadInput& input);

/// Names of columns that only these kinds have, for recognising a file.
const std::vector<std::string_view>& spatial_names();

}  // namespace nonio::csv
