// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "laboratory/statistics/series.h"

/// What changed between two campaigns, and whether a table did what it promised. What both have in
/// common (one source) cancels. Source: JCGM 100:2008, 5.2; ISO 13528 zeta score (difference over
/// its standard uncertainty; E_n with k = 2 is half of it).
namespace nonio::statistics {

struct Difference {
  double value = 0.0, u = 0.0;
  double p = 1.0;  ///< two-sided, normal: of one as large by chance

  double zeta() const { return u > 0.0 ? value / u : 0.0; }
};

/// after - before - expected. An error as `check` gives it, of point 1 (before) or 2, or where
/// `expected` is not a number.
Expected<Difference> difference(const Point& before, const Point& after, double expected = 0.0,
                                double u_expected = 0.0);

/// Numbers of one campaign that are estimated together: mean deviations at targets, or coefficients
/// of a curve.
struct Curve {
  struct Shared {
    std::string source;
    std::vector<double> u;  ///< signed, of each value
  };
  std::vector<double> values;
  std::vector<double> covariance;  ///< of what is new in each campaign; row by row
  std::vector<Shared> common{};
};

/// values_i = sum_k basis[i][k] coefficients_k: a curve at places, from its coefficients. An error
/// if a row of the basis has another length.
Expected<Curve> seen_through(const Curve& coefficients,
                             const std::vector<std::vector<double>>& basis);

struct CurveDifference {
  std::vector<double> values, u;  ///< at each place
  double chi2 = 0.0, dof = 0.0;
  double p = 1.0;  ///< of a curve that differs as much by chance
  /// Place with the largest |value|/u, and its p among all places (Bonferroni).
  std::size_t largest = 0;
  double p_largest = 1.0;
};

/// after - before - expected (of the same length, or empty: 0) with
/// V = V_before + V_after + sum over sources (c_after - c_before)(..)'. chi2 = d' V^+ d over the
/// directions that V knows of: a curve through few coefficients has few degrees of freedom. An
/// error if lengths differ or a number is not finite, or a variance is not above 0.
Expected<CurveDifference> difference(const Curve& before, const Curve& after,
                                     const std::vector<double>& expected = {});

/// Whether a table did what it promised: as-left less as-found against the step that it was to
/// make.
struct TableCheck {
  Difference beside;  ///< of the promised step
  /// Share of the error as found that the table took away: 1 all, 0 none, below 0: made worse.
  /// None where the error as found is within twice its uncertainty.
  std::optional<double> taken{};
  bool as_promised = true;  ///< not beyond chance at 1 %
};

/// promised: as-left less as-found by the table alone; u_promised: of its rounding, and of the
/// interpolation between its points.
Expected<TableCheck> check_table(const Point& as_found, const Point& as_left, double promised,
                                 double u_promised = 0.0);

}  // namespace nonio::statistics
