// SPDX-License-Identifier: Apache-2.0
#include "candidates.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "data/pass_zeros.h"
#include "fit/weights.h"
#include "nonio/math/distributions.h"

namespace nonio::model {

namespace {

using State = Workbench::State;

/// In space, an effect that replaces a member of the best model with this loss of evidence is no
/// alias; other shapes of the remaining effects are then not tried: docs/dev/constants.md, M41.
constexpr double hopeless = 100.0;

double normal_below(double x) { return 0.5 * std::erfc(-x * std::numbers::sqrt2 / 2.0); }

/// In units of the variance of a reading, an effect reduces the sum of squares by about (sqrt(a^2 +
/// k - 1) + z)^2: a^2 detectable sum of squares, k number of unknowns, z standard normal.
class Sizes {
 public:
  Sizes(const Finding& f, std::size_t effect, bool member)
      : f_(f), effect_(effect), s_(f.left()), dof_(std::max(f.dof(f.best), 1.0)) {
    const MatrixXd basis = f.bench->basis(member ? f.bench->without(f.best, effect) : f.best);
    for (const std::size_t b : f.bench->instances()[effect].blocks) {
      const Workbench::Block& block = f.bench->blocks()[b];
      if (!are_usual(f.terms[effect], block.shape)) continue;
      const auto columns = f.bench->columns().middleCols(block.first, block.count);
      const double hidden =
          math::transposed_product(basis, columns).squaredNorm() / columns.squaredNorm();
      const auto [seen, dof] = next_to_zeros(block);
      shown_.push_back({std::max((1.0 - hidden) * seen, 1e-12), wanted(block, dof),
                        static_cast<double>(Workbench::unknowns_of(block))});
    }
    // The tenth of the shapes that these readings show least is omitted.
    std::sort(shown_.begin(), shown_.end(),
              [](const Shown& a, const Shown& b) { return a.visible > b.visible; });
    shown_.resize(shown_.size() - shown_.size() / 10);
  }

  /// RMS, m or rad, that is detected with a probability of 0.9, on average over the grid.
  double smallest() const {
    if (shown_.empty()) return 0.0;
    double low = 0.0, high = 1e4;  // size over all readings, in standard deviations of a reading
    for (int step = 0; step < 50; ++step) {
      const double a = (low + high) / 2.0;
      double found = 0.0;
      for (const Shown& one : shown_)
        found += normal_below(std::sqrt(a * a * one.visible + one.unknowns - 1.0) - one.wanted);
      (found < 0.9 * static_cast<double>(shown_.size()) ? low : high) = a;
    }
    return high * s_ / std::sqrt(f_.bench->readings());
  }

  /// Near the detection limit, an effect is found only if noise enlarges it.
  double bias(const Workbench::Block& block) const {
    const double fall = f_.bench->without(f_.best, effect_).squares - f_.best.squares;
    const double a = std::sqrt(std::max(fall, 0.0)) / s_;
    const double over = a - wanted(block, next_to_zeros(block).dof);
    if (!(a > 0.0)) return 1.0;
    const double density = std::exp(-over * over / 2.0) / std::sqrt(2.0 * std::numbers::pi);
    return 1.0 + density / normal_below(over) / a;
  }

 private:
  struct Shown {
    double visible, wanted, unknowns;
  };

  struct NextToZeros {
    double seen, dof;
  };
  /// If zeros of passes are noise: remaining share of the sum of squares, and degrees of freedom.
  NextToZeros next_to_zeros(const Workbench::Block& block) const {
    if (f_.noise.zero == Noise::Zero::steady) return {1.0, dof_};
    Term term = f_.terms[effect_];
    term.shape = block.shape;
    const auto columns = f_.columns_of({term});
    if (!columns) return {1.0, dof_};
    MatrixXd white = f_.bench->white()(*columns);
    f_.bench->white().take_out_zeros(white);
    MatrixXd plain = f_.bench->root_weight().asDiagonal() * *columns;
    take_out_zeros(f_.part.table, f_.bench->root_weight(), plain);
    const double all = plain.squaredNorm();
    return {all > 0.0 ? std::min(white.squaredNorm() / all, 1.0) : 1.0,
            share_of_passes(f_.repeats, *columns) < 0.5
                ? dof_
                : std::max(degrees_of_passes(f_.repeats), 1.0)};
  }

