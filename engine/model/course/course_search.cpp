// SPDX-License-Identifier: Apache-2.0
//
// Sets of at most six effects are compared by their evidence under noise that is correlated in
// time. The effect of chance is determined by the same search in surrogates of the residual with
// random phases (Theiler et al. 1992).
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

using Set = std::vector<std::size_t>;  // entry indices, ascending

// docs/dev/constants.md, M40.
constexpr std::size_t most_terms = 6, kept_sets = 12, copies = 100, fitted_anew = 5;
constexpr double same_rms = 1.05;  // RMS ratio up to which two explanations are not separable
constexpr double named_p = 0.01;
constexpr double of_floor = 1.5;  // RMS up to this multiple of the floor is explained by noise
constexpr std::size_t most_instances = 64;

/// One shape of an effect that is not in the model.
struct Entry {
  std::size_t term;
  std::vector<double> shape;
  MatrixXd made;
  std::vector<Index> columns;
};

/// Gain of ln evidence, and decrease of ln(RMS) of the cross-validation, by added columns.
struct Shown {
  double evidence, fall;
};

/// Gumbel distribution of the largest gain that a search finds in surrogates of a residual.
struct InCopies {
  double at = 0.0, width = 0.0;

  explicit InCopies(const std::vector<double>& found) {
    const auto n = static_cast<double>(found.size());
    double mean = 0.0, squares = 0.0;
    for (const double x : found) mean += x / n;
    for (const double x : found) squares += (x - mean) * (x - mean);
    constexpr double euler = 0.5772156649015329;
    width = std::sqrt(squares / (n - 1.0) * 6.0) / std::numbers::pi;
    at = mean - euler * width;
  }

  double p(double value) const {
    if (!(width > 0.0)) return 1.0;
    return -std::expm1(-std::exp(-(value - at) / width));
  }
};

/// The p-value of a gain by the better of two criteria, with Bonferroni correction.
struct SearchInCopies {
  InCopies evidence, fall;

  double p(const Shown& shown) const {
    return std::min(1.0, 2.0 * std::min(evidence.p(shown.evidence), fall.p(shown.fall)));
  }
};

class CourseSearch {
 public:
  CourseSearch(const CourseData& data, const Fit& model, const std::vector<Term>& catalogue,
               std::uint64_t seed)
      : data_(data), model_(model.terms), catalogue_(catalogue), seed_(seed) {
    std::map<std::string, std::size_t> instances;
    for (const Term& term : catalogue) ++instances[term.effect->info.name];
    for (std::size_t t = 0; t < catalogue.size(); ++t) {
      const Term& term = catalogue[t];
      if (std::any_of(model_.begin(), model_.end(),
                      [&](const Term& m) { return m.name() == term.name(); }) ||
          instances[term.effect->info.name] > most_instances)
        continue;
      for (const CourseColumns& one : data_.on_grid(term))
        entries_.push_back({t, one.shape, one.columns, {}});
    }
    CourseNoise noise = noise_of_fit(data_);
    fill(noise);
    set_ = best();
    if (const double scatter = most_likely_scatter(data_, noise, model_with(set_));
        scatter != noise.scatter) {
      noise.scatter = scatter;
      fill(noise);
      set_ = best();
    }
  }

  const Set& found() const { return set_; }

  /// Pool indices; -1 at the end if a column occurs twice, because such a set cannot be fitted.
  std::vector<Index> columns_of(const Set& set) const {
    std::vector<Index> out = base_;
    for (const std::size_t e : set)
      out.insert(out.end(), entries_[e].columns.begin(), entries_[e].columns.end());
    std::sort(out.begin(), out.end());
    const bool twice = std::adjacent_find(out.begin(), out.end()) != out.end();
    if (twice) out.push_back(-1);
    return out;
  }

  static bool has_twice(const std::vector<Index>& columns) {
    return !columns.empty() && columns.back() < 0;
  }

