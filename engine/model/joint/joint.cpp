// SPDX-License-Identifier: Apache-2.0
#include "nonio/model/joint.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "diagnosis/plans.h"
#include "diagnosis/verdict.h"
#include "fit/weights.h"
#include "joint/joint_search.h"
#include "nonio/math/distributions.h"
#include "search/finding.h"

namespace nonio::model {

namespace {

/// What a search has found, with values, p, plans and a verdict.
class JointReport {
 public:
  JointReport(const std::vector<Member>& members, const JointReadings& readings,
              const JointSearch& search)
      : of_(members), r_(readings), search_(search) {}

  JointExplanation made() const {
    JointExplanation out;
    put_candidates(out);
    put_effects(out);
    put_plans(out);
    put_campaigns(out);
    judge(out);
    return out;
  }

 private:
  void put_candidates(JointExplanation& out) const {
    for (const auto& [effect, one] : search_.scored({})) {
      if (!(one.evidence > -1e300) || !search_.system().solve({one.choice}).sound) continue;
      out.candidates.push_back(described({one.choice}, 0));
      out.candidates.back().evidence =
          one.evidence - evidence_of_weight(search_.weight_of(one.choice));
      out.candidates.back().weight = search_.weight_of(one.choice);
    }
    std::stable_sort(out.candidates.begin(), out.candidates.end(),
                     [](const JointEffect& a, const JointEffect& b) {
                       return a.evidence + evidence_of_weight(a.weight) >
                              b.evidence + evidence_of_weight(b.weight);
                     });
  }

  double rms_of(const std::vector<VectorXd>& left) const {
    double squares = 0.0;
    for (std::size_t m = 0; m < left.size(); ++m)
      squares += left[m].squaredNorm() * r_.members[m].s * r_.members[m].s;
    return std::sqrt(squares / search_.system().readings());
  }

  JointEffect described(const Choices& choices, std::size_t i) const {
    const Choice& c = choices[i];
    const JointBlock& block = r_.blocks[c.block];
    const auto solution = search_.system().solve_with_estimated_noise(choices);
    JointEffect out{.effect = block.effect, .holds = c.holds, .after = c.after};
    out.size = search_.size_of(choices, i);
    out.rms = rms_of(search_.system().residuals(choices, solution));
    out.p = search_.p_of(choices, i);
    const std::size_t groups = c.holds == Holds::shared    ? 1
                               : c.holds == Holds::changed ? 2
                                                           : r_.members.size();
    for (std::size_t g = 0; g < groups; ++g) {
      const auto [value, covariance] = search_.system().values(choices, solution, i, g);
      std::vector<Parameter> list;
      for (Index k = 0; k < value.size(); ++k) {
        const Effect& e = *block.is;
        const Effect::Parameter& p = e.linear[e.curve ? 0 : static_cast<std::size_t>(k)];
        list.push_back({block.effect, e.curve ? p.name + std::to_string(k + 1) : p.name, value(k),
                        std::sqrt(covariance(k, k)), quantity_of(p, block.axis)});
      }
      out.groups.push_back(std::move(list));
    }
    for (std::size_t k = 0; k < block.shape.size(); ++k) {
      const Effect::Parameter& p = block.is->shapes[k].parameter;
      if (!out.groups.empty())
        out.groups.front().push_back({block.effect, p.name, block.shape[k],
                                      std::numeric_limits<double>::quiet_NaN(),
                                      quantity_of(p, block.axis), true});
    }
    return out;
  }