  /// Square root of the smallest decrease of squares, in units of the variance of a reading, that
  /// satisfies the limits of evidence, significance and size.
  double wanted(const Workbench::Block& block, double dof) const {
    const double n = f_.bench->readings();
    const auto k = static_cast<double>(Workbench::unknowns_of(block));
    const double price = f_.bench->price(block);
    if (price == price_ && k == unknowns_ && dof == of_dof_) return wanted_;
    price_ = price, unknowns_ = k, of_dof_ = dof;
    const double by_evidence = dof_ * std::expm1(price / n);
    const double one_test =
        -std::expm1(std::log1p(-named_below) / f_.chance.trials) * f_.bench->weight(block.effect);
    double low = 0.0, high = 1e4;
    for (int step = 0; step < 40; ++step) {
      const double F = (low + high) / 2.0;
      (math::f_upper(F, k, dof) > one_test ? low : high) = F;
    }
    wanted_ = std::sqrt(std::max({by_evidence, high * k, least_rms * least_rms * n}));
    return wanted_;
  }

  const Finding& f_;
  std::size_t effect_;
  double s_, dof_;
  std::vector<Shown> shown_;
  // cached last result and its arguments
  mutable double price_ = -1.0, unknowns_ = 0.0, of_dof_ = 0.0, wanted_ = 0.0;
};

class CandidateOf {
 public:
  CandidateOf(const Finding& finding, const Ground& ground) : f_(finding), ground_(ground) {}

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
    c.alone = f_.start.criterion - alone.criterion;
    double of_weight = f_.bench->evidence_of_weight(alone, e);
    const double of_weight_alone = of_weight;
    const bool member = f_.bench->holds(f_.best, e);
    std::size_t block = alone.blocks.back();
    if (member) {
      for (const std::size_t b : f_.best.blocks)
        if (f_.bench->effect_of(b) == e) block = b;
      c.within = f_.bench->settled(f_.bench->without(f_.best, e)).criterion - f_.best.criterion;
      c.p = f_.unweighted.corrected(f_.p_of(e));
      of_weight = f_.bench->evidence_of_weight(f_.best, e);
      c.aliases = aliases_of(e);
    } else {
      score_outsider(e, c);
      c.within = c.score;
    }
    c.score = c.within > 0.0 && c.alone > 0.0 ? c.alone : c.within;
    c.alone -= of_weight_alone, c.within -= of_weight;
    if (c.term.library && !member && c.aliases.empty()) {
      c.visible = false;
      return c;
    }
    c.term.shape = f_.bench->blocks()[block].shape;
    const Sizes sizes(f_, e, member);
    c.minimal_detectable = sizes.smallest();
    fit_candidate(c);
    if (member) c.bias = sizes.bias(f_.bench->blocks()[block]);
    return c;
  }

  /// Effects that can replace a member with hardly any loss of evidence; for a curve also causes
  /// with nearly its form (`is_form_of`); and effects of `Finding::otherwise`.
  std::vector<std::string> aliases_of(std::size_t member) const {
    std::vector<std::string> names;
    const State rest = f_.bench->without(f_.best, member);
    const Workbench::Gains gains = f_.bench->gains(rest);
    for (std::size_t other = f_.in_model; other < f_.terms.size(); ++other) {
      if (other == member || f_.bench->holds(f_.best, other) || are_same_effect(other, member) ||
          is_preferred_to_cause(member, other))
        continue;
      State changed = f_.bench->joined(rest, gains, other);
      if ((f_.bench->in_space() || member < f_.in_model) &&
          !(changed.criterion < f_.best.criterion + hopeless))
        continue;
      // On one axis, nearly every effect of the model has an imitation with more parameters.
      if (member < f_.in_model && !f_.bench->in_space() && changed.parameters > f_.best.parameters)
        continue;
      changed = f_.bench->settled(std::move(changed));
      if ((changed.blocks.size() > rest.blocks.size() && as_good(changed)) ||
          (member >= f_.in_model && f_.terms[member].effect->curve && is_form_of(other)))
        names.push_back(f_.terms[other].name());
    }
    if (member < f_.in_model) return names;
    for (const std::string& name : f_.otherwise)
      if (!f_.bench->holds(f_.best, f_.index_of(name)) &&
          std::find(names.begin(), names.end(), name) == names.end())
        names.push_back(name);
    return names;
  }

 private:
  /// Whether both are one effect, of which one form has a value for each measurement or state: that
  /// form contains the other, so there is nothing to separate.
  bool are_same_effect(std::size_t a, std::size_t b) const {
    return f_.terms[a].of_all() == f_.terms[b].of_all();
  }

  /// Whether an effect of the catalog, without a shape that was searched, is named without a cause of
  /// the library that looks like it: that one would need more than these readings, unless a quantity
  /// was recorded that no effect of the catalog depends on.
  bool is_preferred_to_cause(std::size_t effect, std::size_t cause) const {
    const Observations& o = f_.part.table;
    return f_.terms[cause].library && !f_.terms[effect].library &&
           f_.terms[effect].effect->shapes.empty() && o.air.empty() && o.pressure.empty() &&
           o.humidity.empty();
  }

