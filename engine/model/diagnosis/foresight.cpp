// SPDX-License-Identifier: Apache-2.0
// docs/dev/model-search.md, "One more run", describes the prediction.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "data/design.h"
#include "data/whitening.h"
#include "plans.h"

namespace nonio::model {

namespace {

/// The readings followed by planned readings, with the noise of the present ones.
struct Longer {
  Observations table;
  std::vector<double> weight;
  Noise noise;
};

Longer longer_by(const Further& f, const Fit& fit, std::size_t n) {
  Longer out{f.table, fit.weight, fit.noise};
  const Observations& o = out.table;
  out.weight.resize(o.size(), 1.0);
  std::uint32_t next = 0;
  for (const std::uint32_t pass : fit.noise.pass) next = std::max(next, pass + 1);
  std::map<std::pair<std::uint32_t, int>, std::uint32_t> passes;
  for (std::size_t i = n; i < o.size(); ++i) {
    if (!fit.noise.pass.empty())
      out.noise.pass.push_back(
          passes.try_emplace({o.run_of(i), o.axes.front().approach[i]}, next + passes.size())
              .first->second);
    if (fit.noise.rough.empty()) continue;
    const double x = o.axes.front().position[i];
    const auto& stretch = fit.noise.stretch;
    out.noise.rough.push_back(!stretch                                 ? 1.0
                              : x >= stretch->from && x <= stretch->to ? stretch->inside
                                                                       : stretch->outside);
  }
  return out;
}

/// Empty if the longer table changes the columns of the term.
VectorXd said_of(const Observations& o, const Fit& fit, std::size_t term) {
  VectorXd value(static_cast<Index>(fit.parameters.size()));
  Index linear = 0;
  for (const Parameter& p : fit.parameters)
    if (p.effect == fit.terms[term].name() && !p.shape) value(linear++) = p.value;
  const auto columns = columns_of(o, fit.terms[term], fit.terms[term].shape);
  if (!columns || columns->cols() != linear) return {};
  const VectorXd said = *columns * value.head(linear);
  const std::vector<double>& part = fit.part[term];
  const Eigen::Map<const VectorXd> before(part.data(), static_cast<Index>(part.size()));
  const double size = before.cwiseAbs().maxCoeff();
  if (!((said.head(before.size()) - before).cwiseAbs().maxCoeff() <= 1e-9 * size)) return {};
  return said;
}

/// Predicted deviations change only the design. Returns false if there is no prediction.
bool predict(Longer& longer, const Fit& fit, std::size_t n) {
  for (std::size_t i = n; i < longer.table.size(); ++i)
    longer.table.deviation[i] = fit.zero[line_of(longer.table, i)];
  for (std::size_t t = 0; t < fit.terms.size(); ++t) {
    const VectorXd said = said_of(longer.table, fit, t);
    if (said.size() == 0) return false;
    for (std::size_t i = n; i < longer.table.size(); ++i)
      longer.table.deviation[i] += said(static_cast<Index>(i));
  }
  return true;
}

/// A shape with an uncertainty was an unknown of the fit.
std::vector<char> searched_in_fit(const Fit& fit) {
  std::vector<char> out;
  for (const Term& term : fit.terms)
    out.push_back(
        std::any_of(fit.parameters.begin(), fit.parameters.end(), [&](const Parameter& p) {
          return p.effect == term.name() && p.shape && std::isfinite(p.u);
        }));
  return out;
}

std::vector<Foresight::Factor> factors_of(const Fit& now, const Longer& longer) {
  std::vector<Foresight::Factor> out;
  const auto then =
      fit_at(longer.table, now.terms, searched_in_fit(now), longer.weight, longer.noise);
  if (!then || then->parameters.size() != now.parameters.size() || now.redundancy == 0) return out;
  // Predicted readings have no residuals: this factor keeps s constant as redundancy grows.
  const double same_s =
      std::sqrt(static_cast<double>(then->redundancy) / static_cast<double>(now.redundancy));
  // More runs do not improve a stated time constant, nor parameters that depend on it.
  std::set<std::string> stated;
  for (const Term& term : now.terms)
    if (has_stated(term)) stated.insert(term.name());
  for (std::size_t i = 0; i < now.parameters.size(); ++i) {
    if (stated.contains(now.parameters[i].effect)) continue;
    const double factor = same_s * then->parameters[i].u / now.parameters[i].u;
    if (std::isfinite(factor))
      out.push_back({now.parameters[i].effect, now.parameters[i].name, factor});
  }
  return out;
}

/// Sum of squares that only this term explains; NaN if the columns of a term are not computable.
double taken_by(const Fit& fit, std::size_t term, const Observations& o,
                const std::vector<double>& weight, const Noise& noise) {
  const Whitening white(o, weight, Whitening::of_repeats(noise));
  MatrixXd own = said_of(o, fit, term);
  if (own.size() == 0) return NAN;
  own = white(own);
  white.take_out_zeros(own);
  MatrixXd others(own.rows(), 0);
  for (std::size_t t = 0; t < fit.terms.size(); ++t) {
    if (t == term) continue;
    const auto columns = columns_of(o, fit.terms[t], fit.terms[t].shape);
    if (!columns) return NAN;
    others.conservativeResize(Eigen::NoChange, others.cols() + columns->cols());
    others.rightCols(columns->cols()) = white(*columns);
  }
  if (others.cols() == 0) return own.squaredNorm();
  white.take_out_zeros(others);
  const Eigen::HouseholderQR<MatrixXd> qr(of_unit_length(others));
  const VectorXd turned = math::rotated(qr, own.col(0));
  return turned.tail(turned.size() - others.cols()).squaredNorm();
}

std::vector<Foresight::Evidence> evidence_of(const Explanation& e, const Fit& best,
                                             const Longer& longer, const Observations& table) {
  std::vector<Foresight::Evidence> out;
  const auto n = static_cast<double>(table.size()), m = static_cast<double>(longer.table.size());
  const auto r = static_cast<double>(best.redundancy), more = r + m - n;
  for (std::size_t t = 0; t < best.terms.size(); ++t) {
    const auto candidate =
        std::find_if(e.candidates.begin(), e.candidates.end(),
                     [&](const Candidate& c) { return c.term.name() == best.terms[t].name(); });
    if (candidate == e.candidates.end() || !(candidate->score > 0.0) || !(best.s > 0.0)) continue;
    const double s2 = best.s * best.s;
    const double now = taken_by(best, t, table, best.weight, best.noise) / s2;
    const double then = taken_by(best, t, longer.table, longer.weight, longer.noise) / s2;
    const double gain = m * std::log1p(then / more) - n * std::log1p(now / r);
    const auto k = static_cast<double>(candidate->parameters.size());
    const double evidence = candidate->score + gain - k * std::log(m / n);
    if (std::isfinite(evidence))
      out.push_back({candidate->term.name(), candidate->score, evidence});
  }
  return out;
}

/// Uses the shapes that were found.
Expected<Fit> best_fit(const Part& part, const Explanation& e) {
  const Fit& fit = e.comparison.fit;
  std::vector<Term> terms = fit.terms;
  for (const Candidate& c : e.candidates)
    if (std::find(e.together.begin(), e.together.end(), c.term.name()) != e.together.end())
      terms.push_back(c.term);
  const std::vector<char> none(terms.size(), 0);
  return fit_at(part.table, std::move(terms), none, fit.weight, fit.noise);
}

}  // namespace

std::vector<Foresight> foresee(const Part& part, const Explanation& e) {
  constexpr std::size_t most = 20000;  // readings: above, each design takes seconds
  static const std::set<std::string> wanted{"another-run", "another-run-reversed",
                                            "both-sides-at-each-target"};
  std::vector<Foresight> out;
  const std::size_t n = part.table.size();
  if (part.kind != Part::Kind::axis || part.axes.empty() || n > most) return out;
  const Fit& fit = e.comparison.fit;
  const auto best = best_fit(part, e);
  for (const Further& f : further_runs(part, part.axes.front())) {
    if (!wanted.contains(f.id)) continue;
    Longer longer = longer_by(f, fit, n);
    if (!predict(longer, fit, n)) continue;
    Foresight one{f.id, f.table.size() - n, factors_of(fit, longer), {}};
    if (best) one.evidence = evidence_of(e, *best, longer, part.table);
    if (!one.parameters.empty() || !one.evidence.empty()) out.push_back(std::move(one));
  }
  return out;
}

}  // namespace nonio::model
