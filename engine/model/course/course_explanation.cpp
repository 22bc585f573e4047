// SPDX-License-Identifier: Apache-2.0
//
// The explanation of a displacement over time: which set of effects, and which of them is named.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "course.h"
#include "course_search.h"

namespace nonio::model {

namespace {

// docs/dev/constants.md, M40.
constexpr std::size_t fitted_anew = 5;
constexpr double named_p = 0.01;
constexpr double of_floor = 1.5;  // RMS up to this multiple of the floor is explained by noise

class CourseExplanation {
 public:
  CourseExplanation(const CourseData& data, const std::vector<Term>& model,
                    const std::vector<Term>& catalogue, std::uint64_t seed, Comparison comparison)
      : data_(data),
        model_(model),
        catalogue_(catalogue),
        search_(data, comparison.fit, catalogue, seed) {
    out_.comparison = std::move(comparison);
  }

  Explanation made() {
    set_ = search_.found();
    const auto singles = search_.best_with({});
    const double p_of_search = search_.p_of_search();
    if (p_of_search < named_p) {
      set_ = proven(std::move(set_));
      begin_with_best_alone(singles);
      judge_members();
    } else {
      set_.clear();
    }
    const double alone = search_.level_of({}), all = search_.level_of(set_);
    const CourseChance first = search_.chance_with({});
    const CourseChance further = set_.empty() ? first : search_.chance_with(set_);
    for (Member& member : members_) {
      const auto single = singles.find(search_.entry(member.entry).term);
      if (single != singles.end()) {
        member.alone = alone - single->second.second;
        member.predicts = own_left_out({}) - own_left_out({single->second.first});
        member.p_alone = first.p(
            {member.alone, search_.left_out({}) - search_.left_out({single->second.first})});
      }
      add_member(member, all);
    }
    const auto grown = set_.empty() ? singles : search_.best_with(set_);
    for (const auto& [term, one] : singles) {
      if (search_.has_term(set_, term)) continue;
      const auto more = grown.find(term);
      const double gain = more == grown.end() ? 0.0 : all - more->second.second;
      const double improved =
          more == grown.end() ? 0.0
                              : search_.left_out(set_) -
                                    search_.left_out(CourseSearch::with(set_, more->second.first));
      // What the search does not prove, no single effect of it does.
      add(one.first, {alone - one.second, gain},
          std::max(further.p({gain, improved}), set_.empty() ? p_of_search : 0.0));
    }
    std::stable_sort(out_.candidates.begin(), out_.candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
    for (std::size_t i = 0; i < out_.candidates.size(); ++i)
      fit(out_.candidates[i], i < fitted_anew || is_member(out_.candidates[i]));
    judge();
    return std::move(out_);
  }

 private:
  /// Difference of ln evidence below which two explanations are not separable.
  double same_evidence() const {
    return static_cast<double>(data_.size()) * std::log(same_course_rms);
  }

  /// An effect of the best set; loss: ln evidence without the effect; p: p-value of this loss.
  struct Member {
    std::size_t entry;
    double loss, p;
    double alone = 0.0;     ///< gain of ln evidence as the only addition to the model
    double predicts = 0.0;  ///< decrease of ln(RMS) of the cross-validation as the only addition
    double p_alone = 1.0;   ///< p-value as the only addition, of all displacements together
  };

  /// ln(RMS) of the cross-validation of this displacement: those that move together share a search,
  /// but what is missing from each can be another effect.
  double own_left_out(const CourseSet& set) const { return std::log(search_.left_out_with(set)); }

  /// Evidence can increase while blocks of time that are left out are predicted worse, or while more
  /// is left, which correlated noise then describes. Drops the effects whose values are below their
  /// uncertainties, and those without which these blocks are predicted at least as well or clearly
  /// less is left, but not those of `kept`: if these are below their uncertainties, others that
  /// replace them.
  CourseSet proven(CourseSet set, const CourseSet& kept = {}) const {
    Whole now = whole(set);
    while (!set.empty()) {
      CourseSet best, smallest;
      Whole least, smallest_left;
      const bool kept_is_weak = !kept.empty() && now.weak == names_of(kept);
      for (const std::size_t e : set) {
        const bool weak = kept_is_weak || contains(now.weak, search_.term_of(e).name());
        if ((!weak && !now.weak.empty()) || std::find(kept.begin(), kept.end(), e) != kept.end())
          continue;
        CourseSet others = CourseSearch::without(set, e);
        Whole one = whole(others);
        if (smallest.size() != others.size() || one.rms < smallest_left.rms)
          smallest_left = one, smallest = others;
        if (best.size() != others.size() || one.ln_rms < least.ln_rms)
          least = std::move(one), best = std::move(others);
      }
      if (best.size() + 1 != set.size()) break;
      if (now.weak.empty() && least.ln_rms > now.ln_rms) {
        if (!(same_course_rms * smallest_left.rms < now.rms)) break;
        least = std::move(smallest_left), best = std::move(smallest);
      }
      now = std::move(least), set = std::move(best);
    }
    return set;
  }

  /// Several sensors can together imitate the one that shows the cause, with less of its noise. An
  /// effect that alone leaves only noise is preferred: the one with the largest evidence, or the one
  /// that predicts left-out blocks best. The latter is also preferred if it leaves less than half of
  /// what the best effect of the set alone leaves, and comes closer (in ln RMS) to the whole set than
  /// to this, or is in a set that predicts as well.
  void begin_with_best_alone(const std::map<std::size_t, std::pair<std::size_t, double>>& singles) {
    if (set_.empty()) return;
    constexpr double none = std::numeric_limits<double>::infinity();
    double least = none, least_of_set = none, least_level = none;
    std::size_t alone = 0, likeliest = 0;
    for (const auto& [term, one] : singles) {
      const double ln_rms = own_left_out({one.first}), level = search_.own_level_of({one.first});
      if (ln_rms < least) least = ln_rms, alone = one.first;
      if (level < least_level) least_level = level, likeliest = one.first;
      if (search_.has_term(set_, term)) least_of_set = std::min(least_of_set, ln_rms);
    }
    const Whole model = whole({});
    for (const std::size_t e : {likeliest, alone})
      if (const Whole one = whole({e});
          one.only_noise && !model.only_noise && one.own_ln_rms < model.own_ln_rms)
        return begin_with(e, {e});
    if (!(least < least_of_set - std::numbers::ln2)) return;
    const double of_set = whole(set_).own_ln_rms, of_one = whole({alone}).own_ln_rms;
    const CourseSet other = proven(search_.best({alone}), {alone});
    if (2.0 * of_one <= of_set + least_of_set ||
        whole(other).own_ln_rms <= of_set + std::log(same_course_rms))
      begin_with(alone, other);
  }

  void begin_with(std::size_t first, const CourseSet& set) {
    set_ = set;
    first_ = search_.term_of(first).name();
  }

  /// A set fitted with its shapes searched again, as in the model that users would get.
  struct Whole {
    /// Of the cross-validation: averaged over the displacements, and of this one.
    double ln_rms = std::numeric_limits<double>::infinity(), own_ln_rms = ln_rms;
    std::vector<std::string> weak;  ///< effects of the set with values below their uncertainties
    bool only_noise = false;        ///< whether successive readings differ as much as all readings
    double rms = std::numeric_limits<double>::infinity();  ///< m
  };

  Whole whole(const CourseSet& set) const {
    std::vector<Term> terms = model_;
    for (const std::size_t e : set) {
      terms.push_back(search_.term_of(e));
      terms.back().shape.clear();
    }
    Whole out;
    const auto fit = fit_course(data_, terms);
    if (!fit) return out;
    const std::vector<double> left_out = left_out_rms(data_, fit->terms);
    out.ln_rms = 0.0;
    for (const double rms : left_out)
      out.ln_rms += std::log(rms) / static_cast<double>(left_out.size());
    out.own_ln_rms = std::log(left_out.front());
    out.only_noise = leaves_only_noise(fit->rms, floor_of(fit->residual));
    out.rms = fit->rms;
    const auto below = below_uncertainty(*fit);
    for (const std::size_t e : set)
      if (contains(below, search_.term_of(e).name())) out.weak.push_back(search_.term_of(e).name());
    return out;
  }

  std::vector<std::string> names_of(const CourseSet& set) const {
    std::vector<std::string> out;
    for (const std::size_t e : set) out.push_back(search_.term_of(e).name());
    return out;
  }

  static bool contains(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  }

  void judge_members() {
    const double all = search_.level_of(set_);
    for (const std::size_t e : set_) {
      const CourseSet others = CourseSearch::without(set_, e);
      const double loss = search_.level_of(others) - all;
      const double fall = search_.left_out(others) - search_.left_out(set_);
      members_.push_back({e, loss, search_.chance_with(others).p({loss, fall})});
    }
  }

  void add_member(const Member& member, double all) {
    const std::size_t e = member.entry;
    const CourseSet others = CourseSearch::without(set_, e);
    add(e, {member.alone, member.loss}, member.p);
    Candidate& c = out_.candidates.back();
    // An effect that can replace the member with nearly equal evidence cannot be separated from it.
    for (const auto& [term, one] : search_.best_with(others))
      if (term != search_.entry(e).term && !search_.has_term(set_, term) &&
          one.second < all + same_evidence())
        c.aliases.push_back(search_.term_of(one.first).name());
    if (member.p < named_p) certain_.emplace_back(member.predicts, c.term.name());
  }

  /// Gain of ln evidence as the only addition to the model, and in addition to the best set.
  struct Gain {
    double alone, within;
  };

  void add(std::size_t e, const Gain& gain, double p) {
    Candidate c;
    c.term = search_.term_of(e);
    c.minimal_detectable = std::numeric_limits<double>::quiet_NaN();  // not determined for a course
    c.p = p;
    const bool member = std::find(set_.begin(), set_.end(), e) != set_.end();
    c.alone = 2.0 * (gain.alone - search_.penalty());
    c.within = 2.0 * (gain.within - search_.penalty());
    c.score = member ? std::max(c.alone, c.within) : c.within;
    c.term.shape = search_.entry(e).shape;
    out_.candidates.push_back(std::move(c));
  }

  /// If `anew`, the shapes of the model and of the candidate are searched again, as when the
  /// candidate is added. A candidate whose fit fails is not visible.
  void fit(Candidate& c, bool anew) {
    std::vector<Term> terms = anew ? model_ : out_.comparison.fit.terms;
    terms.push_back(c.term);
    if (anew) terms.back().shape.clear();
    if (const auto fit = fit_course(data_, terms)) {
      c.rms = fit->rms;
      c.cv_rms = left_out_rms(data_, fit->terms).front();
      c.term.shape = fit->terms.back().shape;
      for (const Parameter& parameter : fit->parameters)
        if (parameter.effect == c.term.name()) c.parameters.push_back(parameter);
    } else {
      c.visible = false;
      c.why = "aliased";
    }
  }

  bool is_member(const Candidate& c) const {
    return std::any_of(set_.begin(), set_.end(),
                       [&](std::size_t e) { return search_.term_of(e).name() == c.term.name(); });
  }

  void judge() {
    std::sort(certain_.begin(), certain_.end(), std::greater<>());
    for (const auto& [loss, name] : certain_) out_.certain.push_back(name);
    std::vector<Term> terms = model_;
    for (const std::size_t e : set_) {
      out_.together.push_back(search_.term_of(e).name());
      terms.push_back(search_.term_of(e));
    }
    out_.best_rms = out_.significant_rms = out_.comparison.fit.rms;
    out_.fails = out_.comparison.seats;
    Verdict& v = out_.verdict;
    v.trials = CourseSearch::copies;
    v.false_alarms = named_p;
    if (!set_.empty()) {
      if (const auto fit = fit_course(data_, terms)) {
        out_.best_rms = out_.significant_rms = fit->rms;
        out_.sensors = sensors_of(data_.part(), *fit);
      }
      v.kind = Verdict::Kind::missing;
      v.effect = named();
      // The verdict and its numbers must be those of the first candidate.
      std::stable_partition(out_.candidates.begin(), out_.candidates.end(),
                            [&](const Candidate& c) { return c.term.name() == v.effect; });
      Candidate& front = out_.candidates.front();
      for (const Candidate& c : out_.candidates) front.score = std::max(front.score, c.score);
      // It is named as the first addition: within the set others may replace it.
      for (const Member& m : members_)
        if (search_.term_of(m.entry).name() == v.effect) front.p = std::min(front.p, m.p_alone);
      name_aliases(front);
      plan();
      return;
    }
    out_.sensors = sensors_of(data_.part(), out_.comparison.fit);
    v.kind = leaves_only_noise(out_.comparison.fit.rms, out_.comparison.floor)
                 ? Verdict::Kind::nothing
                 : Verdict::Kind::unknown;
  }

  /// The verdict offers the aliases of the named effect instead of it, so those remain that alone
  /// leave nearly as little: others replace it only within the set.
  void name_aliases(Candidate& named) const {
    constexpr double nearly = 1.5;
    std::erase_if(named.aliases, [&](const std::string& name) {
      const auto alias = std::find_if(out_.candidates.begin(), out_.candidates.end(),
                                      [&](const Candidate& c) { return c.term.name() == name; });
      return alias != out_.candidates.end() && !(alias->rms <= nearly * named.rms);
    });
  }

  /// For the effects that are named or significant, with the shapes with which aliases were found.
  void plan() {
    std::vector<Candidate> members;
    for (const Candidate& c : out_.candidates)
      if (!c.aliases.empty() &&
          (c.term.name() == out_.verdict.effect || contains(out_.certain, c.term.name())))
        members.push_back(c);
    if (members.empty()) return;
    std::vector<Term> terms = out_.comparison.fit.terms;
    for (const std::size_t e : set_) {
      terms.push_back(search_.term_of(e));
      terms.back().shape = search_.entry(e).shape;
    }
    if (const auto fit = fit_course(data_, terms); fit)
      out_.plans = plans_of_course(data_, *fit, members, catalogue_);
  }

  /// The member that alone predicts left-out blocks best, of those that are significant in the set or
  /// alone; of all, if none is.
  std::string named() const {
    if (!first_.empty()) return first_;
    const auto rank = [&](const Member& m) {
      return std::pair(!(std::min(m.p, m.p_alone) < named_p),
                       cv_of(search_.term_of(m.entry).name()));
    };
    auto best = std::min_element(members_.begin(), members_.end(),
                                 [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
    if (best == members_.end()) return {};
    // Of two effects that differ only in the time constants of the set, the first of the catalogue.
    for (auto m = members_.begin(); m != members_.end(); ++m)
      if (m->alone == best->alone && search_.entry(m->entry).term < search_.entry(best->entry).term)
        best = m;
    return search_.term_of(best->entry).name();
  }

  /// RMS of the cross-validation with the effect as the only addition, m.
  double cv_of(const std::string& name) const {
    for (const Candidate& c : out_.candidates)
      if (c.term.name() == name && c.visible && c.cv_rms) return *c.cv_rms;
    return std::numeric_limits<double>::infinity();
  }

  static bool leaves_only_noise(double rms, const std::optional<NoiseFloor>& floor) {
    return floor && rms <= of_floor * floor->s;
  }

  const CourseData& data_;
  const std::vector<Term>&model_, &catalogue_;
  CourseSearch search_;
  CourseSet set_;
  std::vector<Member> members_;
  std::vector<std::pair<double, std::string>> certain_;
  std::string first_;  ///< effect that alone explains most, if the set was begun with it
  Explanation out_;
};

}  // namespace

Expected<Explanation> explain_course(const Part& part, const std::vector<Term>& model,
                                     const std::vector<Term>& catalogue, std::uint64_t seed) {
  const CourseData data(part);
  NONIO_TRY(auto fit, fit_course(data, model));
  Comparison comparison = comparison_of_course(part, std::move(fit));
  return CourseExplanation(data, model, catalogue, seed, std::move(comparison)).made();
}

}  // namespace nonio::model
