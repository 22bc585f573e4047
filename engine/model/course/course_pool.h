// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "course_data.h"

/// Many columns over time, of which sets are judged by blocks that are left out.
namespace nonio::model {

/// Columns, each once and of unit length without the zeros of blocks, and their products in each
/// block.
class CoursePool {
 public:
  explicit CoursePool(const CourseData& data) : data_(data) {}

  /// Where the columns are. `of`: what their coefficients are.
  std::vector<Index> add(const MatrixXd& columns, const std::vector<Effect::Parameter>& of);
  /// Before anything else is asked.
  void finish();

  MatrixXd block(const MatrixXd& of, Index b) const {
    const Index from = data_.begin_of(b);
    return of.middleRows(from, data_.begin_of(b + 1) - from);
  }
  /// What these columns leave of displacements, of which the fit has a zero for each block and the
  /// remainder has none.
  MatrixXd remainder(const std::vector<Index>& columns, const MatrixXd& displacements) const;
  /// Largest coefficient of a column that a body can have.
  double most(Index k) const { return most_[static_cast<std::size_t>(k)]; }
  const MatrixXd& all() const { return all_; }
  const MatrixXd& whole() const { return whole_; }
  const MatrixXd& of_block(Index b) const { return of_block_[static_cast<std::size_t>(b)]; }
  const CourseData& data() const { return data_; }

 private:
  Index add_one(const VectorXd& centred, const VectorXd& raw, double most);

  const CourseData& data_;
  std::vector<VectorXd> columns_, raw_;
  std::vector<double> most_;
  std::map<std::pair<double, double>, std::vector<Index>> places_;
  MatrixXd all_, whole_;
  std::vector<MatrixXd> of_block_;
};

/// Products of the pool with displacements (without zeros): the same for many displacements at once.
struct CourseSides {
  std::vector<MatrixXd> of_block;  ///< pool x displacements
  MatrixXd whole;
  std::vector<Eigen::RowVectorXd> squares;  ///< in each block

  CourseSides(const CoursePool& pool, const MatrixXd& displacements);
};

/// Mean squares of what is left out, of each displacement, m^2; infinite where the columns cannot be
/// separated or a coefficient is larger than a body can have.
Eigen::RowVectorXd left_out(const CoursePool& pool, const CourseSides& sides,
                            const std::vector<Index>& columns);

/// Half the mean logarithm over displacements that are judged together: ln of an RMS.
double level(const Eigen::RowVectorXd& squares);

}  // namespace nonio::model
