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
/// certificate, or as measured in the first placement. Stated values are additional equations, each
/// with its u: dq_j = c q_j for a coordinate, n.(dq_a - dq_b) = L - |q_a - q_b| + c L for a length
/// L, and c = 0 for their common scale; without stated values, the scales are not determined. The
/// equations are of first order: w^2/2 of the size is neglected (0.04 um for 0.2 mm on 0.5 m).
/// Derived (docs/dev/estimators.md).
namespace nonio::math {

struct ArtefactBall {
  std::string name;
  std::optional<Corner> stated{};  ///< coordinates of the certificate, in the frame of the artefact
  double u = 0.0;                  ///< standard uncertainty of each stated coordinate, m
};

struct ArtefactLength {
  std::size_t a = 0, b = 0;
  double length = 0.0;
  double u = 0.0;
};

/// The probed balls of one placement, each once, in the order of probing.
struct ArtefactPlacement {
  std::string name;
  std::vector<std::size_t> ball;
  std::vector<Corner> at;  ///< positions of the balls as shown by the axes, m
  /// Without a reading of a coordinate, `at` contains the axis position or NaN.
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
  std::vector<Of> of;  ///< placement and coordinate of each line except that of stated values
  std::size_t unknowns = 0;
  bool states = false;  ///< whether the last line contains stated values
};

struct ArtefactRefusal {
  enum class Why {
    not_linked,  ///< no common balls link a placement or ball with the others
    /// the position of a ball or a length differs by more than `artefact_limit` from the expected
    does_not_fit
  };
  Why why = Why::not_linked;
  std::string placement, ball;
  double distance = 0.0;  ///< distance from the expected position, or error of the length, m
};

/// Largest plausible distance of a ball from its expected position, m; beyond it, another ball or
/// artefact was probed: docs/dev/constants.md, A22.
inline constexpr double artefact_limit = 0.3e-3;

/// `first`: index of the artefact's first shared unknown; `group`: scatter group of its readings.
tl::expected<ArtefactLines, ArtefactRefusal> artefact_lines(const Artefact&, std::size_t first,
                                                            std::size_t group);

}  // namespace nonio::math
