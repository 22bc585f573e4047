// SPDX-License-Identifier: Apache-2.0
#include "course_pool.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nonio::model {

namespace {

// docs/dev/constants.md, M40.
constexpr double most_displacements = 3.0;
// first value of the ridge, in units of the variance of the displacements
constexpr double first_ridge = 1e-3;

VectorXd picked(const MatrixXd& of, Index column, const std::vector<Index>& rows) {
  VectorXd out(static_cast<Index>(rows.size()));
  for (Index i = 0; i < out.size(); ++i) out(i) = of(rows[static_cast<std::size_t>(i)], column);
  return out;
}

MatrixXd picked_columns(const MatrixXd& of, const std::vector<Index>& columns) {
  MatrixXd out(of.rows(), static_cast<Index>(columns.size()));
  for (Index k = 0; k < out.cols(); ++k) out.col(k) = of.col(columns[static_cast<std::size_t>(k)]);
  return out;
}

MatrixXd block_of(const CourseData& data, const MatrixXd& columns, Index b) {
  const Index from = data.begin_of(b);
  return columns.middleRows(from, data.begin_of(b + 1) - from);
}

MatrixXd centred_block(const CourseData& data, const MatrixXd& columns, Index b) {
  MatrixXd out = block_of(data, columns, b);
  data.centre(out, data.begin_of(b));
  return out;
}

double deviation_of(const VectorXd& x) { return std::sqrt((x.array() - x.mean()).square().mean()); }

}  // namespace

CoursePool::CoursePool(const CourseData& data, const CourseNoise& noise)
    : data_(data), whitening_(data, noise) {
  MatrixXd displacements = data.displacements();
  data.centre(displacements);
  for (Index k = 0; k < displacements.cols(); ++k)
    sd_ = std::max(sd_, deviation_of(displacements.col(k)));
}

std::vector<Index> CoursePool::add(const MatrixXd& columns, const std::vector<Quantity>& of) {
  std::vector<Index> places;
  for (Index k = 0; k < columns.cols(); ++k) {
    const Quantity q = of[std::min(static_cast<std::size_t>(k), of.size() - 1)];
    const double prior =
        q == Quantity::deviation_per_kelvin
            ? 0.5 * most_per_kelvin
            : most_displacements * sd_ / std::max(deviation_of(columns.col(k)), 1e-300);
    places.push_back(add_one(columns.col(k), prior));
  }
  return places;
}

Index CoursePool::add_one(const VectorXd& column, double prior) {
  const VectorXd scaled = column * prior;
  const auto key = std::pair(scaled(scaled.size() / 3), scaled(scaled.size() - 1));
  for (const Index known : places_[key])
    if (columns_[static_cast<std::size_t>(known)] == scaled) return known;
  places_[key].push_back(static_cast<Index>(columns_.size()));
  columns_.push_back(scaled);
  prior_.push_back(prior);
  return static_cast<Index>(columns_.size()) - 1;
}

void CoursePool::finish() {
  raw_.resize(data_.size(), static_cast<Index>(columns_.size()));
  for (std::size_t k = 0; k < columns_.size(); ++k) raw_.col(static_cast<Index>(k)) = columns_[k];
  columns_.clear();
  white_ = whitening_.of(raw_);
  products_ = math::transposed_product(white_, white_);
  const CourseSides sides(*this, data_.displacements());
  ridge_ = std::max(first_ridge * sides.squares.mean() / bins(), 1e-300);
  if (white_.cols() > 0)
    ridge_ = std::max(greedy({}, sides, 0, sides.squares.size()).variance, 1e-300);
}

const CoursePool::Blocks& CoursePool::blocks() const {
  if (blocks_) return *blocks_;
  blocks_.emplace();
  for (Index b = 0; b < CourseData::blocks; ++b) {
    const MatrixXd white = block_of(data_, white_, b), raw = centred_block(data_, raw_, b);
    blocks_->white.push_back(math::transposed_product(white, white));
    blocks_->centred.push_back(math::transposed_product(raw, raw));
  }
  return *blocks_;
}

