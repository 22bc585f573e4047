// SPDX-License-Identifier: Apache-2.0
#include "nonio/model/joint.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "diagnosis/plans.h"
#include "diagnosis/verdict.h"
#include "fit/weights.h"
#include "joint/system.h"
#include "nonio/math/distributions.h"
#include "search/finding.h"

namespace nonio::model {

namespace {

constexpr std::size_t most_effects = 8;
// Smallest RMS of a named effect, as a fraction of the noise: docs/dev/constants.md, M46.
constexpr double least_joint_rms = 0.1;
// p of differences, and share of flipped copies that differ as much: docs/dev/constants.md, M47.
constexpr double differs_below = 0.001, as_much_as_noise = 0.01;
constexpr Index shuffles = 200;  // half by stretches, half by whole passes
// With many campaigns, the date of a change is searched in steps, then between them.
constexpr std::size_t most_dates = 32;

class JointSearch {
 public:
  JointSearch(const std::vector<Member>& members, const JointReadings& readings, std::uint64_t seed)
      : of_(members), r_(readings), system_(readings), seed_(seed) {
    for (const MemberReadings& m : r_.members) {
      y_.emplace_back(m.y);
      dof_ += m.dof;
      noise2_ += m.readings * m.s * m.s;
    }
    noise2_ /= system_.readings();
  }

  JointExplanation run() {
    JointExplanation out;
    put_candidates(out);
    find();
    prefer_pairs();
    prune();
    settle_differences();
    put_effects(out);
    put_plans(out);
    put_campaigns(out);
    judge(out);
    return out;
  }

 private:
  using Choices = std::vector<Choice>;
  struct Scored {
    Choice choice;
    double evidence = -std::numeric_limits<double>::infinity();
  };

  /// The best block, with the best `Holds`, of each effect that is not in `choices`.
  std::map<std::string, Scored> scored(const Choices& choices, const std::string& only = "") const {
    const auto gains = system_.gains(choices, y_);
    std::map<std::string, Scored> best;
    for (std::size_t b = 0; b < r_.blocks.size(); ++b) {
      const JointBlock& block = r_.blocks[b];
      if (block.count == 0 || (!only.empty() && block.effect != only)) continue;
      const auto row = static_cast<Index>(b);
      const double price = system_.price_of(block);
      Scored& known = best[block.effect];
      const auto offer = [&](Holds holds, double evidence) {
        if (evidence > known.evidence) known = {{b, holds}, evidence};
      };
      offer(Holds::shared, gains.shared(row, 0) - price -
                               static_cast<double>(block.count) * std::log(system_.readings()));
      offer(Holds::own, gains.own(row, 0) - price - gains.own_price[b]);
    }
    for (const Choice& c : choices) best.erase(r_.blocks[c.block].effect);
    return best;
  }

  /// Among nearly equal effects, returns that with the fewest unknowns.
  Scored simplest(const std::map<std::string, Scored>& all) const {
    Scored best;
    for (const auto& [effect, one] : all)
      if (one.evidence > best.evidence) best = one;
    const double least = best.evidence - alias_evidence;
    const auto unknowns = [&](const Scored& one) {
      const JointBlock& block = r_.blocks[one.choice.block];
      return block.count + block.searched;
    };
    for (const auto& [effect, one] : all)
      if (one.evidence > least && unknowns(one) < unknowns(best)) best = one;
    return best;
  }

  void find() {
    while (choices_.size() < most_effects) {
      const Scored best = simplest(scored(choices_));
      if (!(best.evidence > 0.0)) return;
      choices_.push_back(best.choice);
      if (!system_.solve(choices_).sound) {
        choices_.pop_back();
        return;
      }
      settle();
      prefer_simpler();
    }
  }

  /// Replaces an effect by one with fewer unknowns that explains the readings equally well.
  void prefer_simpler() {
    const auto unknowns = [&](std::size_t b) { return r_.blocks[b].count + r_.blocks[b].searched; };
    for (std::size_t i = 0; i < choices_.size(); ++i)
      for (const auto& [effect, one] : scored(without(choices_, i))) {
        if (unknowns(one.choice.block) >= unknowns(choices_[i].block)) continue;
        const Choices before = choices_;
        const double least = criterion(choices_) + alias_evidence;
        choices_[i] = one.choice;
        settle(i);
        if (!(criterion(choices_) < least)) choices_ = before;
      }
  }

