// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/math/rigid_body.h"

/// The terms of rigid_body.h: an error with one polynomial, and its effect on readings.
namespace nonio::math {

struct RigidTerm {
  enum class Kind { positioning, straightness, angle, squareness };
  std::string error;
  Kind kind = Kind::positioning;
  /// axis that moves; component of the error, or axis of the rotation
  std::size_t axis = 0, along = 0;
  std::size_t degree = 0;
  double scale = 1.0;  ///< scale of the unknown: a coefficient of 1 causes at most 1 in the volume
};

struct RigidBox {
  Corner low{}, high{};
  double length(std::size_t k) const { return high[k] - low[k]; }
  /// Returns the coordinate scaled to -1..1; 0 for an axis that does not move.
  double part(std::size_t k, const Corner& at) const {
    return length(k) > 0.0 ? 2.0 * (at[k] - low[k]) / length(k) - 1.0 : 0.0;
  }
  double lever(std::size_t k, const Corner& at) const { return at[k] - (low[k] + high[k]) / 2.0; }
};

/// `errors`: empty for all. Errors of axes that do not move have no terms.
std::vector<RigidTerm> rigid_terms(const RigidBox&, const std::vector<std::string>& errors,
                                   std::size_t degree);

double legendre(std::size_t degree, double t);
double shape_of(const RigidTerm&, const RigidBox&, const Corner& at);
/// Returns e of the tool point, m, for an unscaled coefficient of 1 m, or of 1 rad for an angle.
Corner error_of_term(const RigidTerm&, const RigidBox&, const Corner& at);

/// Derivatives of each reading of a line by the terms (scaled), and by the unknowns of the set-up.
struct RigidRows {
  std::vector<std::vector<double>> terms, set_up;  ///< one row per reading
};
RigidRows rows_of(const RigidLine&, const std::vector<RigidTerm>&, const RigidBox&);

}  // namespace nonio::math
