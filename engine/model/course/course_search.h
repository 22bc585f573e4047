// SPDX-License-Identifier: Apache-2.0
#pragma once

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

using CourseSet = std::vector<std::size_t>;  // entry indices, ascending

/// One shape of an effect that is not in the model.
struct CourseEntry {
  std::size_t term;
  std::vector<double> shape;
  MatrixXd made;
  std::vector<Index> columns;
};

/// Gain of ln evidence, and decrease of ln(RMS) of the cross-validation, by added columns.
struct CourseGain {
  double evidence, fall;
};

/// Gumbel distribution of the largest gain that a search finds in surrogates of a residual.
struct CourseCopies {
  double at = 0.0, width = 0.0;

  explicit CourseCopies(const std::vector<double>& found) {
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
struct CourseChance {
  CourseCopies evidence, fall;

  double p(const CourseGain& shown) const {
    return std::min(1.0, 2.0 * std::min(evidence.p(shown.evidence), fall.p(shown.fall)));
  }
};

/// Sets of at most six effects are compared by their evidence under noise that is correlated in
/// time. The effect of chance is determined by the same search in surrogates of the residual with
/// random phases (Theiler et al. 1992).
class CourseSearch {
 public:
  static constexpr std::size_t copies = 100;  // docs/dev/constants.md, M40

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

  const CourseSet& found() const { return set_; }

  /// Pool indices; -1 at the end if a column occurs twice, because such a set cannot be fitted.
  std::vector<Index> columns_of(const CourseSet& set) const {
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

  /// -ln of the evidence, averaged over displacements that are searched together.
  double level_of(const CourseSet& set) const {
    const auto columns = columns_of(set);
    if (has_twice(columns)) return std::numeric_limits<double>::infinity();
    return pool_->cost(columns, *sides_).mean();
  }

  /// -ln of the evidence of this displacement alone.
  double own_level_of(const CourseSet& set) const {
    const auto columns = columns_of(set);
    if (has_twice(columns)) return std::numeric_limits<double>::infinity();
    return pool_->cost(columns, *sides_)(0);
  }

  bool has_term(const CourseSet& set, std::size_t term) const {
    return std::any_of(set.begin(), set.end(),
                       [&](std::size_t e) { return entries_[e].term == term; });
  }

  /// Returns, for each term, its best entry in addition to `set`, and -ln of the evidence with it.
  std::map<std::size_t, std::pair<std::size_t, double>> best_with(const CourseSet& set) const {
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
  void add_pairs(std::map<CourseSet, double>& grown) const {
    for (std::size_t a = 0; a < entries_.size(); ++a)
      for (std::size_t b = a + 1; b < entries_.size(); ++b) {
        if (entries_[a].term == entries_[b].term ||
            catalogue_[entries_[a].term].axis.name != catalogue_[entries_[b].term].axis.name)
          continue;
        CourseSet pair{a, b};
        if (grown.contains(pair)) continue;
        const double l = level_of(pair);
        grown.emplace(std::move(pair), l);
      }
  }

  /// Compares the best set of each size under its most likely noise, with a penalty per effect. All
  /// sets contain `begun`.
  CourseSet best(const CourseSet& begun = {}) const {
    std::vector<CourseSet> beam{begun};
    std::vector<std::pair<CourseSet, double>> best{{begun, level_of(begun)}};
    for (std::size_t size = begun.size() + 1; size + model_.size() <= most_terms; ++size) {
      std::map<CourseSet, double> grown;
      for (const CourseSet& set : beam)
        for (std::size_t e = 0; e < entries_.size(); ++e)
          if (!has_term(set, entries_[e].term)) {
            CourseSet more = with(set, e);
            if (!grown.contains(more)) {
              const double l = level_of(more);
              grown.emplace(std::move(more), l);
            }
          }
      if (size == 2 && begun.empty()) add_pairs(grown);
      std::vector<std::pair<CourseSet, double>> all(grown.begin(), grown.end());
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
  CourseChance chance_with(const CourseSet& set) const {
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
    return {CourseCopies(gained), CourseCopies(fell)};
  }

  /// ln(RMS) of the cross-validation, averaged over displacements that are searched together.
  double left_out(const CourseSet& set) const { return left_out(columns_of(set), *sides_, 0); }

  /// The best of three criteria, with Bonferroni correction: what columns that are added one by one
  /// gain and predict, and what one effect alone predicts.
  double p_of_search() const {
    const CourseSides sides = sides_of_copies(base_);
    std::vector<double> gained, fell, fell_by_one;
    for (std::size_t c = 0; c < copies; ++c) {
      const CourseGain shown = shown_one_by_one(sides, first_of(c));
      gained.push_back(shown.evidence);
      fell.push_back(shown.fall);
      fell_by_one.push_back(fall_by_one(sides, first_of(c)));
    }
    const CourseGain shown = shown_one_by_one(*sides_, 0);
    return std::min(1.0, 3.0 * std::min({CourseCopies(gained).p(shown.evidence),
                                         CourseCopies(fell).p(shown.fall),
                                         CourseCopies(fell_by_one).p(fall_by_one(*sides_, 0))}));
  }

  static CourseSet with(const CourseSet& set, std::size_t e) {
    CourseSet out = set;
    out.insert(std::lower_bound(out.begin(), out.end(), e), e);
    return out;
  }
  static CourseSet without(const CourseSet& set, std::size_t e) {
    CourseSet out = set;
    std::erase(out, e);
    return out;
  }

  Term term_of(std::size_t e) const { return catalogue_[entries_[e].term]; }
  const CourseEntry& entry(std::size_t e) const { return entries_[e]; }
  /// Returns the RMS of the cross-validation of this displacement alone, m.
  double left_out_with(const CourseSet& set) const {
    const auto columns = columns_of(set);
    return has_twice(columns) ? std::numeric_limits<double>::infinity()
                              : pool_->left_out(columns, *sides_, 0);
  }
  double penalty() const { return pool_->penalty(); }

 private:
  double left_out(const std::vector<Index>& columns, const CourseSides& sides, Index from) const {
    if (has_twice(columns)) return std::numeric_limits<double>::infinity();
    double sum = 0.0;
    for (Index j = 0; j < together(); ++j)
      sum += std::log(pool_->left_out(columns, sides, from + j));
    return sum / static_cast<double>(together());
  }

  CourseGain shown_one_by_one(const CourseSides& sides, Index from) const {
    const auto greedy = pool_->greedy(base_, sides, from, together());
    std::vector<Index> columns = base_;
    const double before = left_out(columns, sides, from);
    CourseGain out{greedy.gain, 0.0};
    for (const Index added : greedy.added) {
      columns.push_back(added);
      out.fall = std::max(out.fall, before - left_out(columns, sides, from));
    }
    return out;
  }

  double fall_by_one(const CourseSides& sides, Index from) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t e = 0; e < entries_.size(); ++e)
      least = std::min(least, left_out(columns_of({e}), sides, from));
    const double before = left_out(base_, sides, from);
    return std::isfinite(least) ? std::max(0.0, before - least) : 0.0;
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
    for (CourseEntry& entry : entries_)
      entry.columns = pool_->add(entry.made, quantities_of(catalogue_[entry.term]));
    pool_->finish();
    sides_.emplace(*pool_, data_.displacements());
  }

  CourseModel model_with(const CourseSet& set) const {
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
        if (!data_.begins_line(i + 1))
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

  static constexpr std::size_t most_terms = 6, kept_sets = 12, most_instances = 64;

  const CourseData& data_;
  std::vector<Term> model_;
  const std::vector<Term>& catalogue_;
  std::optional<CoursePool> pool_;
  std::uint64_t seed_;
  std::vector<Index> base_;
  std::vector<CourseEntry> entries_;
  std::optional<CourseSides> sides_;
  CourseSet set_;
};

}  // namespace nonio::model