  /// Replaces an effect with searched shapes by two others, if they explain the readings better: a
  /// warm-up with its fixed point imitates a growth about one end, which is a growth and a drift.
  void prefer_pairs() {
    for (std::size_t i = 0; i < choices_.size();) {
      const std::size_t next = i + 1;
      if (r_.blocks[choices_[i].block].searched == 0 || choices_.size() >= most_effects) {
        i = next;
        continue;
      }
      const Choices before = choices_;
      const std::string effect = r_.blocks[before[i].block].effect;
      choices_ = without(before, i);
      bool added = true;
      for (int k = 0; k < 2 && added; ++k) {
        auto all = scored(choices_);
        all.erase(effect);
        const Scored best = simplest(all);
        added = best.evidence > 0.0;
        if (!added) break;
        choices_.push_back(best.choice);
        settle();
      }
      // Where it was replaced, another effect is at i now.
      if (!added || !(criterion(choices_) < criterion(before))) choices_ = before, i = next;
    }
  }

  static Choices without(Choices choices, std::size_t i) {
    choices.erase(choices.begin() + static_cast<std::ptrdiff_t>(i));
    return choices;
  }

  /// Blocks of this curve with more knots that all of its members determine, most first, and the
  /// block itself. What a curve with few
  /// knots leaves is the same in all campaigns and must not look like another effect, or, where
  /// campaigns measure other parts of the travel, like a difference.
  std::vector<std::size_t> finer(std::size_t block) const {
    std::vector<std::size_t> out{block};
    const auto lack = [&](std::size_t b) {
      return std::any_of(r_.members.begin(), r_.members.end(), [&](const MemberReadings& m) {
        return m.first[block] >= 0 && m.first[b] < 0;
      });
    };
    for (std::size_t b = 0; b < r_.blocks.size() && r_.blocks[block].is->curve; ++b)
      if (r_.blocks[b].effect == r_.blocks[block].effect &&
          r_.blocks[b].count > r_.blocks[block].count && !lack(b))
        out.push_back(b);
    std::stable_sort(out.begin(), out.end(), [&](std::size_t one, std::size_t other) {
      return r_.blocks[one].count > r_.blocks[other].count;
    });
    return out;
  }

  /// The choices with as many knots of curves as the readings determine, except that of effect `i`.
  Choices with_all_knots(Choices choices, std::size_t except) const {
    for (std::size_t i = 0; i < choices.size(); ++i) {
      if (i == except) continue;
      for (const std::size_t b : finer(choices[i].block)) {
        choices[i].block = b;
        if (system_.solve(choices).sound) break;
      }
    }
    return choices;
  }

  double criterion(const Choices& choices) const {
    const auto s = system_.solve(choices);
    return s.sound ? s.criterion() : std::numeric_limits<double>::infinity();
  }

  /// Searches shapes and `holds` of each effect again with the others fixed, at most four times.
  void settle() {
    for (int round = 0; round < 4; ++round) {
      bool any = false;
      for (std::size_t i = 0; i < choices_.size(); ++i) any = settle(i) || any;
      if (!any) return;
    }
  }

  /// Returns whether the shape, `holds` or the date of the effect changed.
  bool settle(std::size_t i) {
    const Choice before = choices_[i];
    const std::string effect = r_.blocks[before.block].effect;
    const auto best = scored(without(choices_, i), effect);
    if (const auto found = best.find(effect); found != best.end())
      choices_[i] = found->second.choice;
    if (criterion(choices_) > 1e300) choices_[i] = before;
    choices_[i].holds = Holds::shared;
    const bool differs = p_same(i) < differs_below;
    if (differs || criterion(choices_) > 1e300) {
      choices_[i].holds = Holds::own;
      if (differs) look_for_date(i);
    }
    const Choice& now = choices_[i];
    return now.block != before.block || now.holds != before.holds || now.after != before.after;
  }

  /// One change between two campaigns replaces separate values, if it reduces the criterion and
  /// leaves no other significant difference.
  void look_for_date(std::size_t i) {
    const std::size_t n = r_.members.size();
    const Choice own = choices_[i];
    if (n < 3 || std::any_of(of_.begin(), of_.end(),
                             [&](const Member& m) { return m.machine != of_.front().machine; }))
      return;
    double least = criterion(choices_);
    const auto offer = [&](std::size_t after) {
      Choices other = choices_;
      other[i].holds = Holds::changed, other[i].after = after;
      const double now = criterion(other);
      if (now < least) choices_ = std::move(other), least = now;
    };
    const std::size_t step = std::max<std::size_t>(1, (n - 1) / most_dates);
    for (std::size_t after = 1; after < n; after += step) offer(after);
    if (choices_[i].holds != Holds::changed) return;
    const std::size_t about = choices_[i].after;
    for (std::size_t k = 1; k < step; ++k) {
      if (about > k) offer(about - k);
      if (about + k < n) offer(about + k);
    }
    if (p_same(i) < differs_below) choices_[i] = own;
  }

