// SPDX-License-Identifier: Apache-2.0
#include "nonio/model/fit.h"

#include <Eigen/Dense>
#include <cmath>

namespace nonio::model {

namespace {

struct Design {
  Eigen::MatrixXd columns;  // line zeros first
  Eigen::VectorXd weight;   // 1/u, or 1
  std::vector<Parameter> parameters;
  std::vector<std::string> names;  // of all columns
};

Expected<Design> build(const Observations& o, const std::vector<Term>& terms) {
  const auto n = static_cast<Eigen::Index>(o.size());
  const auto lines = static_cast<Eigen::Index>(o.line.empty() ? 1 : o.lines.size());
  Design d;
  std::vector<std::vector<double>> columns;
  for (const Term& term : terms) {
    auto made = term.effect->columns(o, term.axis, term.shape);
    if (!made) return fail(made.error());
    if (made->size() != term.effect->linear.size())
      return fail("effect " + term.effect->info.name +
                  " gave another number of columns than it declares");
    for (std::size_t k = 0; k < made->size(); ++k) {
      if ((*made)[k].size() != o.size())
        return fail("effect " + term.effect->info.name + " gave a column of another length");
      const Effect::Parameter& p = term.effect->linear[k];
      d.parameters.push_back(
          {term.effect->info.name + ":" + term.axis.name + " " + p.name, 0.0, 0.0, p.quantity});
      columns.push_back(std::move((*made)[k]));
    }
  }
  d.columns.setZero(n, lines + static_cast<Eigen::Index>(columns.size()));
  d.weight.setOnes(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto row = static_cast<std::size_t>(i);
    d.columns(i, o.line.empty() ? 0 : static_cast<Eigen::Index>(o.line[row])) = 1.0;
    for (std::size_t k = 0; k < columns.size(); ++k)
      d.columns(i, lines + static_cast<Eigen::Index>(k)) = columns[k][row];
    if (!o.u.empty()) d.weight(i) = 1.0 / o.u[row];
  }
  for (Eigen::Index k = 0; k < lines; ++k)
    d.names.push_back("zero of line " + std::to_string(k + 1));
  for (const Parameter& p : d.parameters) d.names.push_back(p.name);
  return d;
}

/// The columns of the first null direction of a rank-deficient design.
std::string inseparable(const Eigen::MatrixXd& scaled, const std::vector<std::string>& names) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(scaled, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd direction = svd.matrixV().col(scaled.cols() - 1).cwiseAbs();
  std::string text;
  for (Eigen::Index k = 0; k < direction.size(); ++k)
    if (direction(k) > 0.05 * direction.maxCoeff())
      text += (text.empty() ? "" : ", ") + names[static_cast<std::size_t>(k)];
  return text;
}

}  // namespace

Expected<Fit> fit(const Observations& o, const std::vector<Term>& terms) {
  auto design = build(o, terms);
  if (!design) return fail(design.error());
  const Eigen::Index n = design->columns.rows(), unknowns = design->columns.cols();
  if (n <= unknowns)
    return fail(std::to_string(n) + " readings cannot determine " + std::to_string(unknowns) +
                " unknowns");
  const Eigen::VectorXd y = Eigen::Map<const Eigen::VectorXd>(o.deviation.data(), n);
  Eigen::MatrixXd a = design->weight.asDiagonal() * design->columns;
  const Eigen::VectorXd scale = a.colwise().norm().cwiseMax(1e-300).transpose();
  a = a * scale.cwiseInverse().asDiagonal();
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(a);
  qr.setThreshold(1e-9);
  if (qr.rank() < unknowns)
    return fail("the readings cannot tell these apart: " + inseparable(a, design->names));
  const Eigen::VectorXd x = qr.solve(design->weight.asDiagonal() * y).cwiseQuotient(scale);
  const Eigen::VectorXd residual = y - design->columns * x;

  Fit out;
  out.redundancy = static_cast<std::size_t>(n - unknowns);
  out.rms = std::sqrt(residual.squaredNorm() / static_cast<double>(n));
  out.residual.assign(residual.data(), residual.data() + n);
  // (A^T A)^-1 = P R^-1 R^-T P^T
  const Eigen::MatrixXd r_inverse = qr.matrixR()
                                        .topLeftCorner(unknowns, unknowns)
                                        .triangularView<Eigen::Upper>()
                                        .solve(Eigen::MatrixXd::Identity(unknowns, unknowns));
  const Eigen::MatrixXd half = qr.colsPermutation() * r_inverse;
  Eigen::MatrixXd covariance = half * half.transpose();
  if (o.u.empty()) covariance *= residual.squaredNorm() / static_cast<double>(out.redundancy);
  covariance = scale.cwiseInverse().asDiagonal() * covariance * scale.cwiseInverse().asDiagonal();

  const Eigen::Index lines = unknowns - static_cast<Eigen::Index>(design->parameters.size());
  out.zero.assign(x.data(), x.data() + lines);
  out.parameters = std::move(design->parameters);
  const std::size_t p = out.parameters.size();
  out.correlation.assign(p, std::vector<double>(p, 1.0));
  for (std::size_t i = 0; i < p; ++i) {
    const Eigen::Index row = lines + static_cast<Eigen::Index>(i);
    out.parameters[i].value = x(row);
    out.parameters[i].u = std::sqrt(covariance(row, row));
    for (std::size_t k = 0; k < p; ++k) {
      const Eigen::Index column = lines + static_cast<Eigen::Index>(k);
      const double both = std::sqrt(covariance(row, row) * covariance(column, column));
      out.correlation[i][k] = both > 0.0 ? covariance(row, column) / both : (i == k ? 1.0 : 0.0);
    }
  }
  return out;
}

}  // namespace nonio::model
