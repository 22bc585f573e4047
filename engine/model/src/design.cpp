// SPDX-License-Identifier: Apache-2.0
#include "design.h"

#include <cmath>

namespace nonio::model {

Expected<MatrixXd> columns_of(const Observations& o, const Term& term,
                              const std::vector<double>& shape) {
  auto made = term.effect->columns(o, term.axis, shape);
  if (!made) {
    made.error().message = term.name() + ": " + made.error().message;
    return fail(made.error());
  }
  if (!term.effect->curve && made->size() != term.effect->linear.size())
    return fail("effect " + term.name() + " gave " + std::to_string(made->size()) +
                " columns; it declares " + std::to_string(term.effect->linear.size()));
  MatrixXd out(static_cast<Index>(o.size()), static_cast<Index>(made->size()));
  for (std::size_t k = 0; k < made->size(); ++k) {
    const std::vector<double>& column = (*made)[k];
    if (column.size() != o.size())
      return fail("effect " + term.name() + " gave a column of another length than the readings");
    out.col(static_cast<Index>(k)) =
        Eigen::Map<const VectorXd>(column.data(), static_cast<Index>(column.size()));
  }
  if (!out.allFinite()) return fail("effect " + term.name() + " gave a value that is not a number");
  return out;
}

std::vector<std::vector<double>> shapes_of(const Observations& o, const Term& term) {
  if (!term.shape.empty() || term.effect->shapes.empty()) return {term.shape};
  std::vector<std::vector<double>> all{{}};
  for (const Effect::Shape& shape : term.effect->shapes) {
    const std::vector<double> grid = shape.grid(o, term.axis);
    std::vector<std::vector<double>> longer;
    for (const auto& begun : all)
      for (const double value : grid) {
        longer.push_back(begun);
        longer.back().push_back(value);
      }
    all = std::move(longer);
  }
  return all;
}

VectorXd root_weights(const Observations& o, const std::vector<double>& weight) {
  const auto n = static_cast<Index>(o.size());
  VectorXd root = VectorXd::Ones(n);
  if (!o.u.empty()) {
    const Eigen::Map<const VectorXd> u(o.u.data(), n);
    root = u.cwiseInverse() * u.mean();
  }
  if (!weight.empty())
    root = root.cwiseProduct(Eigen::Map<const VectorXd>(weight.data(), n).cwiseSqrt());
  return root;
}

void take_out_zeros(const Observations& o, const VectorXd& root_weight, MatrixXd& columns) {
  const auto lines = static_cast<Index>(lines_of(o));
  const Index n = columns.rows();
  std::vector<Index> line(static_cast<std::size_t>(n));
  VectorXd weight = VectorXd::Zero(lines), sum(lines);
  for (Index i = 0; i < n; ++i) {
    line[static_cast<std::size_t>(i)] = static_cast<Index>(line_of(o, static_cast<std::size_t>(i)));
    weight(line[static_cast<std::size_t>(i)]) += root_weight(i) * root_weight(i);
  }
  weight = (weight.array() > 0.0).select(weight.cwiseInverse(), 0.0);
  for (Index k = 0; k < columns.cols(); ++k) {
    sum.setZero();
    for (Index i = 0; i < n; ++i)
      sum(line[static_cast<std::size_t>(i)]) += root_weight(i) * columns(i, k);
    sum.array() *= weight.array();
    for (Index i = 0; i < n; ++i)
      columns(i, k) -= root_weight(i) * sum(line[static_cast<std::size_t>(i)]);
  }
}

}  // namespace nonio::model