double CoursePool::penalty() const {
  return std::log(std::max(1.0, static_cast<double>(white_.cols())));
}

Eigen::LLT<MatrixXd> CoursePool::normal(const std::vector<Index>& columns) const {
  const auto p = static_cast<Index>(columns.size());
  MatrixXd out(p, p);
  for (Index i = 0; i < p; ++i)
    out.col(i) = picked(products_, columns[static_cast<std::size_t>(i)], columns);
  out.diagonal().array() += ridge_;
  return Eigen::LLT<MatrixXd>(out);
}

Eigen::RowVectorXd CoursePool::cost(const std::vector<Index>& columns,
                                    const CourseSides& sides) const {
  Eigen::RowVectorXd squares = sides.squares;
  double volume = 0.0;
  const auto p = static_cast<Index>(columns.size());
  if (p > 0) {
    const Eigen::LLT<MatrixXd> llt = normal(columns);
    MatrixXd right(p, squares.size());
    for (Index k = 0; k < right.cols(); ++k) right.col(k) = picked(sides.products, k, columns);
    const MatrixXd x = math::solutions(llt, right);
    squares -= x.cwiseProduct(right).colwise().sum();
    volume = llt.matrixLLT().diagonal().array().log().sum() -
             0.5 * static_cast<double>(p) * std::log(ridge_);
  }
  return squares.cwiseMax(1e-300).array().log() * (0.5 * bins()) + volume;
}

MatrixXd CoursePool::coefficients(const std::vector<Index>& columns,
                                  const CourseSides& sides) const {
  const auto p = static_cast<Index>(columns.size());
  MatrixXd right(p, sides.products.cols());
  if (p == 0) return right;
  for (Index k = 0; k < right.cols(); ++k) right.col(k) = picked(sides.products, k, columns);
  MatrixXd x = math::solutions(normal(columns), right);
  for (Index i = 0; i < p; ++i)
    x.row(i) *= prior_[static_cast<std::size_t>(columns[static_cast<std::size_t>(i)])];
  return x;
}

double CoursePool::variance(const std::vector<Index>& columns, const CourseSides& sides) const {
  double squares = sides.squares(0);
  if (!columns.empty()) {
    const VectorXd right = picked(sides.products, 0, columns);
    squares -= right.dot(math::solution(normal(columns), right));
  }
  return std::max(squares, 0.0) / std::max(bins() - static_cast<double>(columns.size()), 1.0);
}

MatrixXd CoursePool::covariance(const std::vector<Index>& columns, double variance) const {
  const auto p = static_cast<Index>(columns.size());
  if (p == 0) return MatrixXd(0, 0);
  MatrixXd n(p, p);
  VectorXd prior(p);
  for (Index i = 0; i < p; ++i) {
    const Index at = columns[static_cast<std::size_t>(i)];
    n.col(i) = picked(products_, at, columns);
    prior(i) = prior_[static_cast<std::size_t>(at)];
  }
  n.diagonal().array() += variance;
  MatrixXd out = math::inverse(Eigen::LDLT<MatrixXd>(n));
  for (Index i = 0; i < p; ++i)
    for (Index k = 0; k < p; ++k) out(i, k) *= prior(i) * prior(k);
  return out;
}

MatrixXd CoursePool::remainder(const std::vector<Index>& columns,
                               const MatrixXd& displacements) const {
  MatrixXd out = displacements;
  if (!columns.empty()) {
    MatrixXd x = coefficients(columns, CourseSides(*this, displacements));
    for (Index i = 0; i < x.rows(); ++i)
      x.row(i) /= prior_[static_cast<std::size_t>(columns[static_cast<std::size_t>(i)])];
    out -= math::product(picked_columns(raw_, columns), x);
  }
  return out;
}

