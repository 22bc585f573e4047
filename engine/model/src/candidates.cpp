// SPDX-License-Identifier: Apache-2.0
#include "candidates.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "compare.h"

namespace nonio::model {

namespace {

using State = Workbench::State;

constexpr double alias_evidence = 6.0;  // 2 ln 20: one twentieth of the evidence is no difference

class CandidateOf {
 public:
  explicit CandidateOf(const Finding& finding) : f_(finding) {}

  Candidate operator()(std::size_t e) const {
    Candidate c;
    c.term = f_.terms[e];
    c.score = -std::numeric_limits<double>::infinity();
    const State alone = f_.bench->joined(f_.start, f_.bench->gains(f_.start, e), e);
    if (alone.blocks.size() == f_.start.blocks.size()) {
      c.visible = false;
      c.why = f_.bench->instances()[e].blocks.empty() ? "not-shown" : "aliased";
      return c;
    }
    const bool member = f_.bench->holds(f_.best, e);
    std::size_t block = alone.blocks.back();
    if (member) {
      for (const std::size_t b : f_.best.blocks)
        if (f_.bench->effect_of(b) == e) block = b;
      c.score = f_.bench->settled(f_.bench->without(f_.best, e)).criterion - f_.best.criterion;
      c.p = f_.chance.corrected(p_of(*f_.bench, f_.best, e));
      c.aliases = aliases_of(e);
    } else {
      score_outsider(e, c);
    }
    c.term.shape = f_.bench->blocks()[block].shape;
    c.minimal_detectable = minimal_detectable(e, block);
    fit_candidate(alone, c);
    return c;
  }

 private:
  /// Effects that can stand for a member of the best explanation at hardly any loss.
  std::vector<std::string> aliases_of(std::size_t member) const {
    std::vector<std::string> names;
    const State rest = f_.bench->without(f_.best, member);
    const VectorXd gains = f_.bench->gains(rest);
    for (std::size_t other = f_.in_model; other < f_.terms.size(); ++other) {
      if (other == member || f_.bench->holds(f_.best, other)) continue;
      const State changed = f_.bench->settled(f_.bench->joined(rest, gains, other));
      if (changed.blocks.size() > rest.blocks.size() && as_good(changed))
        names.push_back(f_.terms[other].name());
    }
    return names;
  }

  /// Hardly any evidence is lost; in space, where one curve can hold another effect wholly, also
  /// where the readings lose nothing and only the parameters cost more.
  bool as_good(const State& changed) const {
    if (changed.criterion < f_.best.criterion + alias_evidence) return true;
    return f_.part.table.axes.size() > 1 &&
           f_.bench->readings() * std::log(changed.squares / f_.best.squares) < alias_evidence;
  }

  /// Evidence of an effect outside the best explanation: added to it, or instead of a member.
  void score_outsider(std::size_t e, Candidate& c) const {
    const State more = f_.bench->joined(f_.best, f_.bench->gains(f_.best, e), e);
    if (more.blocks.size() > f_.best.blocks.size()) {
      c.score = f_.best.criterion - more.criterion;
      c.p = f_.chance.corrected(p_of(*f_.bench, more, e));
    }
    for (const std::size_t b : f_.best.blocks) {
      const std::size_t member = f_.bench->effect_of(b);
      if (member < f_.in_model) continue;
      const State rest = f_.bench->without(f_.best, member);
      const State changed = f_.bench->joined(rest, f_.bench->gains(rest, e), e);
      if (changed.blocks.size() == rest.blocks.size()) continue;
      const double score = rest.criterion - changed.criterion;
      if (score <= c.score) continue;
      c.score = score;
      c.p = f_.chance.corrected(p_of(*f_.bench, changed, e));
      if (as_good(changed)) c.aliases = {f_.terms[member].name()};
    }
  }

  /// Root mean square of the smallest such effect that the search would name nine times in ten.
  double minimal_detectable(std::size_t e, std::size_t block) const {
    const Workbench::Block& b = f_.bench->blocks()[block];
    State rest = f_.bench->holds(f_.best, e) ? f_.bench->without(f_.best, e) : f_.best;
    const MatrixXd basis = f_.bench->basis(rest);
    const MatrixXd columns = f_.bench->columns().middleCols(b.first, b.count);
    const double visible =
        (columns - basis * (basis.transpose() * columns)).squaredNorm() / columns.squaredNorm();
    const double s = f_.left();
    const double needed = std::sqrt(f_.bench->price(e, b.count)) + 1.28;  // Phi^-1(0.9)
    return s * needed / std::sqrt(f_.bench->readings() * std::max(visible, 1e-12));
  }

  /// In the model, whose curves may have fewer knots beside it.
  void fit_candidate(const State& with, Candidate& c) const {
    const std::size_t e = f_.bench->effect_of(with.blocks.back());
    std::vector<Term> terms = f_.of_model.fit.terms;
    for (std::size_t t = 0; t < terms.size(); ++t)
      if (with.blocks[t] != f_.start.blocks[t])
        terms[t].shape = f_.bench->blocks()[with.blocks[t]].shape;
    terms.push_back(c.term);
    const auto fitted =
        fit_near(f_.part.table, terms, std::vector<char>(terms.size(), 0), f_.weight, f_.noise);
    if (!fitted) return;
    c.rms = fitted->rms;
    c.cv_rms = rms_of(cross_validated(f_.part.table, terms, f_.weight), f_.weight);
    const Fit& from = f_.bench->holds(f_.best, e) ? f_.of_best.fit : *fitted;
    for (const Parameter& p : from.parameters)
      if (p.effect == c.term.name()) c.parameters.push_back(p);
    for (const Term& t : from.terms)
      if (t.name() == c.term.name()) c.term.shape = t.shape;
  }

  const Finding& f_;
};

}  // namespace

std::vector<Candidate> candidates_of(const Finding& finding) {
  const CandidateOf candidate(finding);
  std::vector<Candidate> out;
  for (std::size_t e = finding.in_model; e < finding.terms.size(); ++e) out.push_back(candidate(e));
  std::stable_sort(out.begin(), out.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  return out;
}

}  // namespace nonio::model