  /// Adds to u what the searched shapes of the effect permit: the mean over all shapes, weighted by
  /// their likelihood, of the squared distances from the printed values.
  void add_shapes(JointEffect& effect, std::size_t i) const {
    const JointBlock& named = r_.blocks[search_.choices()[i].block];
    if (named.searched == 0) return;
    constexpr double out_of_sight = 25.0;  // of -2 ln of the likelihood
    const auto gains = search_.system().gains(without(search_.choices(), i), search_.y());
    const MatrixXd& gain = search_.choices()[i].holds == Holds::own ? gains.own : gains.shared;
    const double best = gain(static_cast<Index>(search_.choices()[i].block), 0);
    const double least = search_.criterion(search_.choices());
    std::vector<std::vector<double>> squares;  // of each group and parameter
    for (const auto& group : effect.groups) squares.emplace_back(group.size(), 0.0);
    double weights = 0.0;
    for (std::size_t b = 0; b < r_.blocks.size(); ++b) {
      const JointBlock& block = r_.blocks[b];
      if (block.effect != named.effect || block.count != named.count ||
          !(gain(static_cast<Index>(b), 0) > best - out_of_sight))
        continue;
      Choices choices = search_.choices();
      choices[i].block = b;
      const auto solution = search_.system().solve(choices);
      if (!solution.sound) continue;
      const double weight = std::exp(-0.5 * (solution.criterion() - least));
      weights += weight;
      for (std::size_t g = 0; g < effect.groups.size(); ++g) {
        const VectorXd value = search_.system().values(choices, solution, i, g).first;
        Index linear = 0;
        std::size_t shape = 0;
        for (std::size_t k = 0; k < effect.groups[g].size(); ++k) {
          const Parameter& p = effect.groups[g][k];
          const double now = p.shape                 ? block.shape[shape++]
                             : linear < value.size() ? value(linear++)
                                                     : p.value;
          squares[g][k] += weight * (now - p.value) * (now - p.value);
        }
      }
    }
    for (std::size_t g = 0; g < effect.groups.size(); ++g)
      for (std::size_t k = 0; k < effect.groups[g].size(); ++k) {
        Parameter& p = effect.groups[g][k];
        const double u = std::sqrt(squares[g][k] / weights);
        if (!p.shape)
          p.u = std::hypot(p.u, u);
        else if (u > 0.0)
          p.u = u;
      }
  }

  /// Whether another effect that changes at the same date explains the readings as well.
  bool changes_as_well(Choices rest, const Choice& named, Choice other, double least) const {
    other.holds = named.holds, other.after = named.after;
    rest.push_back(other);
    return search_.criterion(rest) < least + alias_evidence;
  }

  void put_effects(JointExplanation& out) const {
    const double all = search_.criterion(search_.choices());
    for (std::size_t i = 0; i < search_.choices().size(); ++i) {
      JointEffect effect = described(search_.choices(), i);
      add_shapes(effect, i);
      effect.p = search_.unweighted().corrected(effect.p);
      effect.weight = search_.weight_of(search_.choices()[i]);
      const Choices rest = without(search_.choices(), i);
      const double before = search_.criterion(rest);
      const double evidence = before - all;
      effect.evidence = evidence - evidence_of_weight(effect.weight);
      for (const auto& [name, one] : search_.scored(rest))
        if (name != effect.effect &&
            (one.evidence > evidence - alias_evidence ||
             (effect.holds == Holds::changed &&
              changes_as_well(rest, search_.choices()[i], one.choice, all))))
          effect.aliases.push_back(name);
      out.effects.push_back(std::move(effect));
    }
  }

  void put_campaigns(JointExplanation& out) const {
    const auto left =
        search_.system().residuals(search_.choices(), search_.system().solve(search_.choices()));
    std::vector<VectorXd> before;
    for (std::size_t m = 0; m < left.size(); ++m) {
      const MemberReadings& member = r_.members[m];
      JointExplanation::Campaign one;
      one.readings = static_cast<std::size_t>(member.readings);
      one.floor = member.floor;
      before.push_back(member.y);
      one.rms = member.s * std::sqrt(member.y.squaredNorm() / member.readings);
      one.rms_after = member.s * std::sqrt(left[m].squaredNorm() / member.readings);
      for (Index i = 0; i < left[m].size(); ++i)
        one.residual.push_back(member.scale(i) > 0.0 ? left[m](i) * member.scale(i)
                                                     : std::numeric_limits<double>::quiet_NaN());
      out.campaigns.push_back(std::move(one));
    }
    out.rms = rms_of(before);
    out.rms_after = rms_of(left);
    out.noise = std::sqrt(search_.noise2());
    out.trials = search_.unweighted().trials;
  }