  double level_of(const Set& set) const {
    const auto columns = columns_of(set);
    if (has_twice(columns)) return std::numeric_limits<double>::infinity();
    return pool_->cost(columns, *sides_).mean();
  }

  bool has_term(const Set& set, std::size_t term) const {
    return std::any_of(set.begin(), set.end(),
                       [&](std::size_t e) { return entries_[e].term == term; });
  }

  /// Returns, for each term, its best entry in addition to `set`, and -ln of the evidence with it.
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

  /// A fast and an opposite slow response of one channel are detected only together.
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

  /// Compares the best set of each size under its most likely noise, with a penalty per effect. All
  /// sets contain `begun`.
  Set best(const Set& begun = {}) const {
    std::vector<Set> beam{begun};
    std::vector<std::pair<Set, double>> best{{begun, level_of(begun)}};
    for (std::size_t size = begun.size() + 1; size + model_.size() <= most_terms; ++size) {
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
      if (size == 2 && begun.empty()) add_pairs(grown);
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
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < best.size(); ++k) {
      const double cost =
          likely_cost(data_, model_with(best[k].first)) + static_cast<double>(k) * pool_->penalty();
      if (cost < least) least = cost, chosen = k;
    }
    return best[chosen].first;
  }

  /// Distribution of the gain by the best further term in addition to `set`, under the hypothesis
  /// that no further effect exists.
  SearchInCopies chance_with(const Set& set) const {
    const std::vector<Index> columns = columns_of(set);
    const CourseSides sides = sides_of_copies(columns);
    const Eigen::RowVectorXd before = pool_->cost(columns, sides);
    std::vector<double> gained(copies, 0.0);
    std::vector<std::vector<Index>> best(copies, columns);
    for (std::size_t e = 0; e < entries_.size(); ++e) {
      if (has_term(set, entries_[e].term)) continue;
      const auto more = columns_of(with(set, e));
      if (has_twice(more)) continue;
      const Eigen::RowVectorXd gain = before - pool_->cost(more, sides);
      for (std::size_t c = 0; c < copies; ++c)
        if (const double mean = gain.segment(first_of(c), together()).mean(); mean > gained[c])
          gained[c] = mean, best[c] = more;
    }
    std::vector<double> fell;
    for (std::size_t c = 0; c < copies; ++c)
      fell.push_back(left_out(columns, sides, first_of(c)) - left_out(best[c], sides, first_of(c)));
    return {InCopies(gained), InCopies(fell)};
  }

  /// ln(RMS) of the cross-validation, averaged over displacements that are searched together.
  double left_out(const Set& set) const { return left_out(columns_of(set), *sides_, 0); }

