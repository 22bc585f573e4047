// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "data/design.h"
#include "nonio/model/explain.h"

/// Displacements over time. What the fit and the search of a course have in common.
namespace nonio::model {

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

 private:
  const Part& part_;
  std::vector<std::size_t> first_;  ///< row of each bin, and the end
  MatrixXd displacements_;
  VectorXd time_;
};

/// How much fewer independent readings there are than readings: (1 + r)/(1 - r) with r the
/// correlation of successive residuals; at least 1. Source: Bayley and Hammersley 1946.
double repetition(double correlation);
/// Correlation of successive entries.
double successive(const VectorXd& residual);

/// What the coefficients of a term are.
std::vector<Quantity> quantities_of(const Term& term);

/// A shape of a term and its columns in the bins.
struct CourseColumns {
  std::vector<double> shape;
  MatrixXd columns;
};
/// For every shape on the grid of a term (`shapes_of`); those that an effect cannot make are left out.
std::vector<CourseColumns> columns_on_grid(const CourseData& data, const Term& term);

}  // namespace nonio::model
