// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/before_after.h"

#include <algorithm>
#include <cmath>

#include "dense.h"
#include "nonio/math/distributions.h"

namespace nonio::math {

namespace {

constexpr double table_level = 0.01;

/// Covariance of contrasts of the readings: rows of J.
Eigen::MatrixXd covariance_of(const std::vector<std::vector<double>>& J,
                              const ReadingModel& model) {
  const auto variance = [&](const std::vector<double>& row) {
    double sum = 0.0;
    std::size_t next = 0;
    for (const BudgetLine& line : model.lines)
      for (std::size_t i = 0; i < line.length.size(); ++i, ++next)
        if (i > 0 || !line.zeroed) sum += std::pow(row[next] * line.u, 2);
    for (const double u : model.shares(row).u) sum += u * u;
    return sum;
  };
  const std::size_t m = J.size();
  Eigen::MatrixXd V(at(m), at(m));
  std::vector<double> own(m);
  for (std::size_t a = 0; a < m; ++a) V(at(a), at(a)) = own[a] = variance(J[a]);
  for (std::size_t a = 0; a < m; ++a)
    for (std::size_t b = 0; b < a; ++b) {
      std::vector<double> sum = J[a];
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += J[b][i];
      V(at(a), at(b)) = V(at(b), at(a)) = (variance(sum) - own[a] - own[b]) / 2.0;
    }
  return V;
}

/// Contrasts to the first stop of after - before.
std::vector<std::vector<double>> contrasts(std::size_t n) {
  std::vector<std::vector<double>> J;
  for (std::size_t i = 1; i < n; ++i) {
    std::vector<double>& row = J.emplace_back(2 * n, 0.0);
    row[i] = -1.0, row[0] = 1.0;
    row[n + i] = 1.0, row[n] = -1.0;
  }
  return J;
}

}  // namespace

BeforeAfter before_after(std::span<const double> before, std::span<const double> after,
                         const ReadingModel& model, double dof) {
  const std::size_t n = before.size(), m = n - 1;
  Eigen::VectorXd b(at(m)), a(at(m));
  for (std::size_t i = 1; i < n; ++i) {
    b[at(i - 1)] = before[i] - before[0];
    a[at(i - 1)] = after[i] - after[0];
  }
  BeforeAfter out;
  const Eigen::MatrixXd V = covariance_of(contrasts(n), model);
  const Eigen::LDLT<Eigen::MatrixXd> inverse(V);
  const double freedom = static_cast<double>(m);
  for (std::size_t k = 0; k < out.p.size(); ++k) {
    const Eigen::VectorXd r = a - static_cast<double>(k) * b;
    const double chi2 = r.dot(inverse.solve(r));
    out.p[k] = f_upper(chi2 / freedom, freedom, std::min(dof, 1e6));
    if (k > 0) continue;
    out.predicted.assign(n, 0.0);
    out.rest.push_back(0.0), out.u.push_back(0.0);
    for (std::size_t i = 0; i < m; ++i) {
      out.rest.push_back(r[at(i)]);
      out.u.push_back(std::sqrt(V(at(i), at(i))));
    }
    for (std::size_t i = 1; i < n; ++i)
      if (out.worst == 0 ||
          std::fabs(out.rest[i]) * out.u[out.worst] > std::fabs(out.rest[out.worst]) * out.u[i])
        out.worst = i;
  }
  const Eigen::VectorXd weighted = inverse.solve(b);
  out.f = weighted.dot(a) / weighted.dot(b);
  out.u_f = 1.0 / std::sqrt(weighted.dot(b));
  const auto fits = [&](std::size_t k) { return !significant(out.p[k], table_level); };
  const int fitting = fits(0) + fits(1) + fits(2);
  using Answer = BeforeAfter::Answer;
  out.answer = fitting > 1    ? Answer::cannot_tell
               : fitting == 0 ? Answer::something_else
               : fits(0)      ? Answer::worked
               : fits(1)      ? Answer::not_active
                              : Answer::wrong_sign;
  return out;
}

}  // namespace nonio::math
