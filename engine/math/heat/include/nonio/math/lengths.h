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

/// Length measuring errors of a machine that measures with a probe, according to ISO 10360-2.
///
///     E = measured - calibrated length, with its sign  E0 without, EL with an offset of the stylus
///     MPE(L) = min(A + L/K, B)                         L the calibrated length
///     R0 = largest range of the repeats of one length
///     P = largest - smallest radial distance of the points from the center of the least-squares
///         sphere
///
/// Decision (decision.h) over all errors with U(L) and guard band g: conforms if abs(E) <= MPE - g
/// for all, does not conform if abs(E) > MPE + g for one. The scatter of repeats is part of E, not
/// of U (ISO/TS 23165, from general knowledge).
///
/// Edition 2001: for at most five lengths, one of the three repeats may be outside; each of these
/// lengths is then measured ten more times (repeats 4 to 13), all of which must be inside.
///
/// Lengths in m. Sources: ISO 10360-2:2001 and 2009, from public guides (text not available).
namespace nonio::math {

struct LengthLimit {
  double A = 0.0;  ///< constant part of the limit, m
  double K = 0.0;  ///< in L/K: length for each m of error; 0: no such term
  double B = 0.0;  ///< upper bound, m; 0 if there is none
  bool stated() const { return A > 0.0 || K > 0.0 || B > 0.0; }
  double at(double L) const;
};

struct LengthError {
  double L = 0.0, E = 0.0;
  std::uint32_t repeat = 1;
  std::size_t line = 0;  ///< index of the measuring line, a position in the volume
};

struct LengthAnswer {
  Decision decision = Decision::cannot_be_decided;
  std::size_t worst = 0;      ///< index of the error that decides, with its guard band
  std::size_t outside = 0;    ///< number of errors beyond MPE + g, except those permitted in 2001
  std::size_t undecided = 0;  ///< number of errors closer to MPE than g
  /// edition 2001: number of lengths that must be measured ten more times
  std::size_t to_repeat = 0;
};

/// `U`: expanded uncertainty of each error, m. `by_2001`: up to five lengths may have an error
/// outside. `rule`: decision rule of the certificate. `k`: coverage factor of each U.
LengthAnswer judge_lengths(const std::vector<LengthError>& all, const LengthLimit& limit,
                           const std::vector<double>& U, bool by_2001,
                           std::string_view rule = "iso14253-1", const std::vector<double>& k = {});

/// The largest range of the first three repeats of a length, m, and the indices of its smallest and
/// largest error. `repeat_range` returns std::nullopt if no length has two repeats.
struct RepeatRange {
  double range = 0.0;
  std::size_t low = 0, high = 0;
};
std::optional<RepeatRange> repeat_range(const std::vector<LengthError>& all);

/// Numbers of positions, lengths and repeats; seven, five and three are required.
struct LengthPlan {
  /// for lengths and repeats: smallest number at any position
  std::size_t positions = 0, lengths = 0, repeats = 0;
  bool whole() const { return positions >= 7 && lengths >= 5 && repeats >= 3; }
};
LengthPlan length_plan(const std::vector<LengthError>& all);

/// The least-squares sphere of points, by Gauss-Newton on the radial distances; lengths in m.
/// `form_of_sphere` returns std::nullopt for fewer than five points or points in a plane.
struct FormOfSphere {
  std::array<double, 3> centre{};
  double radius = 0.0, P = 0.0;
  double s = 0.0;  ///< standard deviation of the radial distances
  std::size_t outermost = 0, innermost = 0;
};
std::optional<FormOfSphere> form_of_sphere(const std::vector<std::array<double, 3>>& points);

}  // namespace nonio::math
