// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "nonio/math/blindness.h"
#include "nonio/math/budget.h"

/// The error of the tool point at the nodes of a lattice over a volume.
///
///     e(p) - e(middle of the volume)
///     size = |e|,  u(size)^2 = n' V n with n = e/|e| and the covariance V of e
///
/// `VolumeMap::size` is the largest size over the nodes. Noise increases it by about u^2/(2 size)
/// for each direction perpendicular to e; if size < 5 u, the bias is over u/10: no size is given.
namespace nonio::math {

struct VolumeNode {
  Corner at{}, error{};       ///< position and error of the node, m
  std::array<double, 3> u{};  ///< standard uncertainty of the components by repetition
  std::array<Shares, 3> shares{};
};

struct VolumeMap {
  /// nodes with X slowest and Z fastest; empty if the error is not determined everywhere
  std::vector<VolumeNode> nodes;
  std::size_t parts = 0;    ///< number of intervals of each axis that moves
  std::size_t largest = 0;  ///< index of the node with the largest error
  double size = 0.0, u_size = 0.0;
  Shares shares_size;
  bool known() const { return !nodes.empty(); }
};

/// An axis that does not move has one position.
std::vector<Corner> lattice(const Corner& low, const Corner& high, std::size_t parts);

}  // namespace nonio::math
