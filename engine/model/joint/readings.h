// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>

#include "data/design.h"
#include "nonio/model/joint.h"

namespace nonio::model {

/// One effect with one combination of its shapes, for every member that can show the effect.
struct JointBlock {
  std::string effect;
  const Effect* is = nullptr;  ///< as declared for the member with the most readings
  Axis axis{};
  std::vector<double> shape{};
  Index count = 0;
  Index searched = 0;  ///< number of searched shapes
  /// 2 ln of the number of independent values of its shapes, plus its prior cost
  double cost = 0.0;
  double weight = 1.0;  ///< as `Term::weight`
};

/// x and y are whitened, in units of the standard deviation of a reading, without the zeros of the
/// lines and without the own model of the member.
struct MemberReadings {
  MatrixXd x;
  VectorXd y;
  /// first column of each block; -1: not identifiable here, or in fewer than two members
  std::vector<Index> first;
  std::vector<MatrixXd> own;        ///< scalar products of each block's columns
  std::vector<Index> rank;          ///< number of independent columns of each block
  std::vector<std::uint32_t> pass;  ///< pass of each reading (run in one direction on a line)
  std::vector<std::uint32_t> cell;  ///< cell of each reading: a target approached from one side
  VectorXd scale;                   ///< factor from y to m or rad; 0 for unused readings
  std::size_t cells = 0;
  double readings = 0.0;
  Index unknowns = 0;  ///< number of zeros and of parameters of the own model
  double s = 0.0;      ///< standard deviation of a reading, m or rad
  double dof = 0.0;
  std::optional<NoiseFloor> floor{};
};

struct JointReadings {
  std::vector<JointBlock> blocks;
  std::vector<MemberReadings> members;
  double offsets = 0.0;  ///< variance of the zeros of passes, relative to that of a reading
};

Expected<JointReadings> read_together(const std::vector<Member>& members);

}  // namespace nonio::model
