// SPDX-License-Identifier: Apache-2.0
#include "nonio/model/explain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "compare.h"
#include "nonio/math/distributions.h"
#include "nonio/math/statistics.h"
#include "places.h"
#include "plans.h"
#include "search.h"
#include "thin.h"

namespace nonio::model {

namespace {

using State = Workbench::State;

constexpr double alias_evidence = 6.0;  // 2 ln 20: one twentieth of the evidence is no difference
constexpr double least_rms = 0.2;       // of the noise: smaller effects are not worth a name
constexpr double least_left = 0.25;     // of the noise: smaller structure is not worth a verdict
constexpr double serious_p = 0.005;
constexpr double memory_p = 1e-4;       // noise without a memory looks so once in 10,000
constexpr double most_suspects = 0.06;  // of the readings; beyond, they do not repeat
// What is left in the same place, of what the candidate says: beyond, the candidate is not it.
constexpr double unexplained_share = 0.04;

class Explainer {
 public:
  Explainer(const Part& part, const std::vector<Term>& model, const std::vector<Term>& catalogue,
            std::uint64_t seed)
      : part_(part), repeats_(part.table), model_(model), seed_(seed) {
    terms_ = model;
    for (const Term& c : catalogue)
      if (std::none_of(model.begin(), model.end(),
                       [&](const Term& m) { return m.name() == c.name(); }))
        terms_.push_back(c);
  }

  Expected<Explanation> run() {
    suspects_ = suspects_of(part_.table, repeats_, part_.table.deviation);
    for (int round = 0; round < 3; ++round) {
      if (auto searched = search(); !searched) return fail(searched.error());
      if (!suspect_again()) break;
    }
    chance_ = measure_chance(
        *bench_, best_, shuffled(residual_of(best_), bench_->basis(best_), repeats_.pass, seed_));
    prune();
    if (auto fitted = fit_both(); !fitted) return fail(fitted.error());
    rank();
    judge();
    return std::move(out_);
  }

 private:
  Expected<void> search() {
    weight_ = weights_without(part_.table.size(), suspects_);
    bench_.emplace(part_.table, terms_, weight_, repeats_.target);
    auto start = started(false);
    if (!start) return fail(start.error());
    start_ = std::move(*start);
    // Instants and periods of a model hold each other fast: tried from two sides.
    if (const auto other = started(true); other && other->squares < start_.squares) start_ = *other;
    best_ = best_explanation(*bench_, start_);
    // What lies between the values of a grid would be taken for an effect of its own.
    const bool finer = add_refined(start_);
    if (add_refined(best_) || finer) {
      start_ = bench_->settled(std::move(start_));
      best_ = best_explanation(*bench_, start_);
    }
    return {};
  }

  /// The model with its shapes searched; its terms come in as they are written, or those first that
  /// explain most.
  Expected<State> started(bool largest_first) const {
    State start = bench_->state({});
    std::vector<std::size_t> open(model_.size());
    std::iota(open.begin(), open.end(), std::size_t{0});
    while (!open.empty()) {
      const VectorXd gains = bench_->gains(start);
      State best;
      std::size_t at = open.size();
      for (std::size_t k = 0; k < (largest_first ? open.size() : 1); ++k) {
        State next = bench_->with(start, gains, open[k]);
        if (next.blocks.size() == start.blocks.size()) {
          const std::string& why = bench_->instances()[open[k]].error;
          return fail(!why.empty() ? why
                                   : "the readings cannot tell " + model_[open[k]].name() +
                                         " from the rest of the model");
        }
        if (at == open.size() || next.squares < best.squares) best = std::move(next), at = k;
      }
      start = std::move(best);
      open.erase(open.begin() + static_cast<std::ptrdiff_t>(at));
    }
    return in_order(bench_->settled(std::move(start)));
  }

  /// Blocks in the order of the model.
  State in_order(State state) const {
    std::sort(state.blocks.begin(), state.blocks.end(), [&](std::size_t a, std::size_t b) {
      return bench_->effect_of(a) < bench_->effect_of(b);
    });
    return state;
  }

  /// Shapes of a state between the values of their grids, as values of the grids.
  bool add_refined(const State& state) {
    const std::vector<Term> coarse = terms_of_state(state);
    const std::vector<char> searched = flags(state, true);
    const auto fitted = fit_near(part_.table, coarse, searched, weight_);
    if (!fitted) return false;
    bool any = false;
    for (std::size_t t = 0; t < coarse.size(); ++t) {
      if (fitted->terms[t].shape == coarse[t].shape) continue;
      bench_->add_shape(part_.table, bench_->effect_of(state.blocks[t]), fitted->terms[t].shape);
      any = true;
    }
    return any;
  }