  /// By column of `y`: sum of n times the squared mean over cells with n >= 2 weighted readings.
  VectorXd of_cells(const std::vector<MatrixXd>& y) const {
    VectorXd out = VectorXd::Zero(y.front().cols());
    for (std::size_t m = 0; m < y.size(); ++m) {
      const MemberReadings& member = r_.members[m];
      MatrixXd sum = MatrixXd::Zero(static_cast<Index>(member.cells), y[m].cols());
      VectorXd n = VectorXd::Zero(sum.rows());
      for (Index i = 0; i < y[m].rows(); ++i) {
        if (!(member.scale(i) > 0.0)) continue;
        const auto cell = static_cast<Index>(member.cell[static_cast<std::size_t>(i)]);
        sum.row(cell) += y[m].row(i), n(cell) += 1.0;
      }
      for (Index k = 0; k < n.size(); ++k)
        if (n(k) > 1.0) out += sum.row(k).cwiseAbs2().transpose() / n(k);
    }
    return out;
  }

  /// Tests whether the cell means differ from the model by more than the scatter of passes.
  void judge(JointExplanation& out) const {
    std::vector<MatrixXd> left;
    for (const VectorXd& e :
         search_.system().residuals(search_.choices(), search_.system().solve(search_.choices())))
      left.emplace_back(e);
    const double found = of_cells(left)(0);
    const VectorXd chance = of_cells(search_.flipped());
    double mean = 0.0, squares = 0.0, n = 0.0;
    // Odd columns of `flipped` have flipped signs of whole passes.
    for (Index k = 1; k < flipped_copies; k += 2) mean += chance(k), ++n;
    mean /= n;
    for (Index k = 1; k < flipped_copies; k += 2) squares += std::pow(chance(k) - mean, 2);
    const double s = std::sqrt(squares / (n - 1.0));
    const double t = math::test_ratio(found - mean, s);
    out.p_left = t > 0.0 ? 0.5 * math::t_two_sided(t, n - 1.0) : 1.0;
    const double size = std::sqrt(std::max(found - mean, 0.0) / search_.system().readings());
    out.explains_all = !(out.p_left < lacks_fit_p && size > least_left);
    if (out.effects.empty() && out.explains_all) out.single = shown_by_one();
    if (!out.effects.empty())
      out.verdict = Verdict::Kind::missing;
    else if (!out.explains_all || out.single)
      out.verdict = Verdict::Kind::unknown;
  }

  /// What is in one campaign only is invisible among the values of many, but not in that campaign.
  /// At most 5 % of the copies with flipped stretches may show as much anywhere. Copies with flipped
  /// passes are not used: with few passes, many of them have the signs that the effect has.
  std::optional<JointExplanation::Single> shown_by_one() const {
    const auto found = search_.system().single(search_.y()),
               chance = search_.system().single(search_.flipped());
    double as_much = 0.0;
    for (Index k = 0; k < flipped_copies; k += 2)
      as_much += chance.deviate(k) >= found.deviate(0) ? 1.0 : 0.0;
    if (as_much > 0.05 * 0.5 * static_cast<double>(flipped_copies)) return std::nullopt;
    const JointBlock& block = r_.blocks[found.block];
    const MemberReadings& member = r_.members[found.member];
    const auto q = static_cast<double>(member.rank[found.block] + block.searched);
    const double p = math::f_upper(found.fall / q, q, member.dof) *
                     static_cast<double>(search_.system().effects() * r_.members.size());
    if (!(p < differs_below)) return std::nullopt;
    return JointExplanation::Single{block.effect, found.member, p};
  }