  /// p of the differences between campaigns beyond those that the choice allows.
  double p_same(std::size_t i) const {
    Choices same = with_all_knots(choices_, i);
    for (const std::size_t b : finer(choices_[i].block)) {
      same[i].block = b;
      Choices own = same;
      own[i].holds = Holds::own;
      const auto one = system_.solve(same), each = system_.solve(own);
      if (!one.sound || !each.sound) continue;
      const auto q = static_cast<double>(each.parameters - one.parameters);
      return q >= 1.0 ? math::f_upper((one.squares - each.squares) / q, q, dof_) : 1.0;
    }
    return 1.0;
  }

  /// F-test against the noise of the repeats, corrected for the dates of a change only.
  double p_of(const Choices& chosen, std::size_t i) const {
    const Choices choices = with_all_knots(chosen, i);
    const auto all = system_.solve(choices), rest = system_.solve(without(choices, i));
    const JointBlock& block = r_.blocks[choices[i].block];
    const auto q = static_cast<double>(all.parameters - rest.parameters + block.searched);
    const double p = math::f_upper((rest.squares - all.squares) / q, q, dof_);
    const auto dates = static_cast<double>(r_.members.size() - 1);
    return choices[i].holds == Holds::changed ? std::min(1.0, dates * p) : p;
  }

  double weight_of(const Choice& choice) const { return r_.blocks[choice.block].weight; }

  double size_of(const Choices& choices, std::size_t i) const {
    const double fall = system_.solve(without(choices, i)).squares - system_.solve(choices).squares;
    return std::sqrt(std::max(fall, 0.0) * noise2_ / system_.readings());
  }

  /// Copies of the residuals, one per column, with random signs: of short stretches in even
  /// columns, of whole passes in odd ones. They have the expected size of the noise, because the
  /// fit makes residuals smaller.
  std::vector<MatrixXd> flipped() const {
    const auto left = system_.residuals(choices_, system_.solve(choices_));
    std::mt19937_64 random(seed_);
    std::vector<MatrixXd> out;
    for (std::size_t m = 0; m < left.size(); ++m) {
      const MemberReadings& member = r_.members[m];
      const double free = std::max(member.readings - static_cast<double>(member.unknowns), 1.0);
      const VectorXd e = left[m] * std::sqrt(member.readings / free);
      MatrixXd noise(e.size(), shuffles);
      for (Index k = 0; k < shuffles; ++k) {
        const std::size_t stretch = k % 2 == 0 ? stretch_of_signs : whole_pass;
        std::map<std::pair<std::uint32_t, std::size_t>, double> sign;
        std::map<std::uint32_t, std::size_t> in_pass;
        for (Index i = 0; i < e.size(); ++i) {
          const std::uint32_t pass = member.pass[static_cast<std::size_t>(i)];
          const auto [at, is_new] = sign.try_emplace({pass, in_pass[pass]++ / stretch}, 0.0);
          if (is_new) at->second = (random() & 1) != 0 ? 1.0 : -1.0;
          noise(i, k) = at->second * e(i);
        }
      }
      out.push_back(std::move(noise));
    }
    return out;
  }

  /// The largest number of independent tests that gives the observed median or 5 % quantile of the
  /// smallest p of a copy, with flipped stretches or with flipped passes.
  double trials_of(const JointSystem::Gains& gains, bool weighted) const {
    std::vector<double> least[2];
    for (Index k = 0; k < shuffles; ++k) {
      double p = 1.0;
      for (std::size_t b = 0; b < r_.blocks.size(); ++b) {
        const auto row = static_cast<Index>(b);
        const auto test = [&](double fall, Index parameters) {
          const auto q = static_cast<double>(parameters + r_.blocks[b].searched);
          if (std::isfinite(fall) && q >= 1.0)
            p = std::min(p,
                         math::f_upper(fall / q, q, dof_) / (weighted ? r_.blocks[b].weight : 1.0));
        };
        test(gains.shared(row, k), r_.blocks[b].count);
        test(gains.own(row, k), gains.own_parameters[b]);
      }
      least[k % 2].push_back(p);
    }
    double trials = 1.0;
    for (auto& list : least) {
      std::sort(list.begin(), list.end());
      for (const double share : {0.05, 0.5}) {
        const double p = list[static_cast<std::size_t>(share * static_cast<double>(list.size()))];
        trials = std::max(trials, std::log1p(-share) / std::log1p(-std::clamp(p, 1e-15, 0.999)));
      }
    }
    return trials;
  }

