// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "axis_job.h"
#include "nonio/sdk/plugin.h"

namespace nonio::siemens {

struct CrossChoices {
  std::int64_t first_table = 0;
  std::size_t max_points = 200;
  bool quoted_axes = false;
  std::map<std::string, std::size_t> numbers{};  ///< n of AXn by axis
};

/// A CEC table for each curve of one axis over another that diagonals or step diagonals gave: Y by
/// the position of X, and X by that of Y with the squareness in it; of a volume six. `pitch`: what
/// was written of the axes themselves.
Expected<void> write_cross_tables(const OutputInput&, const CrossChoices&,
                                  const std::vector<controllers::AxisJob>& pitch, OutputResult&);

}  // namespace nonio::siemens
