// SPDX-License-Identifier: Apache-2.0
//
// Which effects a course is missing: sets of at most six, grown and kept three at a time, judged by
// blocks in time that are left out. What such a search finds in noise of the same kind is found by
// the same search in copies of the remainder whose phases are random (Theiler et al. 1992).
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <tuple>
#include <unsupported/Eigen/FFT>

#include "course.h"
#include "course_pool.h"
#include "nonio/sdk/splitmix64.h"

namespace nonio::model {

namespace {

using Set = std::vector<std::size_t>;  // of entries, ascending

// docs/dev/constants.md, M40.
constexpr std::size_t most_terms = 6, kept_sets = 12, copies = 100;
constexpr double worth_a_term = 0.9;  // of the RMS of what is left out
constexpr double same_rms = 1.05;     // RMS of two explanations that cannot be separated
constexpr double named_p = 0.01;
constexpr double of_floor = 1.5;  // what noise explains
constexpr std::size_t most_instances = 64;

/// A shape of an effect that is not in the model.
struct Entry {
  std::size_t term;
  std::vector<double> shape;
  std::vector<Index> columns;  ///< of the pool
};

/// What a search finds in copies of a remainder: improvements, in logarithms of the RMS. Largest of
/// many: a Gumbel distribution.
struct InCopies {
  double at = 0.0, width = 0.0;
  std::vector<double> found;

  double p(double improvement) const {
    if (!(width > 0.0)) return 1.0;
    return -std::expm1(-std::exp(-(improvement - at) / width));
  }
};

class CourseSearch {
 public:
  CourseSearch(const Part& part, const Fit& model, const std::vector<Term>& catalogue,
               std::uint64_t seed)
      : data_(part), pool_(data_), catalogue_(catalogue), seed_(seed) {
    for (const Term& term : model.terms) {
      auto columns = term.effect->columns(part.table, term.axis, term.shape);
      if (!columns) continue;
      for (const Index at : pool_.add(data_.means(*columns), term.effect->linear))
        base_.push_back(at);
    }
    std::map<std::string, std::size_t> instances;
    for (const Term& term : catalogue) ++instances[term.effect->info.name];
    for (std::size_t t = 0; t < catalogue.size(); ++t) {
      const Term& term = catalogue[t];
      if (std::any_of(model.terms.begin(), model.terms.end(),
                      [&](const Term& m) { return m.name() == term.name(); }) ||
          instances[term.effect->info.name] > most_instances)
        continue;
      for (CourseColumns& one : columns_on_grid(data_, term))
        entries_.push_back({t, std::move(one.shape), pool_.add(one.columns, term.effect->linear)});
    }
    pool_.finish();
    displacements_ = data_.without_zeros(data_.displacements());
    sides_.emplace(pool_, displacements_);
  }

  std::vector<Index> columns_of(const Set& set) const {
    std::vector<Index> out = base_;
    for (const std::size_t e : set)
      out.insert(out.end(), entries_[e].columns.begin(), entries_[e].columns.end());
    std::sort(out.begin(), out.end());
    const bool twice = std::adjacent_find(out.begin(), out.end()) != out.end();
    if (twice) out.push_back(-1);
    return out;
  }

  double level_of(const Set& set) const {
    const auto columns = columns_of(set);
    if (!columns.empty() && columns.back() < 0) return std::numeric_limits<double>::infinity();
    return level(left_out(pool_, *sides_, columns));
  }

  bool has_term(const Set& set, std::size_t term) const {
    return std::any_of(set.begin(), set.end(),
                       [&](std::size_t e) { return entries_[e].term == term; });
  }

  /// The best entry of each term in addition to `set`: {entry, level}.
  std::map<std::size_t, std::pair<std::size_t, double>> best_with(const Set& set) const {
    std::map<std::size_t, std::pair<std::size_t, double>> out;
    for (std::size_t e = 0; e < entries_.size(); ++e) {
      if (has_term(set, entries_[e].term)) continue;
      const double l = level_of(with(set, e));
      const auto [place, first] = out.try_emplace(entries_[e].term, e, l);
      if (!first && l < place->second.second) place->second = {e, l};
    }
    return out;
  }

