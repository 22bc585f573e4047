// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "dense.h"

namespace nonio::math {

/// A combination that changes no reading: indices and coefficients of unknowns, the first one 1.
using OpenCombination = std::vector<std::pair<std::size_t, double>>;

/// Returns the combinations that the readings do not determine, by elimination from the left: a
/// column without a pivot is a linear combination of the pivot columns before it. The columns of
/// the argument are unit vectors of the determined directions. Coefficients up to `least` are
/// treated as 0. An unknown on which no reading depends is a combination by itself.
inline std::vector<OpenCombination> open_combinations(const Eigen::MatrixXd& told, double least) {
  Eigen::MatrixXd R = told.transpose();
  std::vector<Eigen::Index> pivots;
  std::vector<OpenCombination> out;
  Eigen::Index row = 0;
  for (Eigen::Index c = 0; c < R.cols(); ++c) {
    Eigen::Index best = 0;
    if (row < R.rows() && R.col(c).tail(R.rows() - row).cwiseAbs().maxCoeff(&best) >= least) {
      R.row(row).swap(R.row(row + best));
      R.row(row) /= R(row, c);
      for (Eigen::Index r = 0; r < R.rows(); ++r)
        if (r != row) R.row(r) -= R(r, c) * Eigen::RowVectorXd(R.row(row));
      pivots.push_back(c);
      ++row;
    }
  }
  for (Eigen::Index c = 0, next = 0; c < R.cols(); ++c) {
    if (next < at(pivots.size()) && pivots[static_cast<std::size_t>(next)] == c) {
      ++next;
      continue;
    }
    OpenCombination one{{static_cast<std::size_t>(c), 1.0}};
    for (std::size_t r = 0; r < pivots.size(); ++r)
      if (const double share = -R(at(r), c); std::fabs(share) > least)
        one.emplace_back(static_cast<std::size_t>(pivots[r]), share);
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace nonio::math
