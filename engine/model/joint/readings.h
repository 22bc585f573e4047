// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "data/design.h"
#include "nonio/model/joint.h"

namespace nonio::model {

/// Columns of one effect with one combination of its shapes, the same in every member that can show
/// it.
struct JointBlock {
  std::string effect;
  const Effect* is = nullptr;  ///< the effect, as declared for the member with the most readings
                               ///< that has it
  Axis axis{};
  std::vector<double> shape{};
  Index count = 0;     ///< number of columns
  Index searched = 0;  ///< number of searched shapes
  /// 2 ln of the number of independent values of its shapes, plus its prior cost
  double cost = 0.0;
};

/// The readings of one member and the columns of all blocks: whitened, divided by the standard
/// deviation of a reading, without the zeros of the lines and without the member's own model.
struct MemberReadings {
  MatrixXd x;
  VectorXd y;
  /// first column of each block; -1: the block is not identifiable from these readings, or is
  /// identifiable from those of fewer than two members
  std::vector<Index> first;
  std::vector<MatrixXd> own;        ///< scalar products of each block's columns
  std::vector<std::uint32_t> pass;  ///< index of the pass (run in one direction on a line) of each
                                    ///< reading
  std::vector<std::uint32_t> cell;  ///< cell of each reading: a target approached from one side
  VectorXd scale;                   ///< factor that converts y to m or rad; 0 for a reading that is
                                    ///< not used
  std::size_t cells = 0;
  double readings = 0.0;
  Index unknowns = 0;  ///< number of zeros and of parameters of the own model
  double s = 0.0;      ///< standard deviation of a reading, m or rad
  double dof = 0.0;    ///< degrees of freedom of s
  std::optional<NoiseFloor> floor{};
};

struct JointReadings {
  std::vector<JointBlock> blocks;
  std::vector<MemberReadings> members;
};

Expected<JointReadings> read_together(const std::vector<Member>& members);

}  // namespace nonio::model