  /// Compares the gain of columns added one by one to the readings with the gain in surrogates.
  double p_of_search() const {
    const CourseSides sides = sides_of_copies(base_);
    std::vector<double> gained, fell;
    for (std::size_t c = 0; c < copies; ++c) {
      const Shown shown = shown_one_by_one(sides, first_of(c));
      gained.push_back(shown.evidence);
      fell.push_back(shown.fall);
    }
    return SearchInCopies{InCopies(gained), InCopies(fell)}.p(shown_one_by_one(*sides_, 0));
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
  /// Returns the RMS of the cross-validation of this displacement alone, m.
  double left_out_with(const Set& set) const {
    const auto columns = columns_of(set);
    return has_twice(columns) ? std::numeric_limits<double>::infinity()
                              : pool_->left_out(columns, *sides_, 0);
  }
  double penalty() const { return pool_->penalty(); }
  /// Returns the difference of ln evidence below which two explanations are not separable.
  double same() const { return static_cast<double>(data_.size()) * std::log(same_rms); }

 private:
  double left_out(const std::vector<Index>& columns, const CourseSides& sides, Index from) const {
    if (has_twice(columns)) return std::numeric_limits<double>::infinity();
    double sum = 0.0;
    for (Index j = 0; j < together(); ++j)
      sum += std::log(pool_->left_out(columns, sides, from + j));
    return sum / static_cast<double>(together());
  }

  Shown shown_one_by_one(const CourseSides& sides, Index from) const {
    const auto greedy = pool_->greedy(base_, sides, from, together());
    std::vector<Index> columns = base_;
    const double before = left_out(columns, sides, from);
    Shown out{greedy.gain, 0.0};
    for (const Index added : greedy.added) {
      columns.push_back(added);
      out.fall = std::max(out.fall, before - left_out(columns, sides, from));
    }
    return out;
  }

  Index together() const { return data_.displacements().cols(); }
  Index first_of(std::size_t copy) const { return static_cast<Index>(copy) * together(); }

  void fill(const CourseNoise& noise) {
    pool_.emplace(data_, noise);
    base_.clear();
    for (const Term& term : model_) {
      const auto columns = term.effect->columns(data_.part().table, term.axis, term.shape);
      if (!columns) continue;
      for (const Index at : pool_->add(data_.means(*columns), quantities_of(term)))
        base_.push_back(at);
    }
    for (Entry& entry : entries_)
      entry.columns = pool_->add(entry.made, quantities_of(catalogue_[entry.term]));
    pool_->finish();
    sides_.emplace(*pool_, data_.displacements());
  }

  CourseModel model_with(const Set& set) const {
    CourseModel out{MatrixXd(data_.size(), 0)};
    for (const Term& term : model_)
      if (const auto made = term.effect->columns(data_.part().table, term.axis, term.shape); made)
        out.add(data_.means(*made), quantities_of(term));
    for (const std::size_t e : set)
      out.add(entries_[e].made, quantities_of(catalogue_[entries_[e].term]));
    return out;
  }

  CourseSides sides_of_copies(const std::vector<Index>& columns) const {
    const MatrixXd rest = pool_->remainder(columns, data_.displacements());
    MatrixXd made(data_.size(), together() * static_cast<Index>(copies));
    SplitMix64 random(seed_);
    for (std::size_t c = 0; c < copies; ++c)
      made.middleCols(first_of(c), together()) = copy_of(rest, random);
    return {*pool_, made};
  }

  /// Keeps the spectrum of the changes and the coherence between displacements; phases are random.
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

  const CourseData& data_;
  std::vector<Term> model_;
  const std::vector<Term>& catalogue_;
  std::optional<CoursePool> pool_;
  std::uint64_t seed_;
  std::vector<Index> base_;
  std::vector<Entry> entries_;
  std::optional<CourseSides> sides_;
  Set set_;
};

class CourseExplanation {
 public:
  CourseExplanation(const CourseData& data, const std::vector<Term>& model,
                    const std::vector<Term>& catalogue, std::uint64_t seed, Comparison comparison)
      : data_(data), model_(model), search_(data, comparison.fit, catalogue, seed) {
    out_.comparison = std::move(comparison);
  }

