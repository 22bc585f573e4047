// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "data/design.h"
#include "nonio/model/joint.h"

namespace nonio::model {

/// Columns of one effect with one value of its shapes, the same in every member that shows it.
struct JointBlock {
  std::string effect;
  const Effect* is = nullptr;  ///< of the first member that has it
  Axis axis{};
  std::vector<double> shape{};
  Index count = 0;     ///< columns
  Index searched = 0;  ///< of its shapes
  double cost = 0.0;   ///< 2 ln of the number of independent values of its shapes, and of its odds
};

/// The readings of one member and the columns of all blocks: whitened, over the standard deviation of
/// a reading, without the zeros of the lines and without the member's own model.
struct MemberReadings {
  MatrixXd x;
  VectorXd y;
  std::vector<Index> first;         ///< column of each block; -1: these readings do not show it
  std::vector<MatrixXd> own;        ///< scalar products of each block's columns
  std::vector<std::uint32_t> pass;  ///< of each reading
  std::vector<std::uint32_t> cell;  ///< a target reached from one side
  VectorXd scale;                   ///< what 1 of y is, m or rad; 0: left out
  std::size_t cells = 0;
  double readings = 0.0;
  Index unknowns = 0;  ///< zeros and the own model
  double s = 0.0;      ///< standard deviation of a reading, m or rad
  double dof = 0.0;    ///< of s
  std::optional<NoiseFloor> floor{};
};

struct JointReadings {
  std::vector<JointBlock> blocks;
  std::vector<MemberReadings> members;
};

Expected<JointReadings> read_together(const std::vector<Member>& members);

}  // namespace nonio::model
