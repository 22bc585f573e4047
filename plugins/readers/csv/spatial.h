// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "nonio/sdk/plugin.h"

/// Readers of measurements with several axes.
namespace nonio::csv {

struct Span {
  struct Side {
    std::string axis;
    std::size_t coordinate = 0;   ///< 0, 1, 2 for X, Y, Z
    double from = 0.0, to = 0.0;  ///< m
  };
  std::vector<Side> sides;  ///< moving axes in the order X, Y, Z
  double length = 0.0;      ///< m
};

inline nonio::Number count(const char* name, std::uint64_t n) {
  return {name, static_cast<double>(n), Quantity::count};
}

/// Error: `from` and `to` of the manifest do not define a line of linear axes.
Expected<Span> span_of(const Campaign& campaign, const Measurement& measurement);

/// Converts distances along a span (in axes[0]) to positions of its axes.
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
Expected<Observations> read_declared(const ReadInput& input);

/// Column names that only these kinds have, to recognize files.
const std::vector<std::string_view>& spatial_names();

}  // namespace nonio::csv
