// SPDX-License-Identifier: Apache-2.0
#include "step_estimate.h"

#include <algorithm>
#include <cmath>

namespace nonio::math {
namespace {

using Index = Eigen::Index;

/// Subtracts a line from n + 1 values of which the first is 0; applies to the other n.
Eigen::MatrixXd without_line(std::size_t n, const Eigen::RowVectorXd& slope, bool centred) {
  const Index m = at(n) + 1;
  const Eigen::VectorXd i = Eigen::VectorXd::LinSpaced(m, 0.0, static_cast<double>(n));
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(m, m - 1);
  P.bottomRows(m - 1).setIdentity();
  if (centred) {
    P.array() -= 1.0 / static_cast<double>(m);
    P -= (i.array() - i.mean()).matrix() * slope;
  } else {
    P -= i * slope;
  }
  return P;
}

/// Returns the least-squares slope, per position, as a row for the values at 1..n.
Eigen::RowVectorXd line_slope(std::size_t n) {
  const Index m = at(n) + 1;
  const Eigen::VectorXd i = Eigen::VectorXd::LinSpaced(m, 0.0, static_cast<double>(n));
  const Eigen::VectorXd c = i.array() - i.mean();
  return (c / c.squaredNorm()).tail(m - 1).transpose();
}

Eigen::RowVectorXd end_slope(std::size_t n) {
  Eigen::RowVectorXd s = Eigen::RowVectorXd::Zero(at(n));
  s[at(n) - 1] = 1.0 / static_cast<double>(n);
  return s;
}

double root(double variance) { return std::sqrt(std::max(variance, 0.0)); }

Shares shares_of(const Sensitivity& s, const Eigen::RowVectorXd& J) {
  return s.model->shares({J.data(), static_cast<std::size_t>(J.size())});
}

StepCurve curve(const StepDiagonals& d, std::size_t axis, std::size_t along,
                const Eigen::VectorXd& x, const Eigen::MatrixXd& C, const Sensitivity& s,
                bool known) {
  StepCurve c;
  c.name = std::string("E") + "XYZ"[along] + "XYZ"[axis];
  c.axis = axis;
  c.known = known;
  Eigen::MatrixXd P = without_line(d.n, line_slope(d.n), true);
  if (axis == along)
    P = without_line(d.n, known ? Eigen::RowVectorXd::Zero(at(d.n)).eval() : end_slope(d.n), false);
  const Eigen::VectorXd value = P * x;
  const Eigen::MatrixXd PC = P * C;
  for (std::size_t i = 0; i <= d.n; ++i) {
    c.position.push_back(d.position(axis, i));
    c.value.push_back(value[at(i)]);
    c.u.push_back(root(PC.row(at(i)).dot(P.row(at(i)))));
  }
  if (s.model == nullptr) return c;
  const Eigen::MatrixXd J =
      P * s.of_readings.middleRows(at(function_column(axis, along, 1, d.n)), at(d.n));
  for (std::size_t i = 0; i <= d.n; ++i) c.shares.push_back(shares_of(s, J.row(at(i))));
  return c;
}

/// Returns sign (slope E_qp + slope E_pq), with slopes per m.
Estimated shear(const StepDiagonals& d, std::size_t p, std::size_t q, double sign,
                const Eigen::VectorXd& x, const Eigen::MatrixXd& C, const Sensitivity& s) {
  Eigen::RowVectorXd t = Eigen::RowVectorXd::Zero(x.size());
  const Eigen::RowVectorXd slope = line_slope(d.n) * (sign * static_cast<double>(d.n));
  t.segment(at(function_column(p, q, 1, d.n)), at(d.n)) = slope / d.travel[p];
  t.segment(at(function_column(q, p, 1, d.n)), at(d.n)) = slope / d.travel[q];
  return {t.dot(x), root((t * C).dot(t)),
          s.model == nullptr ? Shares{} : shares_of(s, t * s.of_readings)};
}

}  // namespace

double StepDiagonals::diagonal() const { return std::hypot(travel[0], travel[1], travel[2]); }

std::array<std::size_t, 3> StepDiagonals::counts(std::size_t t) const {
  std::array<std::size_t, 3> moves{};
  for (std::size_t k = 0; k < 3; ++k) moves[order[k]] = t / 3 + (t % 3 > k ? 1 : 0);
  return moves;
}

Eigen::Vector3d direction(const StepDiagonals& d, const StepDiagonals::Pass& pass) {
  Eigen::Vector3d u;
  for (std::size_t k = 0; k < 3; ++k) u[at(k)] = pass.sign[k] * d.travel[k] / d.diagonal();
  return u;
}

Eigen::Vector3d displacement(const StepDiagonals& d, const StepDiagonals::Pass& pass,
                             std::size_t t) {
  const auto moves = d.counts(t);
  Eigen::Vector3d p;
  for (std::size_t k = 0; k < 3; ++k)
    p[at(k)] =
        pass.sign[k] * d.travel[k] * static_cast<double>(moves[k]) / static_cast<double>(d.n);
  return p;
}

void present(const StepDiagonals& d, const Eigen::VectorXd& values,
             const Eigen::MatrixXd& covariance, const Sensitivity& sensitivity,
             const std::array<bool, 3>& known, StepSolution& out) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t along = 0; along < 3; ++along) {
      const Index first = at(function_column(axis, along, 1, d.n)), n = at(d.n);
      out.curves[3 * axis + along] =
          curve(d, axis, along, values.segment(first, n), covariance.block(first, first, n, n),
                sensitivity, axis != along || known[axis]);
    }
  out.squareness = {shear(d, 0, 1, -1.0, values, covariance, sensitivity),
                    shear(d, 0, 2, 1.0, values, covariance, sensitivity),
                    shear(d, 1, 2, -1.0, values, covariance, sensitivity)};
}

}  // namespace nonio::math
