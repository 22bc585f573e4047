// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "course_noise.h"

/// Many columns over time, of which sets are judged by their evidence.
namespace nonio::model {

struct CourseSides;

/// Columns, each once, and their products under a noise that is correlated in time. Coefficients have
/// a normal prior as wide as a body allows: half of 50 um/K, or three times what the displacement
/// does.
class CoursePool {
 public:
  /// Scatter that is searched (`CourseNoise`).
  static constexpr std::array scatters{0.0, 1.0, 30.0, 1000.0};

  CoursePool(const CourseData& data, const CourseNoise& noise);

  /// Where the columns are; bins x k. `of`: what their coefficients are; the last one counts for all
  /// further columns.
  std::vector<Index> add(const MatrixXd& columns, const std::vector<Quantity>& of);
  /// Before any other call.
  void finish();

  /// - ln of the evidence of these columns for each side. The zero, the coefficients and the variance
  /// of the noise are integrated out.
  Eigen::RowVectorXd cost(const std::vector<Index>& columns, const CourseSides& sides) const;
  /// Coefficients of the columns as they were added: columns x sides.
  MatrixXd coefficients(const std::vector<Index>& columns, const CourseSides& sides) const;
  /// Of the noise that the columns leave of the first side, m^2.
  double variance(const std::vector<Index>& columns, const CourseSides& sides) const;
  /// Of the coefficients of the columns as they were added, for noise of unit variance; `variance`:
  /// that of the noise, for the prior.
  MatrixXd covariance(const std::vector<Index>& columns, double variance) const;
  /// What these columns leave of displacements, bins x displacements.
  MatrixXd remainder(const std::vector<Index>& columns, const MatrixXd& displacements) const;
  /// RMS of blocks of one side that are left out, each less its own mean, m.
  double left_out(const std::vector<Index>& columns, const CourseSides& sides, Index side) const;

  static constexpr std::size_t most_columns = 6;

  /// What is added to `columns` one by one, whatever adds most evidence.
  struct Greedy {
    std::vector<Index> added;
    double gain = 0.0;      ///< of evidence, at best, less the penalty for each of them
    double variance = 0.0;  ///< of the noise after the last one
  };
  /// For sides [from, from + count), which have the same columns.
  Greedy greedy(const std::vector<Index>& columns, const CourseSides& sides, Index from,
                Index count) const;
  /// Variance of the noise / variance of a coefficient in units of its prior, m^2.
  double ridge() const { return ridge_; }
  /// ln of the number of columns: what one of them must add.
  double penalty() const;

  const CourseData& data() const { return data_; }
  const CourseWhitening& whitening() const { return whitening_; }
  const MatrixXd& white() const { return white_; }
  const MatrixXd& raw() const { return raw_; }

 private:
  Index add_one(const VectorXd& column, double prior);
  Eigen::LLT<MatrixXd> normal(const std::vector<Index>& columns) const;
  double bins() const { return static_cast<double>(data_.size() - 1); }

  const CourseData& data_;
  CourseWhitening whitening_;
  std::vector<VectorXd> columns_;  ///< times their priors
  std::vector<double> prior_;
  std::map<std::pair<double, double>, std::vector<Index>> places_;
  MatrixXd raw_, white_, products_;
  /// Products in each block: of the white columns, and of the columns less their means there.
  struct Blocks {
    std::vector<MatrixXd> white, centred;
  };
  const Blocks& blocks() const;
  mutable std::optional<Blocks> blocks_;  ///< made when blocks are left out
  double sd_ = 0.0;                       ///< of the displacements, m
  double ridge_ = 0.0;  ///< variance of the noise / variance of a coefficient, m^2
};

/// Products of a pool with displacements: the same for many displacements at once.
struct CourseSides {
  MatrixXd products;           ///< pool x displacements
  Eigen::RowVectorXd squares;  ///< of each displacement, m^2
  struct Blocks {
    std::vector<MatrixXd> white, centred;             ///< as of the pool
    std::vector<Eigen::RowVectorXd> centred_squares;  ///< of each block, m^2
  };

  CourseSides(const CoursePool& pool, MatrixXd displacements);
  const Blocks& blocks(const CoursePool& pool) const;

 private:
  MatrixXd displacements_, white_;
  mutable std::optional<Blocks> blocks_;  ///< made when blocks are left out
};

}  // namespace nonio::model