  VectorXd residual_of(const State& state) const {
    const MatrixXd basis = bench_->basis(state);
    return bench_->y() - basis * (basis.transpose() * bench_->y());
  }

  /// Whether the best explanation suspects other readings than before.
  bool suspect_again() {
    const std::size_t n = part_.table.size();
    const auto fitted = fit_near(part_.table, terms_of_state(best_), flags(false), weight_);
    if (!fitted) return false;
    const std::vector<double>& e = fitted->residual;
    const double s = math::robust_deviation(e);
    if (!(s > 0.0)) return false;
    double least = 3.0;
    while (math::t_two_sided(least, 50.0) * static_cast<double>(n) > 0.01) least += 0.05;
    std::vector<std::uint32_t> high;
    for (std::uint32_t i = 0; i < n; ++i)
      if (std::fabs(e[i]) >= least * s) high.push_back(i);
    const std::vector<double> apart = apart_from_others(repeats_, high, e);
    std::vector<Suspect> now;
    for (std::size_t k = 0; k < high.size(); ++k)
      if (std::fabs(apart[k]) >= least * s)
        now.push_back({high[k], e[high[k]], e[high[k]] / s, least * s});
    if (now.size() > n / 8) return false;
    const bool changed =
        now.size() != suspects_.size() ||
        !std::equal(now.begin(), now.end(), suspects_.begin(),
                    [](const Suspect& a, const Suspect& b) { return a.row == b.row; });
    suspects_ = std::move(now);
    return changed;
  }

  std::vector<Term> terms_of_state(const State& state) const {
    std::vector<Term> terms;
    for (const std::size_t b : state.blocks) {
      terms.push_back(bench_->instances()[bench_->effect_of(b)].term);
      terms.back().shape = bench_->blocks()[b].shape;
    }
    return terms;
  }
  std::vector<char> flags(bool searched) const { return flags(best_, searched); }
  std::vector<char> flags(const State& state, bool searched) const {
    std::vector<char> out;
    for (const std::size_t b : state.blocks) {
      const Term& term = bench_->instances()[bench_->effect_of(b)].term;
      out.push_back(searched && term.shape.empty() && !term.effect->shapes.empty());
    }
    return out;
  }

  bool in_model(std::size_t effect) const { return effect < model_.size(); }

  /// Effects that noise could have given, or too small to matter, leave the best explanation.
  void prune() {
    while (true) {
      std::size_t weakest = terms_.size();
      double largest_p = 0.0;
      const double s = std::sqrt(best_.squares / std::max(dof_of(best_), 1.0));
      for (const std::size_t b : best_.blocks) {
        const std::size_t e = bench_->effect_of(b);
        if (in_model(e)) continue;
        const double p = chance_.corrected(p_of(*bench_, best_, e));
        const double fall = bench_->without(best_, e).squares - best_.squares;
        const bool small = std::sqrt(fall / bench_->readings()) < least_rms * s;
        if ((p >= named_below || small) && p >= largest_p) {
          weakest = e;
          largest_p = p;
        }
      }
      if (weakest == terms_.size()) return;
      best_ = bench_->settled(bench_->without(best_, weakest));
    }
  }

  double dof_of(const State& state) const {
    return bench_->readings() - static_cast<double>(bench_->zeros() + state.parameters);
  }

  Expected<void> fit_both() {
    auto of_model = fit_near(part_.table, terms_of_state(start_), flags(start_, true), weight_);
    if (!of_model) return fail(of_model.error());
    out_.comparison = comparison_of(part_, repeats_, std::move(*of_model), suspects_);
    auto of_best = fit_near(part_.table, terms_of_state(best_), flags(true), weight_);
    if (!of_best) return fail(of_best.error());
    best_fit_ = comparison_of(part_, repeats_, std::move(*of_best), suspects_);
    return {};
  }