  Explanation made() {
    set_ = search_.found();
    const auto singles = search_.best_with({});
    if (search_.p_of_search() < named_p) {
      set_ = proven(std::move(set_));
      begin_with_best_alone(singles);
      judge_members();
    } else {
      set_.clear();
    }
    const double alone = search_.level_of({}), all = search_.level_of(set_);
    const SearchInCopies further = search_.chance_with(set_);
    for (Member& member : members_) {
      const auto single = singles.find(search_.entry(member.entry).term);
      if (single != singles.end()) {
        member.alone = alone - single->second.second;
        member.predicts = search_.left_out({}) - search_.left_out({single->second.first});
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
      add(one.first, {alone - one.second, gain}, further.p({gain, improved}));
    }
    std::stable_sort(out_.candidates.begin(), out_.candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
    for (std::size_t i = 0; i < out_.candidates.size(); ++i)
      fit(out_.candidates[i], i < fitted_anew || is_member(out_.candidates[i]));
    judge();
    return std::move(out_);
  }

 private:
  /// An effect of the best set; loss: ln evidence without the effect; p: p-value of this loss.
  struct Member {
    std::size_t entry;
    double loss, p;
    double alone = 0.0;     ///< gain of ln evidence as the only addition to the model
    double predicts = 0.0;  ///< decrease of ln(RMS) of the cross-validation as the only addition
  };

  /// Evidence can increase while blocks of time that are left out are predicted worse. Drops the
  /// effects whose values are below their uncertainties, and those without which these blocks are
  /// predicted at least as well, but not those of `kept`.
  Set proven(Set set, const Set& kept = {}) const {
    Whole now = whole(set);
    while (!set.empty()) {
      Set best;
      Whole least;
      for (const std::size_t e : set) {
        const bool weak = contains(now.weak, search_.term_of(e).name());
        if ((!weak && !now.weak.empty()) || std::find(kept.begin(), kept.end(), e) != kept.end())
          continue;
        Set others = CourseSearch::without(set, e);
        if (Whole one = whole(others); best.size() != others.size() || one.ln_rms < least.ln_rms)
          least = std::move(one), best = std::move(others);
      }
      if (best.size() + 1 != set.size() || (now.weak.empty() && least.ln_rms > now.ln_rms)) break;
      now = std::move(least), set = std::move(best);
    }
    return set;
  }

  /// Several sensors can together imitate the one that shows the cause, with less of its noise. The
  /// effect that alone predicts left-out blocks best is preferred if it leaves only noise, or comes
  /// closer (in ln RMS) to the whole set than to the best effect of the set alone.
  void begin_with_best_alone(const std::map<std::size_t, std::pair<std::size_t, double>>& singles) {
    constexpr double none = std::numeric_limits<double>::infinity();
    double least = none, least_of_set = none;
    std::size_t alone = 0;
    for (const auto& [term, one] : singles) {
      const double ln_rms = search_.left_out({one.first});
      if (ln_rms < least) least = ln_rms, alone = one.first;
      if (search_.has_term(set_, term)) least_of_set = std::min(least_of_set, ln_rms);
    }
    if (set_.empty() || !(least < least_of_set)) return;
    Set other{alone};
    if (const Whole one = whole(other); !one.only_noise) {
      if (!(2.0 * one.ln_rms < whole(set_).ln_rms + least_of_set)) return;
      other = proven(search_.best(other), other);
    }
    set_ = std::move(other);
    first_ = search_.term_of(alone).name();
  }

  /// A set fitted with its shapes searched again, as in the model that users would get.
  struct Whole {
    double ln_rms = std::numeric_limits<double>::infinity();  ///< of the cross-validation
    std::vector<std::string> weak;  ///< effects of the set with values below their uncertainties
    bool only_noise = false;        ///< whether successive readings differ as much as all readings
  };

  Whole whole(const Set& set) const {
    std::vector<Term> terms = model_;
    for (const std::size_t e : set) {
      terms.push_back(search_.term_of(e));
      terms.back().shape.clear();
    }
    Whole out;
    const auto fit = fit_course(data_, terms);
    if (!fit) return out;
    out.ln_rms = ln_left_out_rms(data_, fit->terms);
    out.only_noise = leaves_only_noise(fit->rms, floor_of(fit->residual));
    const auto below = below_uncertainty(*fit);
    for (const std::size_t e : set)
      if (contains(below, search_.term_of(e).name())) out.weak.push_back(search_.term_of(e).name());
    return out;
  }

  static bool contains(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  }

  void judge_members() {
    const double all = search_.level_of(set_);
    for (const std::size_t e : set_) {
      const Set others = CourseSearch::without(set_, e);
      const double loss = search_.level_of(others) - all;
      const double fall = search_.left_out(others) - search_.left_out(set_);
      members_.push_back({e, loss, search_.chance_with(others).p({loss, fall})});
    }
  }

  void add_member(const Member& member, double all) {
    const std::size_t e = member.entry;
    const Set others = CourseSearch::without(set_, e);
    add(e, {member.alone, member.loss}, member.p);
    Candidate& c = out_.candidates.back();
    // An effect that can replace the member with nearly equal evidence cannot be separated from it.
    for (const auto& [term, one] : search_.best_with(others))
      if (term != search_.entry(e).term && !search_.has_term(set_, term) &&
          one.second < all + search_.same())
        c.aliases.push_back(search_.term_of(one.first).name());
    best_ = std::max(best_, {member.predicts, c.term.name()});
    if (member.p < named_p) certain_.emplace_back(member.predicts, c.term.name());
  }

  /// Gain of ln evidence as the only addition to the model, and in addition to the best set.
  struct Gain {
    double alone, within;
  };

  void add(std::size_t e, const Gain& gain, double p) {
    Candidate c;
    c.term = search_.term_of(e);
    c.cv_rms = search_.left_out_with({e});
    c.minimal_detectable = std::numeric_limits<double>::quiet_NaN();  // not determined for a course
    c.p = p;
    const bool member = std::find(set_.begin(), set_.end(), e) != set_.end();
    c.alone = 2.0 * (gain.alone - search_.penalty());
    c.within = 2.0 * (gain.within - search_.penalty());
    c.score = member ? std::max(c.alone, c.within) : c.within;
    c.term.shape = search_.entry(e).shape;
    out_.candidates.push_back(std::move(c));
  }

  /// If `anew`, the shapes of the model are searched again, and those of the candidate if it is a
  /// member of the best set or nothing was found. A candidate whose fit fails is not visible.
  void fit(Candidate& c, bool anew) {
    std::vector<Term> terms = anew ? model_ : out_.comparison.fit.terms;
    terms.push_back(c.term);
    if (anew && (set_.empty() || is_member(c))) terms.back().shape.clear();
    if (const auto fit = fit_course(data_, terms)) {
      c.rms = fit->rms;
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
    v.trials = copies;
    v.false_alarms = named_p;
    if (!set_.empty()) {
      if (const auto fit = fit_course(data_, terms)) {
        out_.best_rms = out_.significant_rms = fit->rms;
        out_.sensors = sensors_of(data_.part(), *fit);
      }
      v.kind = Verdict::Kind::missing;
      v.effect = !first_.empty() ? first_ : certain_.empty() ? best_.second : out_.certain.front();
      // The verdict and its numbers must be those of the first candidate.
      std::stable_partition(out_.candidates.begin(), out_.candidates.end(),
                            [&](const Candidate& c) { return c.term.name() == v.effect; });
      for (const Candidate& c : out_.candidates)
        out_.candidates.front().score = std::max(out_.candidates.front().score, c.score);
      return;
    }
    out_.sensors = sensors_of(data_.part(), out_.comparison.fit);
    v.kind = leaves_only_noise(out_.comparison.fit.rms, out_.comparison.floor)
                 ? Verdict::Kind::nothing
                 : Verdict::Kind::unknown;
  }

  static bool leaves_only_noise(double rms, const std::optional<NoiseFloor>& floor) {
    return floor && rms <= of_floor * floor->s;
  }

  const CourseData& data_;
  const std::vector<Term>& model_;
  CourseSearch search_;
  Set set_;
  std::vector<Member> members_;
  std::vector<std::pair<double, std::string>> certain_;
  std::string first_;  ///< effect that alone explains most, if the set was begun with it
  std::pair<double, std::string> best_{-std::numeric_limits<double>::infinity(), ""};
  Explanation out_;
};

}  // namespace

Expected<Explanation> explain_course(const Part& part, const std::vector<Term>& model,
                                     const std::vector<Term>& catalogue, std::uint64_t seed) {
  const CourseData data(part);
  auto fit = fit_course(data, model);
  if (!fit) return fail(fit.error());
  Comparison comparison = comparison_of_course(part, std::move(*fit));
  return CourseExplanation(data, model, catalogue, seed, std::move(comparison)).made();
}

}  // namespace nonio::model
