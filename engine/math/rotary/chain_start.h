// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dense.h"
#include "nonio/math/rotary_chain.h"

namespace nonio::math::chain {

inline Eigen::Vector3d as_vector(const Vector3& v) { return {v[0], v[1], v[2]}; }
inline Vector3 as_array(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }
/// Right-handed rotation about the unit vector n; `angle` in rad.
Eigen::Matrix3d turn(const Vector3& n, double angle);

/// Up to four states, the best of all tried directions, in ascending order of residuals.
std::vector<ChainState> chain_starts(const std::vector<ChainReading>&, const ChainOrder&);

}  // namespace nonio::math::chain