  /// Whether a cause with fewer parameters explains nearly as much: a curve can follow any shape,
  /// while the shape of a cause is only approximately known.
  bool is_form_of(std::size_t cause) const {
    if (!f_.terms[cause].library) return false;
    const State alone = f_.bench->joined(f_.start, f_.bench->gains(f_.start, cause), cause);
    return alone.parameters < f_.best.parameters &&
           alone.squares - f_.best.squares <
               unexplained_share * (f_.start.squares - f_.best.squares);
  }

  /// Whether the change loses hardly any evidence, or hardly any likelihood apart from the cost of
  /// additional columns, because the cost of the search must not decide. In space, where one curve
  /// can contain another effect completely, the cost of parameters is ignored as well.
  bool as_good(const State& changed) const {
    if (changed.criterion < f_.best.criterion + alias_evidence) return true;
    const double n = f_.bench->readings();
    const double lost = n * std::log(changed.squares / f_.best.squares);
    if (f_.part.table.axes.size() > 1) return lost < alias_evidence;
    return lost + static_cast<double>(std::max<Index>(0, columns(changed) - columns(f_.best))) *
                      std::log(n) <
           alias_evidence;
  }

  Index columns(const State& state) const {
    Index sum = 0;
    for (const std::size_t b : state.blocks) sum += f_.bench->blocks()[b].count;
    return sum;
  }

  /// Evidence if the effect is added to the best explanation, or replaces a member.
  void score_outsider(std::size_t e, Candidate& c) const {
    const State more = f_.bench->joined(f_.best, f_.bench->gains(f_.best, e), e);
    if (more.blocks.size() > f_.best.blocks.size()) {
      c.score = f_.best.criterion - more.criterion;
      c.p = f_.unweighted.corrected(p_of(*f_.bench, more, e));
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
      c.p = f_.unweighted.corrected(p_of(*f_.bench, changed, e));
      if (as_good(changed) && !are_same_effect(e, member) && !is_preferred_to_cause(member, e))
        c.aliases = {f_.terms[member].name()};
    }
  }

  /// The RMS must be that of `nonio model add`: all shapes are searched again, and readings have
  /// the weights of a comparison.
  void fit_candidate(Candidate& c) const {
    const std::vector<Term> model(f_.terms.begin(),
                                  f_.terms.begin() + static_cast<std::ptrdiff_t>(f_.in_model));
    const std::vector<Term> terms = with_term(model, f_.terms[f_.index_of(c.term.name())]);
    const auto fitted = fit(f_.part.table, terms, ground_.weight, ground_.noise);
    if (!fitted) return;
    c.rms = fitted->rms;
    c.cv_rms =
        rms_of(cross_validated(f_.part.table, fitted->terms, ground_.weight), ground_.weight);
    const bool member = f_.bench->holds(f_.best, f_.index_of(c.term.name()));
    const Fit& from = member && !c.term.differences ? f_.of_best.fit : *fitted;
    for (const Parameter& p : from.parameters)
      if (p.effect == c.term.name()) c.parameters.push_back(p);
    for (const Term& t : from.terms)
      if (t.name() == c.term.name()) c.term.shape = t.shape;
  }

  const Finding& f_;
  const Ground& ground_;
};

}  // namespace

std::vector<Candidate> candidates_of(const Finding& finding, const Ground& ground) {
  const CandidateOf candidate(finding, ground);
  std::vector<Candidate> out;
  for (std::size_t e = finding.in_model; e < finding.terms.size(); ++e) {
    Candidate c = candidate(e);
    if (c.visible || !c.term.library) out.push_back(std::move(c));
  }
  rank(out);
  return out;
}

std::vector<Replaceable> replaceable_in(const Finding& finding, const Ground& ground) {
  const CandidateOf candidate(finding, ground);
  std::vector<Replaceable> out;
  for (std::size_t e = 0; e < finding.in_model; ++e) {
    const Term& term = finding.terms[e];
    if (term.effect->is_nuisance || !finding.bench->holds(finding.best, e)) continue;
    std::vector<std::string> by = candidate.aliases_of(e);
    if (!by.empty()) out.push_back({term.name(), std::move(by)});
  }
  return out;
}

void rank(std::vector<Candidate>& candidates) {
  const auto before = [](const Candidate& a, const Candidate& b) {
    const auto shows = [](const Candidate& c) {
      return c.alone + evidence_of_weight(c.term.weight) > 0.0 && c.score > 0.0;
    };
    const bool a_shows = shows(a), b_shows = shows(b);
    return a_shows != b_shows ? a_shows : a.score > b.score;
  };
  std::stable_sort(candidates.begin(), candidates.end(), before);
  for (std::size_t i = 1; i < candidates.size(); ++i)
    candidates[i].score = std::min(candidates[i].score, candidates[i - 1].score);
}

}  // namespace nonio::model