  /// Null if the catalog of the campaign does not contain the effect.
  static const Term* term_of(const Member& member, const std::string& effect) {
    for (const Term& term : member.catalogue)
      if (term.name() == effect) return &term;
    return nullptr;
  }

  /// The values are those of campaign m; std::nullopt if the campaign does not determine the
  /// effect.
  std::optional<Candidate> candidate_of(const JointEffect& effect, std::size_t m) const {
    const Term* const term = term_of(of_[m], effect.effect);
    const std::size_t g = effect.holds == Holds::shared    ? 0
                          : effect.holds == Holds::changed ? (m < effect.after ? 0 : 1)
                                                           : m;
    if (term == nullptr || g >= effect.groups.size() || effect.groups[g].empty())
      return std::nullopt;
    Candidate one;
    one.term = *term;
    one.aliases = effect.aliases;
    for (const Parameter& p : effect.groups[g])
      if (!p.shape) one.parameters.push_back(p);
    one.term.shape.clear();
    for (const Parameter& p : effect.groups.front())
      if (p.shape) one.term.shape.push_back(p.value);
    return one;
  }

  void put_plans(JointExplanation& out) const {
    // Campaigns of one machine have similar plans, so plans for at most this number are compared.
    constexpr std::size_t most_campaigns = 8;
    const std::size_t step = (of_.size() + most_campaigns - 1) / most_campaigns;
    for (const JointEffect& effect : out.effects) {
      std::optional<JointPlan> best;
      for (std::size_t m = of_.size() - 1; m < of_.size() && !effect.aliases.empty(); m -= step) {
        const auto candidate = candidate_of(effect, m);
        if (!candidate) continue;
        std::vector<Term> model = of_[m].model;
        for (const JointEffect& other : out.effects)
          if (const Term* const term = term_of(of_[m], other.effect);
              term != nullptr && other.effect != effect.effect)
            model.push_back(*term);
        for (Plan& plan :
             plans_for(*of_[m].part, model, *candidate, of_[m].catalogue, r_.members[m].s))
          if (!best || is_better(plan, best->plan)) best = {m, std::move(plan)};
      }
      if (best) out.plans.push_back(std::move(*best));
    }
  }

  const std::vector<Member>& of_;
  const JointReadings& r_;
  const JointSearch& search_;
};

JointExplanation explained(const std::vector<Member>& members, const JointReadings& readings,
                           std::uint64_t seed) {
  JointSearch search(members, readings, seed);
  search.run();
  return JointReport(members, readings, search).made();
}

}  // namespace

namespace {

/// The members with the terms of the effects, with their shapes, of which the noise is free.
std::vector<Member> with_found(std::vector<Member> members, const JointExplanation& x) {
  for (Member& member : members)
    for (const JointEffect& effect : x.effects)
      for (Term term : member.catalogue) {
        if (term.name() != effect.effect) continue;
        term.shape.clear();
        for (const Parameter& p : effect.groups.front())
          if (p.shape) term.shape.push_back(p.value);
        member.found.push_back(std::move(term));
      }
  return members;
}

}  // namespace

/// Drifts that no member has in its model look like zeros of passes, which hide what is constant in
/// a pass. If the effects found take most of these zeros away, the search is made with what is left.
Expected<JointExplanation> explain_together(const std::vector<Member>& members,
                                            std::uint64_t seed) {
  constexpr double most_left = 0.5;
  NONIO_TRY(const auto readings, read_together(members));
  JointExplanation first = explained(members, readings, seed);
  if (first.effects.empty() || readings.offsets == 0.0) return first;
  const std::vector<Member> knowing = with_found(members, first);
  const auto again = read_together(knowing);
  if (!again || again->offsets > most_left * readings.offsets) return first;
  return explained(knowing, *again, seed);
}

}  // namespace nonio::model
