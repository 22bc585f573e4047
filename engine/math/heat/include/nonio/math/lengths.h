// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/results.h"

/// Length measuring errors of a machine that measures with a probe, in the manner of ISO 10360-2.
///
///     E = measured - calibrated length, with its sign        E0 without, EL with an offset of the stylus
///     MPE(L) = min(A + L/K, B)                               L the calibrated length
///     R0 = largest range of the repeats of one length
///     P = largest - least radial distance of the points from the centre of the least-squares sphere
///
/// Decision (decision.h) for each error with its U(L), guard band g of the rule (ISO 14253-1:2017:
/// 1.65 u): conforms where abs(E) <= MPE - g for all; does not where abs(E) > MPE + g for one; else
/// indeterminate. Each repeat is an error of its own: their scatter is in E, not in U (ISO/TS
/// 23165, from general knowledge).
///
/// Edition 2001: of at most five lengths one of the three repeats may be outside; each of these
/// lengths is then measured ten more times (repeats 4 to 13), all of which must be inside.
///
/// Symbols: E, L, MPE, U in m. Sources: ISO 10360-2:2001 and 2009 (names and procedure after public
/// guides; the text was not available). Range: L > 0, all finite.
namespace nonio::math {

struct LengthLimit {
  double A = 0.0;  ///< m
  double K = 0.0;  ///< L/K: m of length for each m of error; 0: no such part
  double B = 0.0;  ///< m; 0: none
  bool stated() const { return A > 0.0 || K > 0.0 || B > 0.0; }
  double at(double L) const;
};

struct LengthError {
  double L = 0.0, E = 0.0;
  std::uint32_t repeat = 1;
  std::size_t line = 0;  ///< position in the volume
};

struct LengthAnswer {
  Decision decision = Decision::cannot_be_decided;
  std::size_t worst = 0;      ///< error that is nearest to its limit, or farthest beyond
  std::size_t outside = 0;    ///< errors beyond MPE + g
  std::size_t undecided = 0;  ///< errors nearer to MPE than g
  std::size_t to_repeat = 0;  ///< edition 2001: lengths that have to be measured ten times more
};

/// U: of each error. by_2001: with its five lengths. rule: of the certificate.
LengthAnswer judge_lengths(const std::vector<LengthError>& all, const LengthLimit& limit,
                           const std::vector<double>& U, bool by_2001,
                           std::string_view rule = "iso14253-1");

/// Largest range of the first three repeats; none where no length has two.
struct RepeatRange {
  double range = 0.0;
  std::size_t low = 0, high = 0;
};
std::optional<RepeatRange> repeat_range(const std::vector<LengthError>& all);

/// What the plan lacks of five lengths, three repeats, seven positions.
struct LengthPlan {
  std::size_t positions = 0, lengths = 0, repeats = 0;  ///< of the position that has least of them
  bool whole() const { return positions >= 7 && lengths >= 5 && repeats >= 3; }
};
LengthPlan length_plan(const std::vector<LengthError>& all);

/// Least-squares sphere (Gauss-Newton on radial distances); none of fewer than five points or points
/// that lie in a plane.
struct FormOfSphere {
  std::array<double, 3> centre{};
  double radius = 0.0, P = 0.0;
  double s = 0.0;  ///< of the radial distances
  std::size_t outermost = 0, innermost = 0;
};
std::optional<FormOfSphere> form_of_sphere(const std::vector<std::array<double, 3>>& points);

}  // namespace nonio::math
