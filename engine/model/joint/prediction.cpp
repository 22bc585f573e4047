// SPDX-License-Identifier: Apache-2.0
#include "nonio/model/prediction.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "data/design.h"

namespace nonio::model {

namespace {

const char* const mark = "unseen ";

/// In one table, the knots of curves and the origins of levers are the same for both. Lines and
/// bodies of `unseen` get new names.
Expected<Observations> joined(const Observations& seen, const Observations& unseen) {
  Observations out = seen;
  if (seen.angular != unseen.angular) return fail("one is in um, the other in arcsec");
  if (out.lines.empty() || unseen.lines.empty()) return fail("expected lines of sensing");
  for (auto& axis : out.axes) {
    const auto* more = unseen.axis(axis.axis);
    if (more == nullptr)
      return fail("axis " + axis.axis + " is not among what was measured in both campaigns");
    const std::size_t before = axis.position.size();
    axis.position.insert(axis.position.end(), more->position.begin(), more->position.end());
    axis.approach.resize(before, 0);
    axis.approach.insert(axis.approach.end(), more->approach.begin(), more->approach.end());
    axis.approach.resize(axis.position.size(), 0);
  }
  for (const auto& axis : unseen.axes)
    if (seen.axis(axis.axis) == nullptr)
      return fail("axis " + axis.axis + " is not among what was measured in both campaigns");
  const auto first = static_cast<std::uint32_t>(seen.lines.size());
  if (out.line.empty()) out.line.assign(seen.size(), 0);
  for (std::size_t i = 0; i < unseen.size(); ++i) out.line.push_back(first + line_of(unseen, i));
  for (Observations::Line line : unseen.lines) {
    line.name = mark + line.name;
    if (!line.body.empty()) line.body = mark + line.body;
    out.lines.push_back(std::move(line));
  }
  if (!seen.sense.empty() || !unseen.sense.empty()) {
    out.sense.clear();
    for (std::size_t i = 0; i < seen.size(); ++i) out.sense.push_back(seen.sense_of(i));
    for (std::size_t i = 0; i < unseen.size(); ++i) out.sense.push_back(unseen.sense_of(i));
  }
  const auto own = [](Observations::Channel channel, std::uint32_t from, std::size_t lines) {
    if (channel.lines.empty()) {
      channel.lines.resize(lines);
      std::iota(channel.lines.begin(), channel.lines.end(), 0U);
    }
    for (std::uint32_t& line : channel.lines) line += from;
    return channel;
  };
  for (auto& channel : out.channels) channel = own(std::move(channel), 0, seen.lines.size());
  for (const auto& channel : unseen.channels)
    out.channels.push_back(own(channel, first, unseen.lines.size()));
  append_measured(out, unseen);
  return out;
}

/// The term with the lines of both. An error if its groups are not those of the unseen lines.
Expected<Term> for_both(Term term, const Part& unseen) {
  if (!term.grouping) return term;
  auto both = std::make_shared<Grouping>(*term.grouping);
  const auto same = std::find_if(unseen.groupings.begin(), unseen.groupings.end(),
                                 [&](const auto& g) { return g->by == both->by; });
  if (same == unseen.groupings.end())
    return fail(term.name() + ": the readings of the other campaign are not grouped by " +
                both->by + ", so it is not known which of its values applies");
  for (const std::uint32_t group : (*same)->group) {
    const std::string& name = (*same)->name[group];
    const auto known = std::find(both->name.begin(), both->name.end(), name);
    if (known == both->name.end())
      return fail(term.name() + ": the model has no value for the " + both->by + " " + name +
                  " of the other campaign");
    both->group.push_back(static_cast<std::uint32_t>(known - both->name.begin()));
  }
  term.grouping = std::move(both);
  return term;
}

Expected<MatrixXd> columns_of_terms(const Observations& o, const std::vector<Term>& terms) {
  MatrixXd out(static_cast<Index>(o.size()), 0);
  for (const Term& term : terms) {
    NONIO_TRY(const auto columns, columns_of(o, term, term.shape));
    out.conservativeResize(Eigen::NoChange, out.cols() + columns.cols());
    out.rightCols(columns.cols()) = columns;
  }
  return out;
}

/// Returns one indicator column for the zero of each line of these rows.
MatrixXd zeros_of(const Observations& o, Index first, Index rows) {
  std::vector<std::uint32_t> lines;
  for (Index i = first; i < first + rows; ++i) {
    const std::uint32_t line = line_of(o, static_cast<std::size_t>(i));
    if (std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(line);
  }
  MatrixXd out = MatrixXd::Zero(rows, static_cast<Index>(lines.size()));
  for (Index i = 0; i < rows; ++i) {
    const auto at =
        std::find(lines.begin(), lines.end(), line_of(o, static_cast<std::size_t>(first + i)));
    out(i, at - lines.begin()) = 1.0;
  }
  return out;
}

/// Whether a curve of the model is one over this axis: `pitch-curve:X`, `straightness:EYX`.
bool has_curve_over(const std::vector<Term>& model, const std::string& axis) {
  return std::any_of(model.begin(), model.end(), [&](const Term& term) {
    return term.effect->curve && term.axis.name.ends_with(axis);
  });
}

/// Of each unseen reading, whether it is outside the range of the seen positions of an axis.
/// `curved`: only of an axis over which a curve of the model is one.
std::vector<char> outside_of(const Observations& seen, const Observations& unseen,
                             const std::vector<Term>& model, bool curved) {
  constexpr double margin = 0.02, rounding = 1e-6;  // of the range; m or rad
  std::vector<char> out(unseen.size(), 0);
  for (const auto& axis : unseen.axes) {
    const auto* known = seen.axis(axis.axis);
    if (known == nullptr || (curved && !has_curve_over(model, axis.axis))) continue;
    const auto [low, high] = std::minmax_element(known->position.begin(), known->position.end());
    const double more = margin * (*high - *low) + rounding;
    for (std::size_t i = 0; i < out.size(); ++i)
      if (axis.position[i] < *low - more || axis.position[i] > *high + more) out[i] = 1;
  }
  return out;
}

/// The readings of `o` that are not marked.
Observations without_marked(Observations o, const std::vector<char>& marked) {
  const auto keep = [&](auto& column) {
    if (column.size() != marked.size()) return;
    std::size_t to = 0;
    for (std::size_t i = 0; i < marked.size(); ++i)
      if (marked[i] == 0) column[to++] = column[i];
    column.resize(to);
  };
  for (auto& axis : o.axes) keep(axis.position), keep(axis.approach);
  keep(o.deviation), keep(o.u), keep(o.line), keep(o.run), keep(o.time), keep(o.source_line);
  keep(o.sense), keep(o.material), keep(o.air), keep(o.pressure), keep(o.humidity);
  return o;
}

MatrixXd with(const MatrixXd& a, const MatrixXd& b) {
  MatrixXd out(a.rows(), a.cols() + b.cols());
  out << a, b;
  return out;
}

}  // namespace

Expected<Prediction> predict_places(const Part& seen, const std::vector<Term>& model,
                                    const Part& all_unseen, const std::vector<Term>& set_up) {
  NONIO_TRY(const auto compared, compare(seen, model));
  // A curve is not known outside of its range.
  const auto far = outside_of(seen.table, all_unseen.table, model, false);
  const auto unknown = outside_of(seen.table, all_unseen.table, model, true);
  Prediction out;
  out.outside = std::count(far.begin(), far.end(), 1) > 0;
  out.left_out = static_cast<std::size_t>(std::count(unknown.begin(), unknown.end(), 1));
  Part unseen = all_unseen;
  unseen.table = without_marked(std::move(unseen.table), unknown);
  if (unseen.table.size() == 0)
    return fail("all " + std::to_string(out.left_out) +
                " readings are outside the places that the model was fitted to, where its curves "
                "are not known");
  NONIO_TRY(const Observations both, joined(seen.table, unseen.table));
  std::vector<Term> named, own, others = set_up;
  for (const Term& term : compared.fit.terms) {
    NONIO_TRY(auto both_of, for_both(term, unseen));
    (term.effect->is_nuisance ? own : named).push_back(std::move(both_of));
  }
  std::erase_if(others, [](const Term& t) { return !t.effect->is_nuisance; });
  for (Term& term : others) term.axis.name = mark + term.axis.name;
  NONIO_TRY(const MatrixXd of_model, columns_of_terms(both, named));
  NONIO_TRY(const MatrixXd of_seen, columns_of_terms(both, own));
  NONIO_TRY(const MatrixXd of_unseen, columns_of_terms(both, others));
  const auto n = static_cast<Index>(seen.table.size()), m = static_cast<Index>(unseen.table.size());
  const VectorXd y = Eigen::Map<const VectorXd>(both.deviation.data(), n + m);

  VectorXd root(n);
  for (Index i = 0; i < n; ++i)
    root(i) = std::sqrt(
        compared.fit.weight.empty() ? 1.0 : compared.fit.weight[static_cast<std::size_t>(i)]);
  const MatrixXd a = math::scaled_rows(
      root, with(of_model.topRows(n), with(of_seen.topRows(n), zeros_of(both, 0, n))));
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(a);
  if (qr.rank() < a.cols())
    return fail(
        "the readings of the first campaign cannot determine its model in the places of both");
  const VectorXd weighted = root.cwiseProduct(y.head(n));
  const VectorXd x = math::solution(qr, weighted);
  const double dof = root.cwiseAbs2().sum() - static_cast<double>(a.cols());
  if (!(dof >= 1.0))
    return fail("the model has as many unknowns as the first campaign has readings");
  const double s2 = math::squared_residual(weighted, a, x) / dof;
  const Index k = of_model.cols();
  const MatrixXd cofactor = math::solutions(Eigen::LLT<MatrixXd>(math::transposed_product(a, a)),
                                            MatrixXd::Identity(a.cols(), a.cols()));
  const MatrixXd covariance = s2 * cofactor.topLeftCorner(k, k);

  // Predict the readings `unseen`, whose zeros and set-up are new unknowns.
  const MatrixXd free = with(of_unseen.bottomRows(m), zeros_of(both, n, m));
  const Eigen::ColPivHouseholderQR<MatrixXd> decomposed(free);
  if (m <= decomposed.rank())
    return fail(
        "expected more readings than the zeros and the set-up of the other campaign have "
        "unknowns" +
        std::string(out.left_out == 0 ? ""
                                      : "; " + std::to_string(out.left_out) +
                                            " are outside the range of the curves"));
  const MatrixXd q = math::orthonormal(decomposed, decomposed.rank());
  VectorXd error = math::residual(y.tail(m), of_model.bottomRows(m), x.head(k));
  VectorXd readings = y.tail(m);
  MatrixXd from = of_model.bottomRows(m);
  math::take_out(q, error), math::take_out(q, readings), math::take_out(q, from);
  const MatrixXd spread = math::product(from, covariance);
  std::size_t inside = 0;
  for (Index i = 0; i < m; ++i) {
    out.error.push_back(error(i));
    const double own_share = std::max(1.0 - q.row(i).squaredNorm(), 0.0);
    out.u.push_back(std::sqrt(s2 * own_share + spread.row(i).dot(from.row(i))));
    if (std::fabs(error(i)) <= 2.0 * out.u.back()) ++inside;
  }
  out.rms = std::sqrt(error.squaredNorm() / static_cast<double>(m));
  out.sd = std::sqrt(readings.squaredNorm() / static_cast<double>(m));
  out.inside = static_cast<double>(inside) / static_cast<double>(m);
  return out;
}

}  // namespace nonio::model
