// SPDX-License-Identifier: Apache-2.0
#include "target_fit.h"

#include <algorithm>
#include <cmath>

#include "common/constants.h"

namespace nonio::math {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

/// Above a cubic, the degree is less than half of the number of targets, so that the residuals show
/// the variation between targets and the ends do not depend on few targets.
constexpr std::size_t most_degree = 7, fewest_for_cubic = 5, fewest_for_cubic_reversal = 11;
constexpr std::size_t least_rest = 3;

bool has_both(const AxisTest& test, std::size_t i) {
  return !test.plus(i).empty() && !test.minus(i).empty();
}

double share(const AxisTest& test, std::size_t i) { return has_both(test, i) ? 0.5 : 1.0; }

/// Weights of the readings in sum t_i m_i, or with `reversal` in sum t_i B_i (followed.h).
TargetWeights spread_over(const AxisTest& test, const VectorXd& t, bool reversal) {
  TargetWeights out(2 * test.targets.size(), 0.0);
  for (std::size_t i = 0; i < test.targets.size(); ++i)
    for (const bool minus : {false, true}) {
      const auto part = minus ? test.minus(i) : test.plus(i);
      if (part.empty() || (reversal && !has_both(test, i))) continue;
      const double sign = reversal ? (minus ? -1.0 : 1.0) : share(test, i);
      out[2 * i + (minus ? 1 : 0)] = sign * t(at(i)) / static_cast<double>(part.size());
    }
  return out;
}

double variance_at(const AxisTest& test, const RunComponents& c, std::size_t i, bool reversal) {
  double sum = 0.0;
  for (const bool minus : {false, true})
    if (const auto part = minus ? test.minus(i) : test.plus(i); !part.empty())
      sum += c.reading[minus ? 1 : 0] / static_cast<double>(part.size());
  return reversal ? sum : sum * share(test, i) * share(test, i);
}

/// The first `polynomial` columns of X are the polynomial, the others are sinusoids. For B_i,
/// targets approached from one direction are omitted.
TargetFit fit_columns(const AxisTest& test, const RunComponents& c, const MatrixXd& X,
                      Index polynomial, bool reversal) {
  std::vector<std::size_t> seen;
  for (std::size_t i = 0; i < test.targets.size(); ++i)
    if (!reversal || has_both(test, i)) seen.push_back(i);
  const auto n = at(seen.size());
  const Index kept = test.rotary ? 0 : polynomial;  // a rotary axis has no coefficients
  if (n < X.cols()) return {};
  MatrixXd own(n, X.cols());
  VectorXd y(n);
  for (Index k = 0; k < n; ++k) {
    const std::size_t i = seen[static_cast<std::size_t>(k)];
    own.row(k) = X.row(at(i));
    double plus = 0.0, minus = 0.0;
    for (const AxisTest::Reading& r : test.plus(i)) plus += r.deviation;
    for (const AxisTest::Reading& r : test.minus(i)) minus += r.deviation;
    if (!test.plus(i).empty()) plus /= static_cast<double>(test.plus(i).size());
    if (!test.minus(i).empty()) minus /= static_cast<double>(test.minus(i).size());
    y(k) = reversal ? plus - minus : (plus + minus) * share(test, i);
  }
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(own);
  if (qr.rank() < own.cols()) return {};
  const MatrixXd rows = fit_rows(own);  // coefficients x targets
  TargetFit out;
  out.dof = static_cast<double>(n - own.cols());
  const VectorXd rest = residual(y, own, times(rows, y));
  out.residuals.assign(rest.begin(), rest.end());
  double noise = 0.0;
  for (Index k = 0; k < n; ++k)
    noise += variance_at(test, c, seen[static_cast<std::size_t>(k)], reversal) *
             (1.0 - own.row(k).dot(rows.col(k)));
  if (out.dof > 0.0) out.beyond = (rest.squaredNorm() - noise) / out.dof;
  const VectorXd b = times(rows, y);
  const auto weights_of = [&](Index j) {
    VectorXd t = VectorXd::Zero(at(test.targets.size()));
    for (Index k = 0; k < n; ++k) t(at(seen[static_cast<std::size_t>(k)])) = rows(j, k);
    return spread_over(test, t, reversal);
  };
  std::vector<TargetWeights> weights;
  for (Index j = 0; j < kept; ++j) {
    out.coefficients.push_back(b(j));
    weights.push_back(weights_of(j));
    for (Index i = 0; i < kept; ++i) out.share.push_back(rows.row(i).dot(rows.row(j)));
  }
  out.covariance = covariance_of(test, c, weights);
  for (Index j = polynomial; j < own.cols(); ++j)
    out.sinusoids.push_back(
        {b(j), covariance_of(test, c, {weights_of(j)}).front(), rows.row(j).squaredNorm()});
  return out;
}

std::size_t degree_for(std::size_t targets, std::size_t others) {
  if (targets < fewest_for_cubic) return 1;
  std::size_t degree = std::clamp((targets - 1) / 2, std::size_t{3}, most_degree);
  while (degree > 3 && degree + 1 + others + least_rest > targets) --degree;
  return degree;
}

}  // namespace

