// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "nonio/math/rigid_body.h"

/// Balls of an artefact at rest while the machine probes their centres, as lines of the fit of
/// all errors.
///
/// Ball b is at q_b + dq_b in the frame of the artefact, which is turned by R and shifted by t.
/// The axes show M where the tool is at M + e(M), so that
///
///     M + e(M) = R q_b + t    and, about a first R, t that fits the balls best,
///     (R q_b + t - M)_k = e(M)_k - dt_k - (w x R (q_b - mean q))_k - (R dq_b)_k
///
/// dt, w: of each placement; dq_b: of each ball, the same in all placements. q: coordinates of
/// the certificate, or else as the machine found them in the first placement. What the
/// certificate states is added, each with its u: dq_j = c q_j of a coordinate, or n.(dq_a - dq_b)
/// = L - |q_a - q_b| + c L of a length L; and c = 0, the scale that all of it has in common.
/// Nothing stated: the artefact shows how the errors change from place to place, but not the
/// scales.
///
/// m. First order in the errors: w is at most the errors over the size of the artefact, and w^2/2
/// of that size is left out (0.04 um for 0.2 mm on 0.5 m). Derived; tests compare with exact
/// transforms. docs/formulas.md.
namespace nonio::math {

struct ArtefactBall {
  std::string name;
  std::optional<Corner> stated{};  ///< of the certificate, in the frame of the artefact
  double u = 0.0;                  ///< standard uncertainty of each of its coordinates
};

struct ArtefactLength {
  std::size_t a = 0, b = 0;  ///< balls
  double length = 0.0;
  double u = 0.0;
};

/// The balls of one placement, each once, in the order in which they were probed.
struct ArtefactPlacement {
  std::string name;
  std::vector<std::size_t> ball;
  std::vector<Corner> at;  ///< what the axes showed
  /// A coordinate that was not measured gives no reading; `at`: the axis position, or NaN.
  std::array<bool, 3> measured{true, true, true};
};

struct Artefact {
  std::string name;
  std::vector<ArtefactBall> balls;
  std::vector<ArtefactLength> lengths;
  double u_scale = 0.0;  ///< of what all that is stated has in common, m/m
  std::vector<ArtefactPlacement> placements;
};

struct ArtefactLines {
  /// One for each placement and coordinate that was measured, along X, Y and Z; behind them one of
  /// what is stated, if anything is: coordinates by ball, lengths, and last the scale c.
  std::vector<RigidLine> lines;
  struct Of {
    std::size_t placement, coordinate;
  };
  std::vector<Of> of;        ///< of these lines but the last
  std::size_t unknowns = 0;  ///< shared
  bool states = false;       ///< whether the last line is of what is stated
};

/// Why readings are no readings of this artefact.
struct ArtefactRefusal {
  enum class Why {
    not_linked,   ///< a placement or ball that nothing links with the others
    does_not_fit  ///< a ball is farther than `artefact_limit` from the position that the others give
  };
  Why why = Why::not_linked;
  std::string placement, ball;
  double distance = 0.0;  ///< m
};

/// Farther than this no ball is from where it should be: then it is another ball, or another
/// artefact. docs/dev/constants.md, A22.
inline constexpr double artefact_limit = 0.3e-3;

/// `first`: number of its first shared unknown; `group`: of the scatter.
tl::expected<ArtefactLines, ArtefactRefusal> artefact_lines(const Artefact&, std::size_t first,
                                                            std::size_t group);

}  // namespace nonio::math