  /// Effects of the same channel, which show only together: fast one way and slowly back.
  void add_pairs(std::map<Set, double>& grown) const {
    for (std::size_t a = 0; a < entries_.size(); ++a)
      for (std::size_t b = a + 1; b < entries_.size(); ++b) {
        if (entries_[a].term == entries_[b].term ||
            catalogue_[entries_[a].term].axis.name != catalogue_[entries_[b].term].axis.name)
          continue;
        Set pair{a, b};
        if (grown.contains(pair)) continue;
        const double l = level_of(pair);
        grown.emplace(std::move(pair), l);
      }
  }

  /// The smallest set that no larger one betters by a tenth for each term more.
  Set best() const {
    std::vector<Set> beam{{}};
    std::vector<std::pair<Set, double>> best{{{}, level_of({})}};
    for (std::size_t size = 1; size <= most_terms; ++size) {
      std::map<Set, double> grown;
      for (const Set& set : beam)
        for (std::size_t e = 0; e < entries_.size(); ++e)
          if (!has_term(set, entries_[e].term)) {
            Set more = with(set, e);
            if (!grown.contains(more)) {
              const double l = level_of(more);
              grown.emplace(std::move(more), l);
            }
          }
      if (size == 2) add_pairs(grown);
      std::vector<std::pair<Set, double>> all(grown.begin(), grown.end());
      if (all.empty()) break;
      const auto last = all.begin() + static_cast<std::ptrdiff_t>(std::min(kept_sets, all.size()));
      std::partial_sort(all.begin(), last, all.end(), [](const auto& a, const auto& b) {
        return std::tie(a.second, a.first) < std::tie(b.second, b.first);
      });
      if (!std::isfinite(all.front().second)) break;
      beam.clear();
      for (auto it = all.begin(); it != last; ++it) beam.push_back(it->first);
      best.push_back(all.front());
    }
    std::size_t chosen = 0;
    for (bool better = true; better;) {
      better = false;
      for (std::size_t k = chosen + 1; k < best.size() && !better; ++k)
        if (best[k].second <
            best[chosen].second + std::log(worth_a_term) * static_cast<double>(k - chosen)) {
          chosen = k;
          better = true;
        }
    }
    return best[chosen].first;
  }

  /// What one more term would seem to improve in addition to `set` if the remainder had nothing to do with
  /// any of them.
  InCopies chance_with(const Set& set) const {
    const std::vector<Index> columns = columns_of(set);
    const MatrixXd rest = pool_.remainder(columns, data_.displacements());
    const Index q = rest.cols();
    MatrixXd made(data_.size(), q * static_cast<Index>(copies));
    SplitMix64 random(seed_);
    for (std::size_t c = 0; c < copies; ++c)
      made.middleCols(q * static_cast<Index>(c), q) = data_.without_zeros(copy_of(rest, random));
    const CourseSides sides(pool_, made);
    const Eigen::RowVectorXd before = left_out(pool_, sides, columns);
    InCopies out;
    out.found.assign(copies, 0.0);
    for (std::size_t e = 0; e < entries_.size(); ++e) {
      if (has_term(set, entries_[e].term)) continue;
      const auto more = columns_of(with(set, e));
      if (more.back() < 0) continue;
      const Eigen::RowVectorXd after = left_out(pool_, sides, more);
      for (std::size_t c = 0; c < copies; ++c) {
        const auto at = q * static_cast<Index>(c);
        const double improvement = level(before.segment(at, q)) - level(after.segment(at, q));
        if (std::isfinite(improvement)) out.found[c] = std::max(out.found[c], improvement);
      }
    }
    double mean = 0.0, squares = 0.0;
    for (const double x : out.found) mean += x / static_cast<double>(copies);
    for (const double x : out.found) squares += (x - mean) * (x - mean);
    constexpr double euler = 0.5772156649015329;
    out.width = std::sqrt(squares / static_cast<double>(copies - 1) * 6.0) / std::numbers::pi;
    out.at = mean - euler * out.width;
    return out;
  }

