// SPDX-License-Identifier: Apache-2.0
#include "harmonic.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/constants.h"
#include "dense.h"
#include "nonio/math/distributions.h"
#include "nonio/math/statistics.h"

namespace nonio::math {
namespace {

bool covers_the_turn(std::span<const double> angle) {
  std::vector<double> a;
  for (const double x : angle) a.push_back(x - full_turn * std::floor(x / full_turn));
  std::sort(a.begin(), a.end());
  constexpr double same = 1e-9;  // rad; 0 and 360 deg are the same angle
  std::size_t different = 0;
  double gap = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double next = i + 1 < a.size() ? a[i + 1] : a[0] + full_turn;
    gap = std::max(gap, next - a[i]);
    if (next - a[i] > same) ++different;
  }
  return different >= 5 && gap <= full_turn / 3.0 + same;
}

}  // namespace

Harmonic fit_harmonic(std::span<const double> angle, std::span<const double> y) {
  Harmonic h;
  if (angle.size() != y.size() || !covers_the_turn(angle)) return h;
  const auto rows = static_cast<Eigen::Index>(y.size());
  const double y_mean = mean(y);
  Eigen::MatrixXd design(rows, 3);
  Eigen::VectorXd right(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double a = angle[static_cast<std::size_t>(i)];
    design.row(i) << 1.0, std::cos(a), std::sin(a);
    right(i) = y[static_cast<std::size_t>(i)] - y_mean;
  }
  const Eigen::Vector3d fit = least_squares(design, right);
  const double left = (right - design * fit).squaredNorm();
  const double all = right.squaredNorm();
  if (!std::isfinite(left) || !std::isfinite(all)) return h;
  h.known = true;
  h.amplitude = std::hypot(fit(1), fit(2));
  h.share = all > 0.0 ? 1.0 - left / all : 0.0;
  const double dof = static_cast<double>(rows) - 3.0;
  h.p = f_upper(test_ratio((all - left) / 2.0, left / dof), 2.0, dof);
  return h;
}

}  // namespace nonio::math