MatrixXd legendre_columns(const AxisTest& test, int columns) {
  MatrixXd X(at(test.targets.size()), columns);
  const double middle = (test.targets.front() + test.targets.back()) / 2.0;
  for (Index i = 0; i < X.rows(); ++i) {
    const double z = 2.0 * (test.targets[static_cast<std::size_t>(i)] - middle) / test.length();
    for (int k = 0; k < columns; ++k)
      X(i, k) = k == 0   ? 1.0
                : k == 1 ? z
                         : ((2 * k - 1) * z * X(i, k - 1) - (k - 1) * X(i, k - 2)) / k;
  }
  return X;
}

MatrixXd with_sinusoid(const MatrixXd& others, const AxisTest& test, double period) {
  MatrixXd X(others.rows(), others.cols() + 2);
  X.leftCols(others.cols()) = others;
  for (Index i = 0; i < X.rows(); ++i) {
    const double phase = full_turn * test.targets[static_cast<std::size_t>(i)] / period;
    X(i, others.cols()) = std::cos(phase), X(i, others.cols() + 1) = std::sin(phase);
  }
  return X;
}

MatrixXd fit_rows(const MatrixXd& X) {
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(X);
  const MatrixXd Q = orthonormal(qr, X.cols());
  const MatrixXd R = qr.matrixR().topRows(X.cols());
  return qr.colsPermutation() * solutions_of_upper(R, Q.transpose());
}

TargetWeights of_means(const AxisTest& test, const VectorXd& t) {
  return spread_over(test, t, false);
}

TargetWeights of_reversal(const AxisTest& test) {
  double both = 0.0;
  for (std::size_t i = 0; i < test.targets.size(); ++i)
    if (has_both(test, i)) both += 1.0;
  return spread_over(test, VectorXd::Constant(at(test.targets.size()), 1.0 / both), true);
}

double share_of_targets(const AxisTest& test, const TargetWeights& weights, bool reversal) {
  double sum = 0.0;
  for (std::size_t i = 0; i < test.targets.size(); ++i) {
    const double plus = weights[2 * i] * static_cast<double>(test.plus(i).size()),
                 minus = weights[2 * i + 1] * static_cast<double>(test.minus(i).size());
    const double t = reversal ? plus : plus + minus;
    sum += t * t;
  }
  return sum;
}

TargetFit fit_means(const AxisTest& test, const RunComponents& c,
                    const std::vector<double>& periods) {
  const bool turn = std::find(periods.begin(), periods.end(), full_turn) != periods.end();
  const std::size_t degree = turn ? 0 : degree_for(test.targets.size(), 2 * periods.size());
  const int polynomial = static_cast<int>(degree) + 1;
  MatrixXd X = legendre_columns(test, polynomial);
  for (const double period : periods) X = with_sinusoid(X, test, period);
  return fit_columns(test, c, X, polynomial, false);
}

TargetFit fit_reversal(const AxisTest& test, const RunComponents& c) {
  const int columns = test.rotary ? 1 : (test.targets.size() < fewest_for_cubic_reversal ? 2 : 4);
  return fit_columns(test, c, legendre_columns(test, columns), columns, true);
}

}  // namespace nonio::math
