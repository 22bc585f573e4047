// SPDX-License-Identifier: Apache-2.0
#include "rigid_fit.h"

#include <algorithm>
#include <cmath>

namespace nonio::math {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t scatter_rounds = 20;

std::size_t shared_unknowns(const std::vector<RigidLine>& lines) {
  std::size_t count = 0;
  for (const RigidLine& line : lines)
    for (const auto& shared : line.shared) count = std::max(count, shared.unknown + 1);
  return count;
}

RigidTable table_of(const std::vector<RigidLine>& lines, const std::vector<RigidTerm>& terms,
                    const RigidBox& box) {
  std::vector<RigidRows> rows;
  const std::size_t together = shared_unknowns(lines);
  std::size_t readings = 0, set_up = together;
  for (const RigidLine& line : lines) {
    rows.push_back(rows_of(line, terms, box));
    readings += line.readings.size();
    set_up += rows.back().set_up.empty() ? 0 : rows.back().set_up.front().size();
  }
  RigidTable t{MatrixXd::Zero(at(readings), at(terms.size())),
               MatrixXd::Zero(at(readings), at(set_up)),
               VectorXd(at(readings)),
               {},
               {},
               0};
  for (const RigidLine& line : lines)
    if (line.kind != RigidLine::Kind::stated) t.groups = std::max(t.groups, line.group + 1);
  Index row = 0, own = at(together);
  for (std::size_t l = 0; l < lines.size(); ++l) {
    const RigidLine& line = lines[l];
    const bool stated = line.kind == RigidLine::Kind::stated;
    for (std::size_t i = 0; i < line.readings.size(); ++i, ++row) {
      for (std::size_t k = 0; k < terms.size(); ++k) t.terms(row, at(k)) = rows[l].terms[i][k];
      const auto& mine = rows[l].set_up[i];
      for (std::size_t k = 0; k < mine.size(); ++k) t.set_up(row, own + at(k)) = mine[k];
      for (const auto& shared : line.shared)
        t.set_up(row, at(shared.unknown)) += shared.of_reading[i];
      t.value[row] = line.readings[i].value;
      t.group.push_back(stated ? t.groups : line.group);
      t.stated.push_back(stated ? line.readings[i].u : 0.0);
    }
    if (!rows[l].set_up.empty()) own += at(rows[l].set_up.front().size());
  }
  return t;
}

/// Returns an orthonormal basis of the space of the columns, of any rank.
MatrixXd basis_of(MatrixXd columns) {
  for (Index k = 0; k < columns.cols(); ++k)
    if (const double size = columns.col(k).norm(); size > 0.0) columns.col(k) /= size;
  Eigen::ColPivHouseholderQR<MatrixXd> qr(columns);
  qr.setThreshold(1e-9);
  return orthonormal(qr, qr.rank());
}

RigidSolved solve_once(const RigidTable& t, const std::vector<double>& scatter) {
  VectorXd root(t.value.size());
  for (Index i = 0; i < root.size(); ++i) {
    const auto row = static_cast<std::size_t>(i);
    root[i] = 1.0 / (t.stated[row] > 0.0 ? t.stated[row] : scatter[t.group[row]]);
  }
  const MatrixXd Q = basis_of(scaled_rows(root, t.set_up));
  MatrixXd A = scaled_rows(root, t.terms);
  VectorXd y = root.cwiseProduct(t.value);
  A = orthogonal_part(Q, A);
  y = orthogonal_part(Q, y);
  // A = H R with few columns: R has the singular values of A.
  const Eigen::HouseholderQR<MatrixXd> qr(A);
  const Index small = std::min(A.rows(), A.cols());
  const MatrixXd R = upper(qr, small);
  const Eigen::JacobiSVD<MatrixXd> svd(R, Eigen::ComputeFullV);
  RigidSolved s;
  s.sigma = VectorXd::Zero(A.cols());
  s.sigma.head(svd.singularValues().size()) = svd.singularValues();
  while (s.rank < small && s.sigma[s.rank] > rank_below * s.sigma[0]) ++s.rank;
  s.V = left_columns(svd.matrixV(), s.rank);
  const VectorXd by_size = s.sigma.head(s.rank).cwiseInverse();
  const MatrixXd U = scaled_columns(product(A, s.V), by_size);
  s.x = times(s.V, by_size.cwiseProduct(transposed_times(U, y)));
  s.residual = residual(y, A, s.x);
  s.map = scaled_columns(product_transposed(scaled_columns(s.V, by_size), U), root);
  s.leverage = U.rowwise().squaredNorm() + Q.rowwise().squaredNorm();
  s.set_up = Q.cols();
  return s;
}

/// Returns s of each group from the residuals; 0 for a group without degrees of freedom.
RigidScatter scatter_of(const RigidTable& t, const RigidSolved& solved,
                        const std::vector<double>& used) {
  RigidScatter out{std::vector<double>(t.groups, 0.0), std::vector<double>(t.groups, 0.0)};
  for (Index i = 0; i < t.value.size(); ++i) {
    const std::size_t g = t.group[static_cast<std::size_t>(i)];
    if (g == t.groups) continue;
    out.s[g] += solved.residual[i] * solved.residual[i];
    out.dof[g] += 1.0 - solved.leverage[i];
  }
  for (std::size_t g = 0; g < t.groups; ++g)
    out.s[g] = out.dof[g] > 0.5 ? used[g] * std::sqrt(out.s[g] / out.dof[g]) : 0.0;
  return out;
}

/// Returns twice the negative logarithm of the likelihood plus Schwarz's cost of the unknowns.
double schwarz(const RigidTable& t, const RigidSolved& s, const std::vector<double>& scatter) {
  const auto n = static_cast<double>(t.value.size());
  double sum = s.residual.squaredNorm() + static_cast<double>(s.rank) * std::log(n);
  for (const std::size_t g : t.group)
    if (g < t.groups) sum += 2.0 * std::log(scatter[g]);
  return sum;
}

/// Smallest scatter of a group, m or rad; smaller residuals of exact readings are rounding errors.
constexpr double no_scatter = 1e-12;

}  // namespace

RigidFit fit_rigid_body(const std::vector<RigidLine>& lines, const RigidBox& box,
                        const std::vector<std::string>& errors, std::size_t degree) {
  RigidFit f;
  f.terms = rigid_terms(box, errors, degree);
  f.table = table_of(lines, f.terms, box);
  std::vector<double> used(f.table.groups, 1e-6);
  for (std::size_t round = 0; round < scatter_rounds; ++round) {
    f.solved = solve_once(f.table, used);
    f.scatter = scatter_of(f.table, f.solved, used);
    double change = 0.0;
    std::vector<double> next = used;
    for (std::size_t g = 0; g < used.size(); ++g) {
      if (f.scatter.dof[g] > 0.5) next[g] = std::max(f.scatter.s[g], no_scatter);
      change = std::max(change, std::fabs(std::log(next[g] / used[g])));
    }
    if (change < 1e-4) break;
    used = next;
  }
  f.scatter.s = used;
  f.price = schwarz(f.table, f.solved, used);
  return f;
}

}  // namespace nonio::math
