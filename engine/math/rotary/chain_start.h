// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dense.h"
#include "nonio/math/rotary_chain.h"

/// Starting values of the fit in rotary_chain.h.
namespace nonio::math::chain {

inline Eigen::Vector3d as_vector(const Vector3& v) { return {v[0], v[1], v[2]}; }
inline Vector3 as_array(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }
/// Returns the matrix of a right-handed rotation about the unit vector n.
Eigen::Matrix3d turn(const Vector3& n, double angle);

/// Returns up to four states, those that fit best among all tried directions, the best first.
std::vector<ChainState> chain_starts(const std::vector<ChainReading>&, const ChainOrder&);

}  // namespace nonio::math::chain
