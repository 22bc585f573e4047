// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/before_after.h"

#include <algorithm>
#include <cmath>

#include "dense.h"
#include "nonio/math/distributions.h"

namespace nonio::math {

namespace {

constexpr double table_level = 0.01;
/// Share of the errors that an effective table does not leave: docs/dev/constants.md, A30.
constexpr double half = 0.5;

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

/// Rows: weighted sum of both lines at each stop, minus that at the first stop.
std::vector<std::vector<double>> contrasts(std::size_t n, double before, double after) {
  std::vector<std::vector<double>> J;
  for (std::size_t i = 1; i < n; ++i) {
    std::vector<double>& row = J.emplace_back(2 * n, 0.0);
    row[i] = before, row[0] = -before;
    row[n + i] = after, row[n] = -after;
  }
  return J;
}

/// Returns W of before_after.h.
Eigen::MatrixXd covariance_of_table(std::span<const double> means, const std::vector<double>& place,
                                    double entry_step) {
  const std::size_t n = means.size(), m = n - 1;
  double h = INFINITY;
  for (std::size_t i = 0; i < m; ++i) h = std::min(h, place[i + 1] - place[i]);
  const auto slope = [&](std::size_t i) {
    return (means[i + 1] - means[i]) / (place[i + 1] - place[i]);
  };
  std::vector<double> corner(n);
  for (std::size_t i = 0; i < n; ++i)
    corner[i] = ((i < m ? slope(i) : 0.0) - (i > 0 ? slope(i - 1) : 0.0)) * h / 4.0;
  const auto own = [&](std::size_t i) {
    return corner[i] * corner[i] / 3.0 + entry_step * entry_step / 12.0;
  };
  Eigen::MatrixXd W(at(m), at(m));
  for (std::size_t a = 0; a < m; ++a)
    for (std::size_t b = 0; b < m; ++b)
      W(at(a), at(b)) = own(0) + (a == b ? own(a + 1) : 0.0) +
                        (corner[a + 1] - corner[0]) * (corner[b + 1] - corner[0]) / 3.0;
  return W;
}

}  // namespace

BeforeAfter before_after(std::span<const double> before, std::span<const double> after,
                         const ReadingModel& model, double dof, double entry_step) {
  const std::size_t n = before.size(), m = n - 1;
  Eigen::VectorXd b(at(m)), a(at(m));
  for (std::size_t i = 1; i < n; ++i) {
    b[at(i - 1)] = before[i] - before[0];
    a[at(i - 1)] = after[i] - after[0];
  }
  BeforeAfter out;
  const Eigen::MatrixXd V = covariance_of(contrasts(n, -1.0, 1.0), model),
                        W = covariance_of_table(before, model.lines.front().length, entry_step);
  const double freedom = static_cast<double>(m);
  const auto p_of = [&](double k, const Eigen::MatrixXd& covariance) {
    const Eigen::VectorXd r = a - k * b;
    const double chi2 = r.dot(solution(Eigen::LDLT<Eigen::MatrixXd>(covariance), r));
    return f_upper(chi2 / freedom, freedom, std::min(dof, 1e6));
  };
  const Eigen::MatrixXd of_other_readings =
      covariance_of(contrasts(n, -2.0, 1.0), model) + covariance_of(contrasts(n, 1.0, 0.0), model);
  out.p = {p_of(0.0, V + W), p_of(1.0, V),
           std::max(p_of(2.0, V + W), p_of(2.0, of_other_readings + W))};
  out.predicted.assign(n, 0.0);
  out.rest.push_back(0.0), out.u.push_back(0.0);
  for (std::size_t i = 0; i < m; ++i) {
    out.rest.push_back(a[at(i)]);
    out.u.push_back(std::sqrt(V(at(i), at(i)) + W(at(i), at(i))));
  }
  for (std::size_t i = 1; i < n; ++i)
    if (out.worst == 0 ||
        std::fabs(out.rest[i]) * out.u[out.worst] > std::fabs(out.rest[out.worst]) * out.u[i])
      out.worst = i;
  const auto fits = [&](std::size_t k) { return !significant(out.p[k], table_level); };
  const Eigen::VectorXd weighted =
      solution(Eigen::LDLT<Eigen::MatrixXd>(fits(0) ? Eigen::MatrixXd(V + W) : V), b);
  out.f = weighted.dot(a) / weighted.dot(b);
  out.u_f = 1.0 / std::sqrt(weighted.dot(b));
  const int fitting = fits(0) + fits(1) + fits(2);
  using Answer = BeforeAfter::Answer;
  out.answer = fitting > 1    ? Answer::cannot_tell
               : fitting == 0 ? Answer::something_else
               : fits(0)      ? (out.f + 2.0 * out.u_f > half ? Answer::half_left : Answer::worked)
               : fits(1)      ? Answer::not_active
                              : Answer::wrong_sign;
  return out;
}

}  // namespace nonio::math