  /// Removes effects that are not significant or too small.
  void prune() {
    while (true) {
      const auto gains = system_.gains(choices_, flipped());
      chance_.trials = trials_of(gains, true), unweighted_.trials = trials_of(gains, false);
      std::size_t weakest = choices_.size();
      double largest = 0.0;
      for (std::size_t i = 0; i < choices_.size(); ++i) {
        const double p = chance_.corrected(p_of(choices_, i) / weight_of(choices_[i]));
        const bool small = size_of(choices_, i) < least_joint_rms * std::sqrt(noise2_);
        if ((p >= named_below || small) && p >= largest) weakest = i, largest = p;
      }
      if (weakest == choices_.size()) return;
      choices_ = without(choices_, weakest);
      settle();
    }
  }

  /// An effect gets one shared value if more than 1 % of the flipped copies reach its differences.
  void settle_differences() {
    for (std::size_t i = 0; i < choices_.size(); ++i) {
      if (choices_[i].holds == Holds::shared) continue;
      const auto gains = system_.gains(without(choices_, i), flipped());
      Choices shared = choices_, own = choices_;
      shared[i] = {choices_[i].block, Holds::shared}, own[i] = {choices_[i].block, Holds::own};
      const auto a = system_.solve(shared), b = system_.solve(own);
      if (!a.sound || !b.sound) continue;
      const auto row = static_cast<Index>(choices_[i].block);
      double as_much = 0.0;
      for (Index k = 0; k < shuffles; ++k)
        as_much += gains.own(row, k) - gains.shared(row, k) >= a.squares - b.squares ? 1.0 : 0.0;
      if (as_much > as_much_as_noise * static_cast<double>(shuffles)) choices_ = shared;
    }
  }