  void rank() {
    for (std::size_t e = model_.size(); e < terms_.size(); ++e)
      out_.candidates.push_back(candidate(e));
    std::stable_sort(out_.candidates.begin(), out_.candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
    for (const Candidate& c : out_.candidates)
      if (c.visible && bench_->holds(best_, index_of(c.term.name())))
        out_.together.push_back(c.term.name());
  }

  std::size_t index_of(const std::string& name) const {
    return static_cast<std::size_t>(std::find_if(terms_.begin(), terms_.end(),
                                                 [&](const Term& t) { return t.name() == name; }) -
                                    terms_.begin());
  }

  Candidate candidate(std::size_t e) {
    Candidate c;
    c.term = terms_[e];
    c.score = -std::numeric_limits<double>::infinity();
    const State alone = bench_->with(start_, bench_->gains(start_, e), e);
    if (alone.blocks.size() == start_.blocks.size()) {
      c.visible = false;
      c.why = bench_->instances()[e].blocks.empty() ? "not-shown" : "aliased";
      return c;
    }
    const bool member = bench_->holds(best_, e);
    std::size_t block = alone.blocks.back();
    if (member) {
      for (const std::size_t b : best_.blocks)
        if (bench_->effect_of(b) == e) block = b;
      c.score = bench_->without(best_, e).criterion - best_.criterion;
      c.p = chance_.corrected(p_of(*bench_, best_, e));
      c.aliases = aliases_of(e);
    } else {
      score_outsider(e, c);
    }
    c.term.shape = bench_->blocks()[block].shape;
    c.minimal_detectable = minimal_detectable(e, block);
    fit_candidate(e, c);
    return c;
  }

  /// Effects that can stand for a member of the best explanation at hardly any loss.
  std::vector<std::string> aliases_of(std::size_t member) {
    std::vector<std::string> names;
    const State rest = bench_->without(best_, member);
    const VectorXd gains = bench_->gains(rest);
    for (std::size_t other = model_.size(); other < terms_.size(); ++other) {
      if (other == member || bench_->holds(best_, other)) continue;
      const State changed = bench_->settled(bench_->with(rest, gains, other));
      if (changed.blocks.size() > rest.blocks.size() &&
          changed.criterion < best_.criterion + alias_evidence)
        names.push_back(terms_[other].name());
    }
    return names;
  }

  /// Evidence of an effect outside the best explanation: added to it, or instead of a member.
  void score_outsider(std::size_t e, Candidate& c) {
    const State more = bench_->with(best_, bench_->gains(best_, e), e);
    if (more.blocks.size() > best_.blocks.size()) {
      c.score = best_.criterion - more.criterion;
      c.p = chance_.corrected(p_of(*bench_, more, e));
    }
    for (const std::size_t b : best_.blocks) {
      const std::size_t member = bench_->effect_of(b);
      if (in_model(member)) continue;
      const State rest = bench_->without(best_, member);
      const State changed = bench_->with(rest, bench_->gains(rest, e), e);
      if (changed.blocks.size() == rest.blocks.size()) continue;
      const double score = rest.criterion - changed.criterion;
      if (score <= c.score) continue;
      c.score = score;
      c.p = chance_.corrected(p_of(*bench_, changed, e));
      if (changed.criterion < best_.criterion + alias_evidence) c.aliases = {terms_[member].name()};
    }
  }

  /// Root mean square of the smallest such effect that the search would name nine times in ten.
  double minimal_detectable(std::size_t e, std::size_t block) const {
    const Workbench::Block& b = bench_->blocks()[block];
    State rest = bench_->holds(best_, e) ? bench_->without(best_, e) : best_;
    const MatrixXd basis = bench_->basis(rest);
    const MatrixXd columns = bench_->columns().middleCols(b.first, b.count);
    const double visible =
        (columns - basis * (basis.transpose() * columns)).squaredNorm() / columns.squaredNorm();
    const double s = std::sqrt(best_.squares / std::max(dof_of(best_), 1.0));
    const double needed = std::sqrt(bench_->price(e, b.count)) + 1.28;  // Phi^-1(0.9)
    return s * needed / std::sqrt(bench_->readings() * std::max(visible, 1e-12));
  }

  void fit_candidate(std::size_t e, Candidate& c) {
    std::vector<Term> terms;
    for (const Term& t : out_.comparison.fit.terms) terms.push_back(t);
    terms.push_back(c.term);
    const auto fitted = fit_near(part_.table, terms, std::vector<char>(terms.size(), 0), weight_);
    if (!fitted) return;
    c.rms = fitted->rms;
    c.cv_rms = rms_of(cross_validated(part_.table, terms, weight_), weight_);
    const Fit& from = bench_->holds(best_, e) ? best_fit_.fit : *fitted;
    for (const Parameter& p : from.parameters)
      if (p.effect == c.term.name()) c.parameters.push_back(p);
    for (const Term& t : from.terms)
      if (t.name() == c.term.name()) c.term.shape = t.shape;
  }

  static bool same_factor(const std::string& a, const std::string& b) {
    const auto factors = [](const std::string& where) {
      std::vector<std::string> out;
      const std::size_t x = where.find(" x ");
      out.push_back(where.substr(0, x));
      if (x != std::string::npos) out.push_back(where.substr(x + 3));
      for (std::string& f : out) {
        if (f == "run") f = "time";
        if (f == "screw-phase" || f == "angle") f = "position";
      }
      return out;
    };
    const auto of_a = factors(a), of_b = factors(b);
    return std::any_of(of_a.begin(), of_a.end(), [&](const std::string& f) {
      return std::find(of_b.begin(), of_b.end(), f) != of_b.end();
    });
  }

  /// A zero that walks: what repeats leave has a memory from one reading of a pass to the next. Its
  /// size is that of a random walk over all passes: step^2 n/6 in square, of which a pass of m
  /// readings keeps step^2 3m/70 when its curve of second degree is taken out.
  std::optional<Place> walking_zero() const {
    const Saturated left = saturate(repeats_, best_fit_.fit.residual, weight_);
    if (!(left.dof >= 8.0)) return std::nullopt;
    std::vector<double> before(repeats_.passes, std::numeric_limits<double>::quiet_NaN());
    double products = 0.0, pairs = 0.0;
    for (std::size_t i = 0; i < left.e.size(); ++i) {
      if (!(weight_[i] > 0.0)) continue;
      double& last = before[repeats_.pass[i]];
      if (std::isfinite(last)) products += last * left.e[i], ++pairs;
      last = left.e[i];
    }
    const double mean_square = left.squares / bench_->readings();
    if (!(pairs >= 20.0) || !(mean_square > 0.0)) return std::nullopt;
    const double r = products / pairs / mean_square;  // 0 +- 1/sqrt(pairs) without a memory
    const double p = 0.5 * std::erfc(r * std::sqrt(pairs / 2.0));
    if (!(p < memory_p)) return std::nullopt;
    const double square = r * mean_square * static_cast<double>(repeats_.passes) * 70.0 / 18.0;
    return Place{"time", 0.0, p, std::sqrt(square)};
  }

  /// Whether something else is left in the places where this effect works: then it may be no more
  /// than the nearest thing in the catalogue. A zero that walks can look like anything.
  bool in_doubt(const std::string& name, const std::vector<Place>& serious,
                const std::optional<Place>& walk) const {
    for (std::size_t t = 0; t < best_fit_.fit.terms.size(); ++t) {
      if (best_fit_.fit.terms[t].name() != name) continue;
      const VectorXd part = Eigen::Map<const VectorXd>(
          best_fit_.fit.part[t].data(), static_cast<Index>(best_fit_.fit.part[t].size()));
      const VectorXd centred = part.array() - part.mean();
      // What it alone can say: effects that cancel each other may both be large.
      const double rms2 =
          (bench_->without(best_, index_of(name)).squares - best_.squares) / bench_->readings();
      if (walk && walk->rms * walk->rms > unexplained_share * rms2) return true;
      const auto works_in = factors_of(part_, repeats_, bench_->root_weight(),
                                       bench_->root_weight().cwiseProduct(centred));
      for (const Place& place : serious)
        for (const std::string& where : works_in)
          if (same_factor(place.where, where) && place.rms * place.rms > unexplained_share * rms2)
            return true;
    }
    return false;
  }

  /// Structure smaller than this is not worth a verdict.
  double least_serious() const {
    return least_left * (best_fit_.floor ? best_fit_.floor->s : best_fit_.fit.s);
  }

  std::vector<Place> serious(const std::vector<Place>& places) const {
    std::vector<Place> out;
    for (const Place& place : places)
      if (place.p < serious_p && place.rms > least_serious()) out.push_back(place);
    return out;
  }

  /// Noise alone, as large as that of a reading: what repeats leave, else what the best explanation
  /// leaves (with root weights).
  VectorXd noise() const {
    const Saturated left = saturate(repeats_, best_fit_.fit.residual, weight_);
    if (!(left.dof >= 8.0)) return residual_of(best_);
    return bench_->root_weight().cwiseProduct(
               Eigen::Map<const VectorXd>(left.e.data(), static_cast<Index>(left.e.size()))) *
           std::sqrt(bench_->readings() / left.dof);
  }

  void count_false_alarms(Verdict& v) const {
    const MatrixXd basis = bench_->basis(best_);
    MatrixXd shuffles = shuffled(noise(), basis, repeats_.pass, seed_);
    take_out_zeros(part_.table, bench_->root_weight(), shuffles);
    const std::vector<char> named = named_in(*bench_, best_, shuffles, chance_);
    const PlaceTests tests(part_, repeats_, bench_->root_weight(), basis, dof_of(best_));
    double alarms = 0.0;
    for (std::size_t i = 0; i < named.size(); ++i) {
      const VectorXd one = shuffles.col(static_cast<Index>(i));
      if (named[i] != 0 || !serious(tests(one, best_fit_.floor, least_serious())).empty()) ++alarms;
    }
    v.trials = named.size();
    v.false_alarms = alarms / static_cast<double>(named.size());
  }

  /// Repeats of one target fall into two groups with nothing between them: no noise does that.
  bool two_valued() const {
    std::vector<std::pair<double, std::uint32_t>> e;  // residual and cell
    for (std::size_t i = 0; i < weight_.size(); ++i)
      if (weight_[i] > 0.0) e.emplace_back(best_fit_.fit.residual[i], repeats_.cell[i]);
    if (e.size() < 40) return false;
    std::sort(e.begin(), e.end());
    const auto n = static_cast<double>(e.size());
    double sum = 0.0, squares = 0.0;
    for (const auto& [x, cell] : e) sum += x, squares += x * x;
    double left = 0.0, best = 0.0;
    std::size_t split = 0;
    for (std::size_t i = 0; i + 1 < e.size(); ++i) {
      left += e[i].first;
      const double k = static_cast<double>(i + 1);
      if (k < 0.1 * n || k > 0.9 * n) continue;
      const double apart = left / k - (sum - left) / (n - k);
      const double between = apart * apart * k * (n - k) / n;
      const double within = (squares - sum * sum / n - between) / n;
      // Of normal noise 7, of evenly spread noise 12.
      if (apart * apart / within > best) best = apart * apart / within, split = i + 1;
    }
    if (best < 18.0) return false;
    std::vector<int> side(repeats_.cells, 0);
    for (std::size_t i = 0; i < e.size(); ++i) side[e[i].second] |= i < split ? 1 : 2;
    const auto mixed = std::count(side.begin(), side.end(), 3);
    return static_cast<double>(mixed) > 0.25 * static_cast<double>(repeats_.cells);
  }

  /// Residuals of the best explanation without what a whole pass shares.
  std::vector<double> within_passes() const {
    Repeats alone =
        repeats_;  // every reading a cell of its own would leave nothing: one cell a pass
    alone.cell = alone.pass;
    alone.cells = alone.passes;
    return saturate(alone, best_fit_.fit.residual, weight_).e;
  }

  /// One run with a scatter of its own.
  std::optional<Place> wild_run() const {
    std::vector<std::vector<double>> of_run;
    const std::vector<double> e_of = within_passes();
    for (std::size_t i = 0; i < part_.table.size(); ++i) {
      const std::size_t run = part_.table.run.empty() ? 0 : part_.table.run[i];
      if (run >= of_run.size()) of_run.resize(run + 1);
      of_run[run].push_back(e_of[i]);
    }
    double all = 0.0, n = 0.0, runs = 0.0;
    for (const auto& e : of_run) {
      for (const double x : e) all += x * x, ++n;
      runs += e.empty() ? 0.0 : 1.0;
    }
    std::optional<Place> worst;
    for (std::size_t run = 0; run < of_run.size(); ++run) {
      const auto k = static_cast<double>(of_run[run].size());
      if (k < 6.0 || n - k < 6.0) continue;
      // By its median, so that one misread value makes no wild run.
      std::vector<double> size;
      double squares = 0.0;
      for (const double x : of_run[run]) size.push_back(std::fabs(x)), squares += x * x;
      const double s = 1.4826 * math::median(size);
      std::vector<double> others;
      for (std::size_t r = 0; r < of_run.size(); ++r)
        if (r != run)
          for (const double x : of_run[r]) others.push_back(std::fabs(x));
      const double s_others = 1.4826 * math::median(others);
      const double F = s * s / (s_others * s_others);
      // A median knows a scatter as well as 0.37 times as many squares do.
      const double p = math::f_upper(F, 0.37 * k, 0.37 * (n - k)) * runs;
      if (F < 4.0 || p > 1e-4 || (worst && p >= worst->p)) continue;
      worst = Place{"run", squares / all, p, s, static_cast<double>(run), Quantity::count};
    }
    return worst;
  }

  bool contradictory() {
    if (const auto run = wild_run()) {
      out_.fails.insert(out_.fails.begin(), *run);
      return true;
    }
    return out_.verdict.suspects_share > most_suspects || two_valued();
  }

  void judge() {
    Verdict& v = out_.verdict;
    count_false_alarms(v);
    v.suspects_share =
        static_cast<double>(suspects_.size()) / static_cast<double>(part_.table.size());
    for (const Place& place : out_.comparison.places)
      if (place.p < place_p) out_.fails.push_back(place);
    std::vector<Place> serious = this->serious(best_fit_.places);
    const std::optional<Place> walk = walking_zero();
    if (contradictory()) {
      v.kind = Verdict::Kind::unrepeatable;
      return;
    }
    for (const std::string& name : out_.together)
      if (!in_doubt(name, serious, walk)) {
        v.kind = Verdict::Kind::missing;
        v.effect = name;
        break;
      }
    if (walk) serious.insert(serious.begin(), *walk);
    if (v.kind == Verdict::Kind::missing) {
      lift(v.effect);
      out_.plans = plans_for(part_, out_.comparison.fit.terms, out_.candidates.front(), terms_,
                             best_fit_.fit.s);
    } else if (!serious.empty()) {
      v.kind = Verdict::Kind::unknown;
      if (auto seats = seats_in(part_, repeats_, out_.comparison); !seats.empty())
        out_.fails = std::move(seats);
      else
        out_.fails = serious;
    }
  }

  /// The verdict's effect leads the list, also where one with more evidence is in doubt.
  void lift(const std::string& name) {
    auto& c = out_.candidates;
    const auto at =
        std::find_if(c.begin(), c.end(), [&](const Candidate& k) { return k.term.name() == name; });
    std::rotate(c.begin(), at, at + 1);
    c.front().score = std::max(c.front().score, c.size() > 1 ? c[1].score : c.front().score);
  }

  const Part& part_;
  Repeats repeats_;
  const std::vector<Term>& model_;
  std::vector<Term> terms_;  // of the model, then the catalogue's others
  std::uint64_t seed_;
  std::vector<Suspect> suspects_;
  std::vector<double> weight_;
  std::optional<Workbench> bench_;
  State start_, best_;
  Chance chance_;
  Comparison best_fit_;
  Explanation out_;
};

/// The search on means of neighbours; how well the model and each candidate do, on all readings.
Expected<Explanation> explain_on_means(const Part& part, const std::vector<Term>& model,
                                       const std::vector<Term>& catalogue, std::uint64_t seed) {
  const Repeats repeats(part.table);
  auto suspects = suspects_of(part.table, repeats, part.table.deviation);
  const auto weight = weights_without(part.table.size(), suspects);
  const Part thin{part.measurements, part.axes, thinned(part.table, weight)};
  auto out = Explainer(thin, model, catalogue, seed).run();
  if (!out) return out;
  auto whole = compare_without(part, out->comparison.fit.terms, repeats, std::move(suspects));
  if (!whole) return fail(whole.error());
  whole->places = std::move(out->comparison.places);
  whole->means = thin.table.size();
  out->comparison = std::move(*whole);
  out->verdict.suspects_share =
      static_cast<double>(out->comparison.suspects.size()) / static_cast<double>(part.table.size());
  if (out->verdict.suspects_share > most_suspects) out->verdict.kind = Verdict::Kind::unrepeatable;
  for (Candidate& c : out->candidates) {
    if (!c.visible) continue;
    std::vector<Term> terms = out->comparison.fit.terms;
    terms.push_back(c.term);
    c.rms = rms_with(part.table, terms, weight);
    c.cv_rms = rms_of(cross_validated(part.table, terms, weight), weight);
  }
  return out;
}

}  // namespace

Expected<Explanation> explain(const Part& part, const std::vector<Term>& model,
                              const std::vector<Term>& catalogue, std::uint64_t seed) {
  if (part.table.size() == 0) return fail("there are no readings of an axis to explain");
  if (part.table.size() <= thin_beyond) return Explainer(part, model, catalogue, seed).run();
  return explain_on_means(part, model, catalogue, seed);
}

}  // namespace nonio::model
