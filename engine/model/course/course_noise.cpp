// SPDX-License-Identifier: Apache-2.0
#include "course_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "course_pool.h"

namespace nonio::model {

CourseNoise noise_of_fit(const CourseData& data) {
  // Duration of the test over the correlation time; docs/dev/constants.md, M40.
  constexpr double part_of_test = 24.0;
  return {data.duration() / part_of_test};
}

CourseWhitening::CourseWhitening(const CourseData& data, const CourseNoise& noise) {
  const Index n = data.size();
  double variance = 1.0;
  for (Index i = 0; i < n; ++i) {
    const double of_bin = variance + noise.scatter;
    scale_.push_back(1.0 / std::sqrt(of_bin));
    gain_.push_back(variance / of_bin);
    half_log_determinant_ += 0.5 * std::log(of_bin);
    const double step = i + 1 < n ? data.time(i + 1) - data.time(i) : 0.0;
    const bool follows = noise.correlation_time > 0.0 && !data.begins_line(i + 1);
    follows_.push_back(follows ? std::exp(-step / noise.correlation_time) : 0.0);
    const double keeps = follows_.back() * follows_.back();
    variance = keeps * variance * (1.0 - gain_.back()) + 1.0 - keeps;
  }
  MatrixXd one = MatrixXd::Ones(n, 1);
  filter(one);
  zeros_ = one.col(0);
  lines_ = data.lines();
  lines_.push_back(n);
  for (std::size_t s = 0; s + 1 < lines_.size(); ++s) {
    auto own = zeros_.segment(lines_[s], lines_[s + 1] - lines_[s]);
    const double length = std::max(own.norm(), 1e-300);
    own /= length;
    variance_of_zero_ = 1.0 / std::max(length * length, 1e-300);
    half_log_determinant_ += std::log(length);
  }
}

void CourseWhitening::filter(MatrixXd& columns) const {
  for (Index k = 0; k < columns.cols(); ++k) {
    double expected = 0.0;
    for (Index i = 0; i < columns.rows(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      const double surprise = columns(i, k) - expected;
      expected = follows_[at] * (expected + gain_[at] * surprise);
      columns(i, k) = surprise * scale_[at];
    }
  }
}

MatrixXd CourseWhitening::of(MatrixXd columns) const {
  filter(columns);
  for (std::size_t s = 0; s + 1 < lines_.size(); ++s) {
    const auto zero = zeros_.segment(lines_[s], lines_[s + 1] - lines_[s]);
    for (Index k = 0; k < columns.cols(); ++k) {
      auto own = columns.col(k).segment(lines_[s], zero.size());
      own -= zero * zero.dot(own);
    }
  }
  return columns;
}

namespace {

/// The correlation time is the duration of the test divided by `part_of_test`.
template <class Visit>
void for_each_noise(const CourseData& data, const CourseModel& model, const MatrixXd& displacements,
                    const Visit& visit) {
  for (const double part_of_test : {96.0, 24.0, 6.0, 1.5})
    for (const double scatter : CoursePool::scatters) {
      const CourseNoise noise{data.duration() / part_of_test, scatter};
      CoursePool pool(data, noise);
      const std::vector<Index> at = pool.add(model.columns, model.of);
      pool.finish();
      const CourseSides sides(pool, displacements);
      visit(pool, at, sides, noise,
            pool.cost(at, sides).mean() + pool.whitening().half_log_determinant());
    }
}

}  // namespace

void CourseModel::add(const MatrixXd& more, const std::vector<Quantity>& quantities) {
  for (Index k = 0; k < more.cols(); ++k) {
    columns = columns.size() == 0 ? MatrixXd(more.col(k))
                                  : math::with_column(columns, VectorXd(more.col(k)));
    of.push_back(quantities[std::min(static_cast<std::size_t>(k), quantities.size() - 1)]);
  }
}

double most_likely_scatter(const CourseData& data, const CourseNoise& noise,
                           const CourseModel& model) {
  double best = 0.0, least = std::numeric_limits<double>::infinity();
  for (const double scatter : CoursePool::scatters) {
    CoursePool pool(data, {noise.correlation_time, scatter});
    const std::vector<Index> at = pool.add(model.columns, model.of);
    pool.finish();
    const double cost = pool.cost(at, CourseSides(pool, data.displacements())).mean() +
                        pool.whitening().half_log_determinant();
    if (cost < least) least = cost, best = scatter;
  }
  return best;
}

double likely_cost(const CourseData& data, const CourseModel& model) {
  double least = std::numeric_limits<double>::infinity();
  for_each_noise(data, model, data.displacements(),
                 [&](const CoursePool&, const std::vector<Index>&, const CourseSides&,
                     const CourseNoise&, double cost) { least = std::min(least, cost); });
  return least;
}

CourseUncertainty uncertainty_of(const CourseData& data, const CourseModel& model) {
  CourseUncertainty out;
  double least = std::numeric_limits<double>::infinity();
  for_each_noise(data, model, data.displacements().leftCols(1),
                 [&](const CoursePool& pool, const std::vector<Index>& at, const CourseSides& sides,
                     const CourseNoise& noise, double cost) {
                   if (out.s > 0.0 && !(cost < least)) return;
                   least = cost;
                   const double variance = pool.variance(at, sides);
                   out.covariance = variance * pool.covariance(at, variance);
                   out.s = std::sqrt(variance * (1.0 + noise.scatter));
                   out.correlated = std::sqrt(variance);
                   out.correlation_time = noise.correlation_time;
                   out.zero = std::sqrt(variance * pool.whitening().variance_of_zero());
                 });
  return out;
}

}  // namespace nonio::model
