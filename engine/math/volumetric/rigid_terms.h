// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/math/rigid_body.h"

/// The terms of rigid_body.h: which error, which polynomial, what a reading sees of it.
namespace nonio::math {

struct RigidTerm {
  enum class Kind { positioning, straightness, angle, squareness };
  std::string error;
  Kind kind = Kind::positioning;
  std::size_t axis = 0, along = 0;  ///< that moves; component, or axis of the turn
  std::size_t degree = 0;
  double scale = 1.0;  ///< of the unknown: a size of 1 makes at most 1 in the volume
};

/// The box of the volume.
struct RigidBox {
  Corner low{}, high{};
  double length(std::size_t k) const { return high[k] - low[k]; }
  /// -1..1; 0 of an axis that does not move.
  double part(std::size_t k, const Corner& at) const {
    return length(k) > 0.0 ? 2.0 * (at[k] - low[k]) / length(k) - 1.0 : 0.0;
  }
  double lever(std::size_t k, const Corner& at) const { return at[k] - (low[k] + high[k]) / 2.0; }
};

/// The terms of these errors with polynomials up to `degree`, in the order of `rigid_errors`;
/// errors of axes that do not move have none.
std::vector<RigidTerm> rigid_terms(const RigidBox&, const std::vector<std::string>& errors,
                                   std::size_t degree);

double legendre(std::size_t degree, double t);
/// Of an angle or a length: P_k at the place of its axis.
double shape_of(const RigidTerm&, const RigidBox&, const Corner& at);
/// e for a size of 1 of the unscaled term, m (of an angle: for 1 rad).
Corner error_of_term(const RigidTerm&, const RigidBox&, const Corner& at);

/// What each reading of a line sees of each term (scaled), and of the set-up.
struct RigidRows {
  std::vector<std::vector<double>> terms, set_up;  ///< by reading
};
RigidRows rows_of(const RigidLine&, const std::vector<RigidTerm>&, const RigidBox&);

}  // namespace nonio::math