double CoursePool::left_out(const std::vector<Index>& columns, const CourseSides& sides,
                            Index side) const {
  const auto p = static_cast<Index>(columns.size());
  const Blocks& own_blocks = blocks();
  const CourseSides::Blocks& of_sides = sides.blocks(*this);
  double squares = 0.0;
  for (std::size_t b = 0; b < own_blocks.white.size(); ++b) {
    squares += of_sides.centred_squares[b](side);
    if (p == 0) continue;
    MatrixXd normal(p, p), own(p, p);
    for (Index i = 0; i < p; ++i) {
      const Index at = columns[static_cast<std::size_t>(i)];
      normal.col(i) = picked(products_, at, columns) - picked(own_blocks.white[b], at, columns);
      own.col(i) = picked(own_blocks.centred[b], at, columns);
    }
    normal.diagonal().array() += ridge_;
    const VectorXd x = math::solution(
        Eigen::LDLT<MatrixXd>(normal),
        VectorXd(picked(sides.products, side, columns) - picked(of_sides.white[b], side, columns)));
    squares += x.dot(math::times(own, x) - 2.0 * picked(of_sides.centred[b], side, columns));
  }
  return std::sqrt(std::max(squares, 1e-300) / static_cast<double>(data_.size()));
}

CoursePool::Greedy CoursePool::greedy(const std::vector<Index>& columns, const CourseSides& sides,
                                      Index from, Index count) const {
  const Index p = products_.rows();
  VectorXd left = products_.diagonal().array() + ridge_;
  MatrixXd right = sides.products.middleCols(from, count);
  Eigen::RowVectorXd squares = sides.squares.segment(from, count);
  MatrixXd swept(p, static_cast<Index>(columns.size() + most_columns));
  Index steps = 0;
  std::vector<char> used(static_cast<std::size_t>(p), 0);
  const auto take = [&](Index e) {
    const double root = std::sqrt(left(e));
    VectorXd w = products_.col(e);
    w(e) += ridge_;
    for (Index k = 0; k < steps; ++k) w -= swept.col(k) * swept(e, k);
    w /= root;
    for (Index j = 0; j < count; ++j) {
      const double t = right(e, j) / root;
      squares(j) -= t * t;
      right.col(j) -= w * t;
    }
    left -= w.cwiseAbs2();
    swept.col(steps++) = w;
    used[static_cast<std::size_t>(e)] = 1;
  };
  for (const Index e : columns)
    if (used[static_cast<std::size_t>(e)] == 0) take(e);
  Greedy out;
  double sum = 0.0;
  for (std::size_t step = 0; step < most_columns; ++step) {
    double least = std::numeric_limits<double>::infinity();
    Index best = -1;
    for (Index e = 0; e < p; ++e) {
      if (used[static_cast<std::size_t>(e)] != 0 || !(left(e) > 0.5 * ridge_)) continue;
      double change = 0.5 * std::log(left(e) / ridge_);
      for (Index j = 0; j < count; ++j)
        change +=
            0.5 * bins() / static_cast<double>(count) *
            std::log(std::max(
                1.0 - right(e, j) * right(e, j) / left(e) / std::max(squares(j), 1e-300), 1e-12));
      if (change < least) least = change, best = e;
    }
    if (best < 0) break;
    take(best);
    out.added.push_back(best);
    sum -= least + penalty();
    out.gain = std::max(out.gain, sum);
  }
  out.variance = squares.cwiseMax(0.0).mean() / bins();
  return out;
}

CourseSides::CourseSides(const CoursePool& pool, MatrixXd displacements)
    : displacements_(std::move(displacements)), white_(pool.whitening().of(displacements_)) {
  products = math::transposed_product(pool.white(), white_);
  squares = white_.colwise().squaredNorm();
}

const CourseSides::Blocks& CourseSides::blocks(const CoursePool& pool) const {
  if (blocks_) return *blocks_;
  blocks_.emplace();
  const CourseData& data = pool.data();
  for (Index b = 0; b < CourseData::blocks; ++b) {
    const MatrixXd rows = centred_block(data, displacements_, b);
    blocks_->white.push_back(
        math::transposed_product(block_of(data, pool.white(), b), block_of(data, white_, b)));
    blocks_->centred.push_back(math::transposed_product(centred_block(data, pool.raw(), b), rows));
    blocks_->centred_squares.push_back(rows.colwise().squaredNorm());
  }
  return *blocks_;
}

}  // namespace nonio::model
