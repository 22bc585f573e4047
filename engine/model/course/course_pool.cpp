// SPDX-License-Identifier: Apache-2.0
#include "course_pool.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nonio::model {

namespace {

constexpr double most_per_kelvin =
    50e-6;  // m/K: two metres of aluminium; docs/dev/constants.md, M40
constexpr double unlimited = std::numeric_limits<double>::infinity();

}  // namespace

std::vector<Index> CoursePool::add(const MatrixXd& columns,
                                   const std::vector<Effect::Parameter>& of) {
  const MatrixXd centred = data_.without_zeros(columns);
  std::vector<Index> places;
  for (Index k = 0; k < columns.cols(); ++k) {
    const double length = std::max(centred.col(k).norm(), 1e-300);
    const auto p = std::min(static_cast<std::size_t>(k), of.size() - 1);
    const bool per_kelvin = of[p].quantity == Quantity::deviation_per_kelvin;
    places.push_back(add_one(centred.col(k) / length, columns.col(k) / length,
                             per_kelvin ? most_per_kelvin * length : unlimited));
  }
  return places;
}

Index CoursePool::add_one(const VectorXd& centred, const VectorXd& raw, double most) {
  const auto key = std::pair(centred(centred.size() / 3), centred(centred.size() - 1));
  for (const Index known : places_[key])
    if (columns_[static_cast<std::size_t>(known)] == centred) return known;
  places_[key].push_back(static_cast<Index>(columns_.size()));
  columns_.push_back(centred);
  raw_.push_back(raw);
  most_.push_back(most);
  return static_cast<Index>(columns_.size()) - 1;
}

void CoursePool::finish() {
  all_.resize(data_.size(), static_cast<Index>(columns_.size()));
  for (std::size_t k = 0; k < columns_.size(); ++k) all_.col(static_cast<Index>(k)) = columns_[k];
  columns_.clear();
  whole_ = MatrixXd::Zero(all_.cols(), all_.cols());
  for (Index b = 0; b < CourseData::blocks; ++b) {
    const MatrixXd rows = block(all_, b);
    of_block_.push_back(math::transposed_product(rows, rows));
    whole_ += of_block_.back();
  }
}

MatrixXd CoursePool::remainder(const std::vector<Index>& columns,
                               const MatrixXd& displacements) const {
  if (columns.empty()) return displacements;
  MatrixXd centred(data_.size(), static_cast<Index>(columns.size())), raw = centred;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    centred.col(static_cast<Index>(k)) = all_.col(columns[k]);
    raw.col(static_cast<Index>(k)) = raw_[static_cast<std::size_t>(columns[k])];
  }
  const Eigen::LDLT<MatrixXd> normal(math::transposed_product(centred, centred));
  const MatrixXd right = math::transposed_product(centred, data_.without_zeros(displacements));
  MatrixXd out = displacements;
  for (Index k = 0; k < out.cols(); ++k)
    out.col(k) -= math::times(raw, math::solution(normal, VectorXd(right.col(k))));
  return out;
}

CourseSides::CourseSides(const CoursePool& pool, const MatrixXd& displacements) {
  whole = MatrixXd::Zero(pool.all().cols(), displacements.cols());
  for (Index b = 0; b < CourseData::blocks; ++b) {
    const MatrixXd rows = pool.block(displacements, b);
    of_block.push_back(math::transposed_product(pool.block(pool.all(), b), rows));
    whole += of_block.back();
    squares.push_back(rows.colwise().squaredNorm());
  }
}

Eigen::RowVectorXd left_out(const CoursePool& pool, const CourseSides& sides,
                            const std::vector<Index>& columns) {
  Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(sides.whole.cols());
  const auto p = static_cast<Index>(columns.size());
  MatrixXd normal(p, p), own(p, p), right(p, sum.size()), here(p, sum.size());
  for (Index b = 0; b < CourseData::blocks; ++b) {
    const MatrixXd& block = pool.of_block(b);
    const MatrixXd& side = sides.of_block[static_cast<std::size_t>(b)];
    for (Index i = 0; i < p; ++i) {
      const Index at = columns[static_cast<std::size_t>(i)];
      here.row(i) = side.row(at);
      right.row(i) = sides.whole.row(at) - here.row(i);
      for (Index k = 0; k <= i; ++k) {
        const Index other = columns[static_cast<std::size_t>(k)];
        own(i, k) = own(k, i) = block(at, other);
        normal(i, k) = normal(k, i) = pool.whole()(at, other) - own(i, k);
      }
    }
    sum += sides.squares[static_cast<std::size_t>(b)];
    if (p == 0) continue;
    const Eigen::LLT<MatrixXd> llt(normal);
    constexpr double least = 1e-4;  // of a column of unit length, given the others
    if (llt.info() != Eigen::Success || !(llt.matrixLLT().diagonal().minCoeff() > least))
      return Eigen::RowVectorXd::Constant(sum.size(), std::numeric_limits<double>::infinity());
    const MatrixXd x = math::solutions(llt, right);
    for (Index i = 0; i < p; ++i) {
      const double most = pool.most(columns[static_cast<std::size_t>(i)]);
      for (Index k = 0; k < x.cols() && std::isfinite(most); ++k)
        if (!(std::fabs(x(i, k)) <= most)) sum(k) = std::numeric_limits<double>::infinity();
    }
    sum += (x.cwiseProduct(math::product(own, x) - 2.0 * here)).colwise().sum();
  }
  return sum.cwiseMax(1e-300) / static_cast<double>(pool.data().size());
}

double level(const Eigen::RowVectorXd& squares) { return 0.5 * squares.array().log().mean(); }

}  // namespace nonio::model
