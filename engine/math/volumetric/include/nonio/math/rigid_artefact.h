// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "nonio/math/rigid_body.h"

/// Converts probed balls of an artefact at rest to lines of the fit of all errors.
///
/// Ball b is at q_b + dq_b in the frame of the artefact, which is rotated by R and shifted by t.
/// The axes show M when the tool is at M + e(M), so that
///
///     M + e(M) = R q_b + t     and, about a first R, t that fits the balls best,
///     (R q_b + t - M)_k = e(M)_k - dt_k - (w x R (q_b - mean q))_k - (R dq_b)_k
///
/// dt, w: of each placement; dq_b: of each ball, the same in all placements. q: coordinates of the
/// certificate, or if there are none, as the machine measured them in the first placement. Values
/// of the certificate are additional equations, each with its u: dq_j = c q_j for a coordinate, or
/// n.(dq_a - dq_b) = L - |q_a - q_b| + c L for a length L; and c = 0, the scale error common to all
/// of them. If nothing is stated, the artefact shows how the errors change from place to place, but
/// not the scales.
///
/// Lengths in m. The equations are of first order in the errors: w is at most the errors divided by
/// the size of the artefact, and w^2/2 of that size is neglected (0.04 um for 0.2 mm on 0.5 m).
/// Derived; tests compare with exact transforms. docs/formulas.md.
namespace nonio::math {

struct ArtefactBall {
  std::string name;
  std::optional<Corner> stated{};  ///< coordinates of the certificate, in the frame of the artefact
  double u = 0.0;                  ///< standard uncertainty of each stated coordinate, m
};

struct ArtefactLength {
  std::size_t a = 0, b = 0;  ///< indices of the balls
  double length = 0.0;
  double u = 0.0;
};

/// The probed balls of one placement, each once, in the order of probing.
struct ArtefactPlacement {
  std::string name;
  std::vector<std::size_t> ball;
  std::vector<Corner> at;  ///< positions of the balls as shown by the axes, m
  /// A coordinate that was not measured gives no reading; `at` then contains the axis position, or
  /// NaN.
  std::array<bool, 3> measured{true, true, true};
};

struct Artefact {
  std::string name;
  std::vector<ArtefactBall> balls;
  std::vector<ArtefactLength> lengths;
  double u_scale = 0.0;  ///< standard uncertainty of the scale common to all stated values, m/m
  std::vector<ArtefactPlacement> placements;
};

struct ArtefactLines {
  /// One line for each placement and measured coordinate, along X, Y and Z; then, if there is one,
  /// the line of stated values: coordinates by ball, lengths, and last the scale c.
  std::vector<RigidLine> lines;
  struct Of {
    std::size_t placement, coordinate;
  };
  std::vector<Of> of;        ///< placement and coordinate of each line except that of stated values
  std::size_t unknowns = 0;  ///< number of shared unknowns
  bool states = false;       ///< whether the last line contains stated values
};

/// Reason why readings do not match this artefact.
struct ArtefactRefusal {
  enum class Why {
    not_linked,  ///< no common balls link a placement or ball with the others
    /// a ball is farther than `artefact_limit` from the position derived from the others, or a
    /// length differs by more than this limit
    does_not_fit
  };
  Why why = Why::not_linked;
  std::string placement, ball;
  double distance = 0.0;  ///< distance of the ball from that position, or error of the length, m
};

/// Largest plausible distance, m, of a ball from its expected position. A larger distance means
/// that another ball or another artefact was probed. docs/dev/constants.md, A22.
inline constexpr double artefact_limit = 0.3e-3;

/// Returns the lines of an artefact for the fit of all errors. `first`: index of its first shared
/// unknown; `group`: scatter group of its readings.
tl::expected<ArtefactLines, ArtefactRefusal> artefact_lines(const Artefact&, std::size_t first,
                                                            std::size_t group);

}  // namespace nonio::math
