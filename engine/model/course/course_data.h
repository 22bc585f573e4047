// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "data/design.h"
#include "nonio/model/explain.h"

namespace nonio::model {

/// One shape of a term, and its columns in the bins.
struct CourseColumns {
  std::vector<double> shape;
  MatrixXd columns;
};

/// Rows averaged in at most `most_bins` bins of nearly equal size, or a few more if the part has
/// several lines, at which bins begin. The number of bins minus 1 has only the prime factors 2, 3 and 5,
/// for the Fourier transform of the changes.
class CourseData {
 public:
  static constexpr Index blocks = course_blocks, most_bins = 751;

  explicit CourseData(const Part& part);

  Index size() const { return static_cast<Index>(first_.size()) - 1; }
  /// Returns the means over each bin of columns that have one entry per reading.
  VectorXd means(const std::vector<double>& column) const;
  MatrixXd means(const Effect::Columns& columns) const;
  /// Returns the first bin of block b; for b = count the end of the last block.
  Index begin_of(Index b, Index count = blocks) const { return b * size() / count; }
  /// First bin of each line: its bins have a common zero.
  const std::vector<Index>& lines() const { return lines_; }
  bool begins_line(Index b) const { return std::binary_search(lines_.begin(), lines_.end(), b); }
  /// Subtracts from rows, of which the first is that of bin `from`, their means in each line.
  void centre(MatrixXd& rows, Index from = 0) const;
  /// Mean time of the readings of bin b, and time from the first to the last bin, s.
  double time(Index b) const { return time_(b); }
  double duration() const { return size() > 1 ? time_(size() - 1) - time_(0) : 0.0; }
  /// Displacement of this part, then those that move together with it: bins x displacements, m.
  const MatrixXd& displacements() const { return displacements_; }
  const Part& part() const { return part_; }
  /// Columns for the grid of a term, without shapes for which the effect returns an error.
  const std::vector<CourseColumns>& on_grid(const Term& term) const;

 private:
  const Part& part_;
  mutable std::map<std::pair<std::string, std::vector<double>>, std::vector<CourseColumns>> grids_;
  std::vector<std::size_t> first_;  ///< first row of each bin, and the end
  std::vector<Index> lines_;
  MatrixXd displacements_;
  VectorXd time_;
};

/// Returns the correlation coefficient of successive residuals.
double successive(const VectorXd& residual);

std::vector<Quantity> quantities_of(const Term& term);

}  // namespace nonio::model
