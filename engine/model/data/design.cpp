// SPDX-License-Identifier: Apache-2.0
#include "design.h"

#include <algorithm>
#include <cmath>

namespace nonio::model {

namespace {

/// A linear axis contributes its component along the direction of sensing of each reading.
void project(const Observations& o, const Axis& axis, MatrixXd& columns) {
  const std::size_t k = coordinate_of(axis.name);
  if (axis.rotary || k > 2) return;
  for (Index i = 0; i < columns.rows(); ++i)
    columns.row(i) *= o.sense_of(static_cast<std::size_t>(i))[k];
}

/// One block per group, with 0 in the rows of other groups; for differences, no first block.
MatrixXd in_groups(const Observations& o, const Term& term, const MatrixXd& columns) {
  const Index first = term.differences ? 1 : 0, k = columns.cols();
  MatrixXd out =
      MatrixXd::Zero(columns.rows(), k * (static_cast<Index>(term.grouping->name.size()) - first));
  for (Index i = 0; i < columns.rows(); ++i) {
    const auto group =
        static_cast<Index>(term.grouping->group[line_of(o, static_cast<std::size_t>(i))]);
    if (group >= first) out.block(i, (group - first) * k, 1, k) = columns.row(i);
  }
  return out;
}

}  // namespace

std::vector<Term> with_term(std::vector<Term> model, Term term) {
  if (term.grouping) std::erase_if(model, [&](const Term& t) { return t.name() == term.of_all(); });
  term.differences = false;
  model.push_back(std::move(term));
  return model;
}

std::vector<Term> offered_to(const std::vector<Term>& model, const std::vector<Term>& catalogue) {
  std::vector<Term> out;
  for (Term c : catalogue) {
    const auto same = [&](const Term& m) { return m.of_all() == c.of_all(); };
    const auto known = std::find_if(model.begin(), model.end(), same);
    if (known != model.end()) {
      if (!c.grouping || known->grouping) continue;
      c.differences = true;
    }
    out.push_back(std::move(c));
  }
  return out;
}

Expected<MatrixXd> columns_of(const Observations& o, const Term& term,
                              const std::vector<double>& shape) {
  if (term.held) return MatrixXd(static_cast<Index>(o.size()), 0);
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
  if (!term.effect->instances && o.axes.size() > 1) project(o, term.axis, out);
  if (term.grouping) return in_groups(o, term, out);
  return out;
}

bool may_lose(const Observations& o, const Term& term) {
  return term.effect->curve && (o.axes.size() > 1 || term.effect->description);
}

Expected<std::vector<MatrixXd>> blocks_of(const Observations& o, const std::vector<Term>& terms,
                                          const VectorXd& root, std::vector<Index>* lost) {
  std::vector<MatrixXd> blocks;
  bool curves = false;
  for (const Term& term : terms) {
    NONIO_TRY(auto block, columns_of(o, term, term.shape));
    blocks.push_back(std::move(block));
    curves = curves || may_lose(o, term);
  }
  if (lost != nullptr) lost->assign(terms.size(), 0);
  if (!curves) return blocks;
  MatrixXd before(static_cast<Index>(o.size()), 0);  // orthonormal basis of the earlier terms
  for (std::size_t t = 0; t < terms.size(); ++t) {
    MatrixXd own = root.asDiagonal() * blocks[t];
    take_out_zeros(o, root, own);
    const double size = own.norm();
    for (int twice = 0; twice < 2; ++twice) math::take_out(before, own);
    const Eigen::JacobiSVD<MatrixXd> svd(own, Eigen::ComputeThinU | Eigen::ComputeThinV);
    Index rank = 0;
    const bool in_space =
        o.axes.size() > 1 && may_lose(o, terms[t]) && !terms[t].effect->description;
    const double least = in_space
                             ? weakest_of_curve * size / std::sqrt(static_cast<double>(own.cols()))
                             : curve_threshold * size;
    while (rank < own.cols() && svd.singularValues()(rank) > least) ++rank;
    if (may_lose(o, terms[t]) && rank > 0 && rank < own.cols()) {
      if (lost != nullptr) (*lost)[t] = own.cols() - rank;
      blocks[t] = blocks[t] * svd.matrixV().leftCols(rank);
    }
    const Index had = before.cols();
    before.conservativeResize(Eigen::NoChange, had + rank);
    before.rightCols(rank) = svd.matrixU().leftCols(rank);
  }
  return blocks;
}

std::vector<std::vector<double>> shapes_of(const Observations& o, const Term& term) {
  if (!term.shape.empty() || term.effect->shapes.empty()) return {term.shape};
  std::vector<std::vector<double>> all{{}};
  for (const Effect::Shape& shape : term.effect->shapes) {
    std::vector<double> grid = shape.grid(o, term.axis);
    if (const auto& stated = term.stated;
        stated && &shape == &term.effect->shapes[stated->shape] && !grid.empty())
      grid.insert(std::lower_bound(grid.begin(), grid.end(), stated->value), stated->value);
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

std::optional<double> usual_of(const Term& term, std::size_t k) {
  if (term.stated && term.stated->shape == k) return term.stated->value;
  return term.effect->shapes[k].usual;
}

bool is_usual(const Term& term, const std::vector<double>& shape, std::size_t k) {
  const auto usual = usual_of(term, k);
  return usual && shape[k] == *usual;
}

bool are_usual(const Term& term, const std::vector<double>& shape) {
  for (std::size_t k = 0; k < shape.size(); ++k)
    if (usual_of(term, k) && !is_usual(term, shape, k)) return false;
  return true;
}

std::vector<double> stated_u(const Observations& o) {
  std::vector<double> u = o.u;
  const auto stated = [](double one) { return std::isfinite(one) && one > 0.0; };
  double sum = 0.0, n = 0.0;
  for (const double one : u)
    if (stated(one)) sum += one, ++n;
  if (!(n > 0.0)) return {};
  for (double& one : u)
    if (!stated(one)) one = sum / n;
  return u;
}

VectorXd root_weights(const Observations& o, const std::vector<double>& weight) {
  const auto n = static_cast<Index>(o.size());
  VectorXd root = VectorXd::Ones(n);
  if (const std::vector<double> stated = stated_u(o); !stated.empty()) {
    const Eigen::Map<const VectorXd> u(stated.data(), n);
    root = u.cwiseInverse() * u.mean();
  }
  if (!weight.empty())
    root = root.cwiseProduct(Eigen::Map<const VectorXd>(weight.data(), n).cwiseSqrt());
  return root;
}

void take_out_zeros(const Observations& o, const VectorXd& root_weight, MatrixXd& columns) {
  const auto lines = static_cast<Index>(lines_of(o));
  const Index n = columns.rows();
  struct Stretch {  // rows of one line that follow one another
    Index begin, end, line;
  };
  std::vector<Stretch> stretches;
  VectorXd weight = VectorXd::Zero(lines), sum(lines);
  for (Index i = 0; i < n; ++i) {
    const auto line = static_cast<Index>(line_of(o, static_cast<std::size_t>(i)));
    if (stretches.empty() || stretches.back().line != line) stretches.push_back({i, i, line});
    stretches.back().end = i + 1;
    weight(line) += root_weight(i) * root_weight(i);
  }
  weight = (weight.array() > 0.0).select(weight.cwiseInverse(), 0.0);
  for (Index k = 0; k < columns.cols(); ++k) {
    sum.setZero();
    for (const auto& [begin, end, line] : stretches) {
      double of_line = sum(line);  // not added up in memory, which is slow
      for (Index i = begin; i < end; ++i) of_line += root_weight(i) * columns(i, k);
      sum(line) = of_line;
    }
    sum.array() *= weight.array();
    for (const auto& [begin, end, line] : stretches)
      columns.col(k).segment(begin, end - begin) -=
          sum(line) * root_weight.segment(begin, end - begin);
  }
}

}  // namespace nonio::model
