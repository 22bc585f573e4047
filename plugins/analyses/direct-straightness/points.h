// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/math/measured_line.h"
#include "nonio/sdk/error.h"
#include "nonio/sdk/plugin.h"

namespace nonio::direct_straightness {

/// Deviations across the line of motion, made from the means y of one measurement or two:
/// e = D y.
struct Points {
  std::string name;                     ///< "EYX"
  std::vector<double> x, e;             ///< m
  std::vector<double> artefact;         ///< of the straightedge, from a reversal; m
  std::vector<std::vector<double>> by;  ///< D: a row a point, a column a mean
  std::vector<double> u;                ///< standard uncertainty of each mean, by repetition
  double dof = 0.0;                     ///< smallest of the measurements; 0: no repetition
  std::vector<math::BudgetLine> lines;
  std::vector<math::MeasuredLine> measured;  ///< in the order of `lines`
  std::vector<std::string> uses;             ///< the other measurement
  int direction = 0;                         ///< 0: means of both
  bool integrated = false;
};

/// What a measurement needs to be evaluated, or the finding that refuses it.
using PointsOrRefusal = tl::expected<Points, Finding>;
PointsOrRefusal points_of(const AnalysisInput&);

/// Derivative of a result by the means, from that by the points.
std::vector<double> by_means(const Points&, const std::vector<double>& by_points);

}  // namespace nonio::direct_straightness
