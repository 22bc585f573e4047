// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "course_noise.h"

namespace nonio::model {

struct CourseSides;

/// A pool of distinct columns, and their products under noise that is correlated in time. Each
/// coefficient has a normal prior with the largest plausible standard deviation: half of 50 um/K,
/// or for other quantities the value that gives three times the scatter of the displacement.
class CoursePool {
 public:
  /// Searched values of `CourseNoise::scatter`, the ratio of independent to correlated variance.
  static constexpr std::array scatters{0.0, 1.0, 30.0, 1000.0};

  CoursePool(const CourseData& data, const CourseNoise& noise);

  /// Columns: bins x k. Returns their indices in the pool, which contains equal columns once. `of`:
  /// quantities of the coefficients; the last one applies to all further columns.
  std::vector<Index> add(const MatrixXd& columns, const std::vector<Quantity>& of);
  /// To be called after the last `add` and before any other member.
  void finish();

  /// -ln of the evidence for each displacement of `sides`, with the zero, the coefficients and the
  /// variance of the noise integrated out.
  Eigen::RowVectorXd cost(const std::vector<Index>& columns, const CourseSides& sides) const;
  /// Returns the coefficients of the unscaled columns: columns x displacements.
  MatrixXd coefficients(const std::vector<Index>& columns, const CourseSides& sides) const;
  /// Variance of the noise for the first displacement, m^2.
  double variance(const std::vector<Index>& columns, const CourseSides& sides) const;
  /// Covariance of the coefficients of the unscaled columns for noise of unit variance. `variance`:
  /// of the noise, m^2, for the weight of the prior.
  MatrixXd covariance(const std::vector<Index>& columns, double variance) const;
  /// Result: bins x displacements.
  MatrixXd remainder(const std::vector<Index>& columns, const MatrixXd& displacements) const;
  /// RMS of cross-validation of displacement `side`, m; each block of time has zeros of its own.
  double left_out(const std::vector<Index>& columns, const CourseSides& sides, Index side) const;

  static constexpr std::size_t most_columns = 6;

  /// Columns that a greedy search adds one by one, each with the largest gain of evidence.
  struct Greedy {
    std::vector<Index> added;
    /// largest gain of ln evidence after any number of columns, each reduced by the penalty
    double gain = 0.0;
    double variance = 0.0;  ///< variance of the noise after the last added column, m^2
  };
  /// For the displacements `from` to `from + count - 1` together, with the same columns.
  Greedy greedy(const std::vector<Index>& columns, const CourseSides& sides, Index from,
                Index count) const;
  /// Variance of the noise divided by that of a coefficient that is scaled by its prior, m^2.
  double ridge() const { return ridge_; }
  /// Returns ln of the number of columns: the evidence that each additional column must exceed.
  double penalty() const;

  const CourseData& data() const { return data_; }
  const CourseWhitening& whitening() const { return whitening_; }
  const MatrixXd& white() const { return white_; }
  const MatrixXd& raw() const { return raw_; }

 private:
  Index add_one(const VectorXd& column, double prior);
  Eigen::LLT<MatrixXd> normal(const std::vector<Index>& columns) const;
  /// Number of bins less that of the zeros.
  double bins() const {
    return static_cast<double>(data_.size()) - static_cast<double>(data_.lines().size());
  }

  const CourseData& data_;
  CourseWhitening whitening_;
  /// added columns, multiplied by the standard deviation of their prior
  std::vector<VectorXd> columns_;
  std::vector<double> prior_;
  std::map<std::pair<double, double>, std::vector<Index>> places_;
  MatrixXd raw_, white_, products_;
  /// Products within each block: of whitened columns, and of columns minus their block means.
  struct Blocks {
    std::vector<MatrixXd> white, centred;
  };
  const Blocks& blocks() const;
  mutable std::optional<Blocks> blocks_;  ///< computed at the first cross-validation
  double sd_ = 0.0;                       ///< largest standard deviation of a displacement, m
  double ridge_ = 0.0;
};

/// Displacements, and their products with the columns of a pool, computed once.
struct CourseSides {
  MatrixXd products;           ///< pool x displacements
  Eigen::RowVectorXd squares;  ///< whitened sum of squares of each displacement, m^2
  struct Blocks {
    /// products in each block, as in CoursePool::Blocks, of the columns with the displacements
    std::vector<MatrixXd> white, centred;
    /// sum of squares in each block about its mean, m^2
    std::vector<Eigen::RowVectorXd> centred_squares;
  };

  CourseSides(const CoursePool& pool, MatrixXd displacements);
  const Blocks& blocks(const CoursePool& pool) const;

 private:
  MatrixXd displacements_, white_;
  mutable std::optional<Blocks> blocks_;  ///< computed at the first cross-validation
};

}  // namespace nonio::model