  static Set with(const Set& set, std::size_t e) {
    Set out = set;
    out.insert(std::lower_bound(out.begin(), out.end(), e), e);
    return out;
  }
  static Set without(const Set& set, std::size_t e) {
    Set out = set;
    std::erase(out, e);
    return out;
  }

  Term term_of(std::size_t e) const { return catalogue_[entries_[e].term]; }
  const Entry& entry(std::size_t e) const { return entries_[e]; }
  /// Of this displacement alone, m.
  double left_out_with(const Set& set) const {
    return std::sqrt(left_out(pool_, *sides_, columns_of(set))(0));
  }

 private:
  /// The same spectrum of changes and the same coherence of displacements, other phases.
  MatrixXd copy_of(const MatrixXd& rest, SplitMix64& random) const {
    const Index n = rest.rows() - 1;
    std::vector<double> angle(static_cast<std::size_t>(n / 2 + 1));
    for (double& a : angle) a = 2.0 * std::numbers::pi * random.uniform();
    MatrixXd out(rest.rows(), rest.cols());
    Eigen::FFT<double> fft;
    for (Index k = 0; k < rest.cols(); ++k) {
      std::vector<double> change(static_cast<std::size_t>(n));
      for (Index i = 0; i < n; ++i)
        change[static_cast<std::size_t>(i)] = rest(i + 1, k) - rest(i, k);
      std::vector<std::complex<double>> spectrum;
      fft.fwd(spectrum, change);
      for (Index f = 1; 2 * f < n; ++f) {
        const auto turn = std::polar(1.0, angle[static_cast<std::size_t>(f)]);
        spectrum[static_cast<std::size_t>(f)] *= turn;
        spectrum[static_cast<std::size_t>(n - f)] *= std::conj(turn);
      }
      std::vector<std::complex<double>> back;
      fft.inv(back, spectrum);
      out(0, k) = 0.0;
      for (Index i = 0; i < n; ++i)
        out(i + 1, k) = out(i, k) + back[static_cast<std::size_t>(i)].real();
    }
    return out;
  }

  CourseData data_;
  CoursePool pool_;
  const std::vector<Term>& catalogue_;
  std::uint64_t seed_;
  std::vector<Index> base_;
  std::vector<Entry> entries_;
  MatrixXd displacements_;
  std::optional<CourseSides> sides_;
};

/// Candidates and verdict from the best set.
class CourseExplanation {
 public:
  CourseExplanation(const Part& part, const std::vector<Term>& model,
                    const std::vector<Term>& catalogue, std::uint64_t seed, Comparison comparison)
      : part_(part), model_(model), search_(part, comparison.fit, catalogue, seed) {
    out_.comparison = std::move(comparison);
  }