  void put_candidates(JointExplanation& out) const {
    for (const auto& [effect, one] : scored({})) {
      if (!(one.evidence > -1e300) || !system_.solve({one.choice}).sound) continue;
      out.candidates.push_back(described({one.choice}, 0));
      out.candidates.back().evidence = one.evidence - evidence_of_weight(weight_of(one.choice));
      out.candidates.back().weight = weight_of(one.choice);
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
    return std::sqrt(squares / system_.readings());
  }

  JointEffect described(const Choices& choices, std::size_t i) const {
    const Choice& c = choices[i];
    const JointBlock& block = r_.blocks[c.block];
    const auto solution = system_.solve_with_estimated_noise(choices);
    JointEffect out{.effect = block.effect, .holds = c.holds, .after = c.after};
    out.size = size_of(choices, i);
    out.rms = rms_of(system_.residuals(choices, solution));
    out.p = p_of(choices, i);
    const std::size_t groups = c.holds == Holds::shared    ? 1
                               : c.holds == Holds::changed ? 2
                                                           : r_.members.size();
    for (std::size_t g = 0; g < groups; ++g) {
      const auto [value, covariance] = system_.values(choices, solution, i, g);
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
    const JointBlock& named = r_.blocks[choices_[i].block];
    if (named.searched == 0) return;
    constexpr double out_of_sight = 25.0;  // of -2 ln of the likelihood
    const auto gains = system_.gains(without(choices_, i), y_);
    const MatrixXd& gain = choices_[i].holds == Holds::own ? gains.own : gains.shared;
    const double best = gain(static_cast<Index>(choices_[i].block), 0);
    struct Other {
      double weight;
      std::vector<std::vector<double>> variance;  // of each group and parameter
    };
    std::vector<Other> others;
    double weights = 0.0;
    const double least = criterion(choices_);
    for (std::size_t b = 0; b < r_.blocks.size(); ++b) {
      const JointBlock& block = r_.blocks[b];
      if (block.effect != named.effect || block.count != named.count ||
          !(gain(static_cast<Index>(b), 0) > best - out_of_sight))
        continue;
      Choices choices = choices_;
      choices[i].block = b;
      const auto solution = system_.solve(choices);
      if (!solution.sound) continue;
      Other other{std::exp(-0.5 * (solution.criterion() - least)), {}};
      for (std::size_t g = 0; g < effect.groups.size(); ++g) {
        const auto value = system_.values(choices, solution, i, g).first;
        other.variance.emplace_back();
        std::size_t linear = 0, shape = 0;
        for (const Parameter& p : effect.groups[g]) {
          const double now = p.shape ? block.shape[shape++]
                             : linear < static_cast<std::size_t>(value.size())
                                 ? value(static_cast<Index>(linear++))
                                 : p.value;
          other.variance.back().push_back((now - p.value) * (now - p.value));
        }
      }
      weights += other.weight;
      others.push_back(std::move(other));
    }
    for (std::size_t g = 0; g < effect.groups.size(); ++g)
      for (std::size_t k = 0; k < effect.groups[g].size(); ++k) {
        double variance = 0.0;
        for (const Other& other : others) variance += other.weight / weights * other.variance[g][k];
        Parameter& p = effect.groups[g][k];
        if (!p.shape)
          p.u = std::hypot(p.u, std::sqrt(variance));
        else if (variance > 0.0)
          p.u = std::sqrt(variance);
      }
  }

  /// Whether another effect that changes at the same date explains the readings as well.
  bool changes_as_well(Choices rest, const Choice& named, Choice other, double least) const {
    other.holds = named.holds, other.after = named.after;
    rest.push_back(other);
    return criterion(rest) < least + alias_evidence;
  }

  void put_effects(JointExplanation& out) const {
    const double all = criterion(choices_);
    for (std::size_t i = 0; i < choices_.size(); ++i) {
      JointEffect effect = described(choices_, i);
      add_shapes(effect, i);
      effect.p = unweighted_.corrected(effect.p);
      effect.weight = weight_of(choices_[i]);
      const Choices rest = without(choices_, i);
      const double before = criterion(rest);
      const double evidence = before - all;
      effect.evidence = evidence - evidence_of_weight(effect.weight);
      for (const auto& [name, one] : scored(rest))
        if (name != effect.effect && (one.evidence > evidence - alias_evidence ||
                                      (effect.holds == Holds::changed &&
                                       changes_as_well(rest, choices_[i], one.choice, all))))
          effect.aliases.push_back(name);
      out.effects.push_back(std::move(effect));
    }
  }

  void put_campaigns(JointExplanation& out) const {
    const auto left = system_.residuals(choices_, system_.solve(choices_));
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
    out.noise = std::sqrt(noise2_);
    out.trials = unweighted_.trials;
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
    for (const VectorXd& e : system_.residuals(choices_, system_.solve(choices_)))
      left.emplace_back(e);
    const double found = of_cells(left)(0);
    const VectorXd chance = of_cells(flipped());
    double mean = 0.0, squares = 0.0, n = 0.0;
    // Odd columns of `flipped` have flipped signs of whole passes.
    for (Index k = 1; k < shuffles; k += 2) mean += chance(k), ++n;
    mean /= n;
    for (Index k = 1; k < shuffles; k += 2) squares += std::pow(chance(k) - mean, 2);
    const double s = std::sqrt(squares / (n - 1.0));
    const double t = math::test_ratio(found - mean, s);
    out.p_left = t > 0.0 ? 0.5 * math::t_two_sided(t, n - 1.0) : 1.0;
    const double size = std::sqrt(std::max(found - mean, 0.0) / system_.readings());
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
    const auto found = system_.gains({}, y_), chance = system_.gains({}, flipped());
    double as_much = 0.0;
    for (Index k = 0; k < shuffles; k += 2) as_much += chance.single(k) >= found.single(0) ? 1 : 0;
    if (as_much > 0.05 * 0.5 * static_cast<double>(shuffles)) return std::nullopt;
    const JointBlock& block = r_.blocks[found.single_block];
    const MemberReadings& member = r_.members[found.single_member];
    JointExplanation::Single out{block.effect, found.single_member};
    const auto q = static_cast<double>(member.rank[found.single_block] + block.searched);
    out.p = math::f_upper(found.single_fall / q, q, member.dof) *
            static_cast<double>(system_.effects() * r_.members.size());
    return out.p < differs_below ? std::optional(out) : std::nullopt;
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
  JointSystem system_;
  std::uint64_t seed_;
  std::vector<MatrixXd> y_;
  double dof_ = 0.0, noise2_ = 0.0;
  Choices choices_;
  Chance chance_, unweighted_;  // for p/weight, which decides; for printed p
};

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
  JointExplanation first = JointSearch(members, readings, seed).run();
  if (first.effects.empty() || readings.offsets == 0.0) return first;
  const std::vector<Member> knowing = with_found(members, first);
  const auto again = read_together(knowing);
  if (!again || again->offsets > most_left * readings.offsets) return first;
  return JointSearch(knowing, *again, seed).run();
}

}  // namespace nonio::model
