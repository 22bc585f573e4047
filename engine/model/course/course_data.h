// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "data/design.h"
#include "nonio/model/explain.h"

/// Displacements over time. What the fit and the search of a course have in common.
namespace nonio::model {

/// A shape of a term and its columns in the bins.
struct CourseColumns {
  std::vector<double> shape;
  MatrixXd columns;
};

/// Rows of a course, averaged to at most `most_bins` of equal length (one more than a product of 2, 3
/// and 5, for the Fourier transform of their changes), and blocks that follow each other in time.
class CourseData {
 public:
  static constexpr Index blocks = course_blocks, most_bins = 751;

  explicit CourseData(const Part& part);

  Index size() const { return static_cast<Index>(first_.size()) - 1; }
  /// Means in the bins of a column with an entry for each reading.
  VectorXd means(const std::vector<double>& column) const;
  MatrixXd means(const Effect::Columns& columns) const;
  /// The first bin of block b; of b = count its end.
  Index begin_of(Index b, Index count = blocks) const { return b * size() / count; }
  /// Mean time of the readings of a bin, s.
  double time(Index b) const { return time_(b); }
  double duration() const { return size() > 1 ? time_(size() - 1) - time_(0) : 0.0; }
  /// Of this displacement, then of those that move with it: m.
  const MatrixXd& displacements() const { return displacements_; }
  const Part& part() const { return part_; }
  /// For every shape on the grid of a term (`shapes_of`); those that an effect cannot make are left out.
  /// Made once for each term.
  const std::vector<CourseColumns>& on_grid(const Term& term) const;

 private:
  const Part& part_;
  mutable std::map<std::pair<std::string, std::vector<double>>, std::vector<CourseColumns>> grids_;
  std::vector<std::size_t> first_;  ///< row of each bin, and the end
  MatrixXd displacements_;
  VectorXd time_;
};

/// Correlation of successive entries.
double successive(const VectorXd& residual);

/// What the coefficients of a term are.
std::vector<Quantity> quantities_of(const Term& term);

}  // namespace nonio::model
