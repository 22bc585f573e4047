// SPDX-License-Identifier: Apache-2.0
// What one run more would do to the uncertainties: no reading is invented, only its place and time.
#include <algorithm>
#include <cmath>
#include <set>

#include "data/design.h"
#include "plans.h"

namespace nonio::model {

namespace {

/// Standard uncertainties of the linear parameters of these terms for noise of 1, term by term.
/// Empty where the readings cannot tell them apart.
VectorXd unit_uncertainties(const Observations& o, const std::vector<Term>& terms,
                            std::vector<double> weight) {
  weight.resize(weight.empty() ? 0 : o.size(), 1.0);
  const VectorXd root = root_weights(o, weight);
  MatrixXd all(static_cast<Index>(o.size()), 0);
  for (const Term& term : terms) {
    const auto columns = columns_of(o, term, term.shape);
    if (!columns || !columns->allFinite()) return {};
    all.conservativeResize(Eigen::NoChange, all.cols() + columns->cols());
    all.rightCols(columns->cols()) = root.asDiagonal() * *columns;
  }
  take_out_zeros(o, root, all);
  const VectorXd length = all.colwise().norm().cwiseMax(1e-300).transpose();
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(of_unit_length(all));
  if (all.cols() == 0 || qr.rank() < all.cols()) return {};
  const Index n = all.cols();
  const MatrixXd inverse = qr.matrixR().topLeftCorner(n, n).triangularView<Eigen::Upper>().solve(
      MatrixXd::Identity(n, n));
  return (qr.colsPermutation() * inverse.rowwise().norm()).cwiseQuotient(length);
}

/// How much smaller the last `count` of them become together.
double factor_of(const VectorXd& now, const VectorXd& then, Index count) {
  return then.tail(count).norm() / now.tail(count).norm();
}

}  // namespace

std::vector<Foresight> foresee(const Part& part, const Explanation& e) {
  constexpr std::size_t most = 20000;  // readings: above, each design takes seconds
  std::vector<Foresight> out;
  if (part.kind != Part::Kind::axis || part.axes.empty() || part.table.size() > most) return out;
  const Fit& fit = e.comparison.fit;
  const std::set<std::string> wanted{"another-run", "another-run-reversed",
                                     "both-sides-at-each-target"};
  const VectorXd now = unit_uncertainties(part.table, fit.terms, fit.weight);
  if (now.size() == 0 && !fit.terms.empty()) return out;
  for (const Further& f : further_runs(part, part.axes.front().name)) {
    if (!wanted.contains(f.id)) continue;
    const VectorXd then = unit_uncertainties(f.table, fit.terms, fit.weight);
    if (then.size() != now.size()) continue;
    Foresight one{f.id, f.table.size() - part.table.size(), {}, {}};
    Index k = 0;
    for (const Parameter& p : fit.parameters)
      if (!p.shape && k < now.size()) {
        one.parameters.push_back({p.effect, p.name, then(k) / now(k)});
        ++k;
      }
    for (const Candidate& c : e.candidates) {
      if (!c.visible) continue;
      std::vector<Term> terms = fit.terms;
      terms.push_back(c.term);
      const VectorXd a = unit_uncertainties(part.table, terms, fit.weight);
      const VectorXd b = unit_uncertainties(f.table, terms, fit.weight);
      const Index count = a.size() - now.size();
      if (count <= 0 || a.size() != b.size()) continue;
      one.candidates.push_back({c.term.name(), "", factor_of(a, b, count)});
    }
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace nonio::model
