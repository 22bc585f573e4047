// SPDX-License-Identifier: Apache-2.0
#include "joint/joint_search.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "diagnosis/verdict.h"
#include "fit/weights.h"
#include "nonio/math/distributions.h"
#include "search/finding.h"

namespace nonio::model {

namespace {

constexpr std::size_t most_effects = 8;
// Smallest RMS of a named effect, as a fraction of the noise: docs/dev/constants.md, M46.
constexpr double least_joint_rms = 0.1;
// Share of flipped copies that differ as much: docs/dev/constants.md, M47.
constexpr double as_much_as_noise = 0.01;
// With many campaigns, the date of a change is searched in steps, then between them.
constexpr std::size_t most_dates = 32;

}  // namespace

JointSearch::JointSearch(const std::vector<Member>& members, const JointReadings& readings,
                         std::uint64_t seed)
    : of_(members), r_(readings), system_(readings), seed_(seed) {
  for (const MemberReadings& m : r_.members) {
    y_.emplace_back(m.y);
    dof_ += m.dof;
    noise2_ += m.readings * m.s * m.s;
  }
  noise2_ /= system_.readings();
}

void JointSearch::run() {
  find();
  prefer_pairs();
  prune();
  settle_differences();
}

std::map<std::string, JointSearch::Scored> JointSearch::scored(const Choices& choices,
                                                               const std::string& only) const {
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

JointSearch::Scored JointSearch::simplest(const std::map<std::string, Scored>& all) const {
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

void JointSearch::find() {
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

void JointSearch::prefer_simpler() {
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

void JointSearch::prefer_pairs() {
  for (std::size_t i = 0; i < choices_.size(); ++i)
    while (i < choices_.size() && replace_by_pair(i)) {  // another effect is at i then
    }
}

bool JointSearch::replace_by_pair(std::size_t i) {
  const JointBlock& block = r_.blocks[choices_[i].block];
  if (block.searched == 0 || choices_.size() >= most_effects) return false;
  const Choices before = choices_;
  choices_ = without(before, i);
  for (int k = 0; k < 2; ++k) {
    auto all = scored(choices_);
    all.erase(block.effect);
    const Scored best = simplest(all);
    if (!(best.evidence > 0.0)) {
      choices_ = before;
      return false;
    }
    choices_.push_back(best.choice);
    settle();
  }
  if (criterion(choices_) < criterion(before)) return true;
  choices_ = before;
  return false;
}

std::vector<std::size_t> JointSearch::finer(std::size_t block) const {
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

Choices JointSearch::with_all_knots(Choices choices, std::size_t except) const {
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (i == except) continue;
    for (const std::size_t b : finer(choices[i].block)) {
      choices[i].block = b;
      if (system_.solve(choices).sound) break;
    }
  }
  return choices;
}

double JointSearch::criterion(const Choices& choices) const {
  const auto s = system_.solve(choices);
  return s.sound ? s.criterion() : std::numeric_limits<double>::infinity();
}

void JointSearch::settle() {
  for (int round = 0; round < 4; ++round) {
    bool any = false;
    for (std::size_t i = 0; i < choices_.size(); ++i) any = settle(i) || any;
    if (!any) return;
  }
}

bool JointSearch::settle(std::size_t i) {
  const Choice before = choices_[i];
  const std::string effect = r_.blocks[before.block].effect;
  const auto best = scored(without(choices_, i), effect);
  if (const auto found = best.find(effect); found != best.end()) choices_[i] = found->second.choice;
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

void JointSearch::look_for_date(std::size_t i) {
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

double JointSearch::p_same(std::size_t i) const {
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

double JointSearch::p_of(const Choices& chosen, std::size_t i) const {
  const Choices choices = with_all_knots(chosen, i);
  const auto all = system_.solve(choices), rest = system_.solve(without(choices, i));
  const JointBlock& block = r_.blocks[choices[i].block];
  const auto q = static_cast<double>(all.parameters - rest.parameters + block.searched);
  const double p = math::f_upper((rest.squares - all.squares) / q, q, dof_);
  const auto dates = static_cast<double>(r_.members.size() - 1);
  return choices[i].holds == Holds::changed ? std::min(1.0, dates * p) : p;
}

double JointSearch::weight_of(const Choice& choice) const { return r_.blocks[choice.block].weight; }

double JointSearch::size_of(const Choices& choices, std::size_t i) const {
  const double fall = system_.solve(without(choices, i)).squares - system_.solve(choices).squares;
  return std::sqrt(std::max(fall, 0.0) * noise2_ / system_.readings());
}

std::vector<MatrixXd> JointSearch::flipped() const {
  const auto left = system_.residuals(choices_, system_.solve(choices_));
  std::mt19937_64 random(seed_);
  std::vector<MatrixXd> out;
  for (std::size_t m = 0; m < left.size(); ++m) {
    const MemberReadings& member = r_.members[m];
    const double free = std::max(member.readings - static_cast<double>(member.unknowns), 1.0);
    const VectorXd e = left[m] * std::sqrt(member.readings / free);
    MatrixXd noise(e.size(), flipped_copies);
    for (Index k = 0; k < flipped_copies; ++k) {
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

double JointSearch::trials_of(const JointSystem::Gains& gains, bool weighted) const {
  std::vector<double> least[2];
  for (Index k = 0; k < flipped_copies; ++k) {
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

void JointSearch::prune() {
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

void JointSearch::settle_differences() {
  for (std::size_t i = 0; i < choices_.size(); ++i) {
    if (choices_[i].holds == Holds::shared) continue;
    const auto gains = system_.gains(without(choices_, i), flipped());
    Choices shared = choices_, own = choices_;
    shared[i] = {choices_[i].block, Holds::shared}, own[i] = {choices_[i].block, Holds::own};
    const auto a = system_.solve(shared), b = system_.solve(own);
    if (!a.sound || !b.sound) continue;
    const auto row = static_cast<Index>(choices_[i].block);
    double as_much = 0.0;
    for (Index k = 0; k < flipped_copies; ++k)
      as_much += gains.own(row, k) - gains.shared(row, k) >= a.squares - b.squares ? 1.0 : 0.0;
    if (as_much > as_much_as_noise * static_cast<double>(flipped_copies)) choices_ = shared;
  }
}

}  // namespace nonio::model