  Explanation made() {
    const InCopies by_chance = search_.chance_with({});
    set_ = search_.best();
    const auto singles = search_.best_with({});
    judge_members();
    const double alone = search_.level_of({}), all = search_.level_of(set_);
    // Evidence in units of independent bins: 2 ln of a likelihood ratio.
    weight_ = static_cast<double>(out_.comparison.fit.redundancy) /
              repetition(out_.comparison.fit.noise.measured);
    weight_ = std::max(weight_, 1.0) * 2.0;
    const InCopies further = set_.empty() ? by_chance : search_.chance_with(set_);
    for (Member& member : members_) {
      const auto single = singles.find(search_.entry(member.entry).term);
      if (single != singles.end()) member.alone = alone - single->second.second;
      add_member(member, all);
    }
    const auto grown = set_.empty() ? singles : search_.best_with(set_);
    for (const auto& [term, one] : singles) {
      if (search_.has_term(set_, term)) continue;
      const auto more = grown.find(term);
      const double gain = more == grown.end() ? 0.0 : all - more->second.second;
      add(one.first, gain, further.p(gain));
    }
    std::stable_sort(out_.candidates.begin(), out_.candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
    judge(by_chance);
    return std::move(out_);
  }

 private:
  /// What the best set loses without one of its effects, and the chance that noise shows as much.
  struct Member {
    std::size_t entry;
    double loss, p;
    double alone = 0.0;  ///< what it improves by itself
  };

  /// A set in which noise could replace every single effect shows nothing.
  void judge_members() {
    const double all = search_.level_of(set_);
    for (const std::size_t e : set_) {
      const Set others = CourseSearch::without(set_, e);
      const double loss = search_.level_of(others) - all;
      members_.push_back({e, loss, search_.chance_with(others).p(loss)});
    }
    if (std::none_of(members_.begin(), members_.end(),
                     [](const Member& m) { return m.p < named_p; })) {
      set_.clear();
      members_.clear();
    }
  }

  void add_member(const Member& member, double all) {
    const std::size_t e = member.entry;
    const Set others = CourseSearch::without(set_, e);
    add(e, std::max(member.loss, member.alone), member.p);
    Candidate& c = out_.candidates.back();
    // What takes its place as well, cannot be separated from it.
    for (const auto& [term, one] : search_.best_with(others))
      if (term != search_.entry(e).term && !search_.has_term(set_, term) &&
          one.second < all + std::log(same_rms))
        c.aliases.push_back(search_.term_of(one.first).name());
    if (member.p < named_p) certain_.emplace_back(member.alone, c.term.name());
  }

  void add(std::size_t e, double gain, double p) {
    Candidate c;
    c.term = search_.term_of(e);
    c.cv_rms = search_.left_out_with({e});
    c.p = p;
    c.score = weight_ * gain;
    std::vector<Term> terms = model_;
    terms.push_back(c.term);
    terms.back().shape = search_.entry(e).shape;
    const bool member = std::find(set_.begin(), set_.end(), e) != set_.end();
    if (member || set_.empty()) terms.back().shape.clear();
    if (const auto fit = fit_course(part_, terms)) {
      c.rms = fit->rms;
      c.term.shape = fit->terms.back().shape;
      for (const Parameter& parameter : fit->parameters)
        if (parameter.effect == c.term.name()) c.parameters.push_back(parameter);
    } else {
      c.visible = false;
      c.why = "aliased";
    }
    if (c.visible && !(gain > -std::log(worth_a_term)) && !member) c.score = std::min(c.score, 0.0);
    out_.candidates.push_back(std::move(c));
  }

  void judge(const InCopies& by_chance) {
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
    v.trials = copies;
    std::size_t alarms = 0;
    for (const double x : by_chance.found)
      if (by_chance.p(x) < named_p && x > -std::log(worth_a_term)) ++alarms;
    v.false_alarms = static_cast<double>(alarms) / static_cast<double>(copies);
    if (!set_.empty()) {
      if (const auto fit = fit_course(part_, terms))
        out_.best_rms = out_.significant_rms = fit->rms;
      v.kind = Verdict::Kind::missing;
      v.effect = out_.certain.front();
      return;
    }
    const auto& floor = out_.comparison.floor;
    v.kind = floor && out_.comparison.fit.rms <= of_floor * floor->s ? Verdict::Kind::nothing
                                                                     : Verdict::Kind::unknown;
  }

  const Part& part_;
  const std::vector<Term>& model_;
  CourseSearch search_;
  Set set_;
  std::vector<Member> members_;
  double weight_ = 1.0;
  std::vector<std::pair<double, std::string>> certain_;
  Explanation out_;
};

}  // namespace

Expected<Explanation> explain_course(const Part& part, const std::vector<Term>& model,
                                     const std::vector<Term>& catalogue, std::uint64_t seed) {
  auto comparison = compare_course(part, model);
  if (!comparison) return fail(comparison.error());
  return CourseExplanation(part, model, catalogue, seed, std::move(*comparison)).made();
}

}  // namespace nonio::model
