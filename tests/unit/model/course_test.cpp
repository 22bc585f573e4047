// SPDX-License-Identifier: Apache-2.0
// Noise that is correlated in time, against its covariance written out.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "course/course_pool.h"

namespace nonio::model::course_test {

namespace {

using Eigen::Index;

struct Random {
  unsigned seed = std::random_device{}();
  std::mt19937 of{seed};
  double normal() { return std::normal_distribution<>()(of); }
  double uniform() { return std::uniform_real_distribution<>()(of); }
};

/// A course of as many readings as bins, at uneven times.
Part part_of(Random& random, std::size_t n) {
  Part part;
  part.kind = Part::Kind::course;
  double t = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    part.table.time.push_back(t += 5.0 + 50.0 * random.uniform());
    part.table.deviation.push_back(1e-6 * random.normal());
  }
  return part;
}

MatrixXd columns_of(Random& random, Index n, Index count) {
  MatrixXd out(n, count);
  for (Index k = 0; k < count; ++k)
    for (Index i = 0; i < n; ++i) out(i, k) = random.normal();
  return out;
}

MatrixXd covariance_of(const CourseData& data, const CourseNoise& noise) {
  MatrixXd out(data.size(), data.size());
  for (Index i = 0; i < out.rows(); ++i)
    for (Index k = 0; k < out.cols(); ++k)
      out(i, k) = std::exp(-std::fabs(data.time(i) - data.time(k)) / noise.correlation_time) +
                  (i == k ? noise.scatter : 0.0);
  return out;
}

TEST(course_noise, whitens_as_the_inverse_of_its_covariance_without_a_zero) {
  Random random;
  SCOPED_TRACE("seed " + std::to_string(random.seed));
  const Part part = part_of(random, 61);
  const CourseData data(part);
  const MatrixXd x = columns_of(random, data.size(), 3);
  for (const CourseNoise noise : {CourseNoise{200.0, 0.0}, CourseNoise{900.0, 2.0}}) {
    const CourseWhitening whitening(data, noise);
    const MatrixXd inverse = covariance_of(data, noise).inverse();
    const VectorXd one = VectorXd::Ones(data.size());
    const double weight = one.dot(inverse * one);
    const MatrixXd without_zero = inverse - (inverse * one) * (one.transpose() * inverse) / weight;
    const MatrixXd expected = x.transpose() * without_zero * x;
    const MatrixXd white = whitening.of(x);
    EXPECT_LT((white.transpose() * white - expected).norm(), 1e-9 * expected.norm());
    EXPECT_NEAR(whitening.variance_of_zero(), 1.0 / weight, 1e-12);
    const double determinant = covariance_of(data, noise).ldlt().vectorD().array().log().sum();
    EXPECT_NEAR(whitening.half_log_determinant(), 0.5 * (determinant + std::log(weight)), 1e-9);
  }
}

TEST(course_noise, lines_are_independent_and_have_zeros) {
  Random random;
  SCOPED_TRACE("seed " + std::to_string(random.seed));
  Part part = part_of(random, 61);
  part.table.line.assign(61, 0);
  for (std::size_t i = 23; i < 61; ++i) part.table.line[i] = i < 40 ? 1 : 2;
  const CourseData data(part);
  ASSERT_EQ(data.lines(), (std::vector<Index>{0, 23, 40}));
  const MatrixXd x = columns_of(random, data.size(), 3);
  const CourseNoise noise{300.0, 0.5};
  MatrixXd covariance = covariance_of(data, noise), zeros = MatrixXd::Zero(data.size(), 3);
  for (Index i = 0; i < data.size(); ++i) {
    zeros(i, static_cast<Index>(part.table.line[static_cast<std::size_t>(i)])) = 1.0;
    for (Index k = 0; k < data.size(); ++k)
      for (const Index begin : data.lines())
        if ((i < begin) != (k < begin)) covariance(i, k) = 0.0;
  }
  const MatrixXd inverse = covariance.inverse();
  const MatrixXd weight = zeros.transpose() * inverse * zeros;
  const MatrixXd expected =
      x.transpose() * (inverse - inverse * zeros * weight.inverse() * zeros.transpose() * inverse) *
      x;
  const CourseWhitening whitening(data, noise);
  const MatrixXd white = whitening.of(x);
  EXPECT_LT((white.transpose() * white - expected).norm(), 1e-9 * expected.norm());
  EXPECT_NEAR(whitening.variance_of_zero(), 1.0 / weight(2, 2), 1e-12);
  const double determinants =
      covariance.ldlt().vectorD().array().log().sum() + weight.diagonal().array().log().sum();
  EXPECT_NEAR(whitening.half_log_determinant(), 0.5 * determinants, 1e-9);
}

TEST(course_data, bins_begin_at_restarts) {
  Random random;
  SCOPED_TRACE("seed " + std::to_string(random.seed));
  Part part = part_of(random, 5000);
  part.table.line.assign(5000, 0);
  std::vector<std::size_t> begins;
  for (int k = 0; k < 6; ++k)
    begins.push_back(1 + static_cast<std::size_t>(4998 * random.uniform()));
  std::sort(begins.begin(), begins.end());
  for (const std::size_t begin : begins)
    for (std::size_t i = begin; i < 5000; ++i) ++part.table.line[i];
  const CourseData data(part);
  // A bin with readings of two lines would have a mean between two integers.
  const VectorXd line =
      data.means(std::vector<double>(part.table.line.begin(), part.table.line.end()));
  for (Index b = 0; b < data.size(); ++b) {
    EXPECT_EQ(line(b), std::round(line(b))) << b;
    EXPECT_EQ(data.begins_line(b), b == 0 || line(b) != line(b - 1)) << b;
  }
  Index rest = data.size() - 1;
  for (const Index factor : {2, 3, 5})
    while (rest % factor == 0) rest /= factor;
  EXPECT_EQ(rest, 1);
}

TEST(course_pool, evidence_is_the_integral_over_gains_and_variance) {
  Random random;
  SCOPED_TRACE("seed " + std::to_string(random.seed));
  const Part part = part_of(random, 41);
  const CourseData data(part);
  CoursePool pool(data, {300.0, 0.5});
  const std::vector<Index> at =
      pool.add(columns_of(random, data.size(), 4), {Quantity::deviation_per_kelvin});
  pool.finish();
  const CourseSides sides(pool, data.displacements());
  const double both = pool.cost({at[0], at[2]}, sides)(0);
  EXPECT_NEAR(pool.cost({at[2], at[0]}, sides)(0), both, 1e-9);
  // Student: p(y) is proportional to |K|^-1/2 (y' K^-1 y)^(-n/2) with K = I + X X'/ridge.
  const MatrixXd& x = pool.white();
  const VectorXd y = pool.whitening().of(data.displacements());
  const double n = static_cast<double>(data.size() - 1);
  const auto direct = [&](const std::vector<Index>& columns, double ridge) {
    MatrixXd k = MatrixXd::Identity(data.size(), data.size());
    for (const Index c : columns) k += x.col(c) * x.col(c).transpose() / ridge;
    return 0.5 * k.ldlt().vectorD().array().log().sum() +
           0.5 * n * std::log(y.dot(k.ldlt().solve(y)));
  };
  const double ridge = pool.ridge();
  EXPECT_NEAR(pool.cost({at[0]}, sides)(0), direct({at[0]}, ridge), 1e-6);
  EXPECT_NEAR(both, direct({at[0], at[2]}, ridge), 1e-6);
  EXPECT_NEAR(pool.cost({}, sides)(0), direct({}, ridge), 1e-6);
}

TEST(course_pool, leaves_blocks_out_as_a_fit_without_their_rows) {
  Random random;
  SCOPED_TRACE("seed " + std::to_string(random.seed));
  const Part part = part_of(random, 61);
  const CourseData data(part);
  CoursePool pool(data, {300.0, 0.0});
  const MatrixXd x = columns_of(random, data.size(), 2) * 1e3;
  const std::vector<Index> at = pool.add(x, {Quantity::deviation});
  pool.finish();
  const MatrixXd white = pool.white();
  const VectorXd y = data.displacements().col(0), right = pool.whitening().of(data.displacements());
  double squares = 0.0;
  for (Index b = 0; b < CourseData::blocks; ++b) {
    MatrixXd normal = MatrixXd::Identity(2, 2) * pool.ridge();
    VectorXd side = VectorXd::Zero(2);
    for (Index i = 0; i < data.size(); ++i) {
      if (i >= data.begin_of(b) && i < data.begin_of(b + 1)) continue;
      normal += white.row(i).transpose() * white.row(i);
      side += white.row(i).transpose() * right(i);
    }
    const VectorXd error = y - pool.raw() * normal.ldlt().solve(side);
    const VectorXd own = error.segment(data.begin_of(b), data.begin_of(b + 1) - data.begin_of(b));
    squares += (own.array() - own.mean()).square().sum();
  }
  EXPECT_NEAR(pool.left_out(at, CourseSides(pool, data.displacements()), 0),
              std::sqrt(squares / static_cast<double>(data.size())), 1e-15);
}

}  // namespace

}  // namespace nonio::model::course_test
