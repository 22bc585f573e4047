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
/// The largest size is that of the largest node. Noise makes it larger by about u^2/(2 size) of each
/// direction across e; where size < 5 u that is a tenth of u and more, and it is not given.
namespace nonio::math {

struct VolumeNode {
  Corner at{}, error{};       ///< m
  std::array<double, 3> u{};  ///< of the components: of the repetition
  std::array<Shares, 3> shares{};
};

struct VolumeMap {
  std::vector<VolumeNode> nodes;  ///< X slowest, Z fastest; none: not known everywhere
  std::size_t parts = 0;          ///< between the nodes of each axis that moves
  std::size_t largest = 0;        ///< index of a node
  double size = 0.0, u_size = 0.0;
  Shares shares_size;
  bool known() const { return !nodes.empty(); }
};

/// Nodes of the lattice; an axis that does not move has one.
std::vector<Corner> lattice(const Corner& low, const Corner& high, std::size_t parts);

/// Error between the nodes of a map, linear in each coordinate: as a control does it.
Corner interpolated(const VolumeMap&, const Corner& at);

}  // namespace nonio::math
