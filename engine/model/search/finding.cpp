// SPDX-License-Identifier: Apache-2.0
#include "finding.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "data/pass_zeros.h"
#include "fit/compare.h"
#include "fit/weights.h"
#include "nonio/math/distributions.h"
#include "nonio/math/statistics.h"

namespace nonio::model {

namespace {

using State = Workbench::State;

class Finder {
 public:
  Finder(const Part& part, const std::vector<Term>& model, const std::vector<Term>& catalogue,
         std::uint64_t seed)
      : f_{part, Repeats(part.table), model, model.size(), seed}, model_(model) {
    for (Term& c : offered_to(model, catalogue))
      (c.effect->description ? f_.descriptions : f_.terms).push_back(std::move(c));
    set_weights(std::span(f_.terms).subspan(f_.in_model));
  }

  Expected<Finding> run() {
    f_.suspects = suspects_of(f_.part.table, f_.repeats, model_);
    if (auto alone = suspect_without_repeats(); !alone.empty()) f_.suspects = std::move(alone);
    for (int round = 0; round < 3; ++round) {
      if (auto searched = search(); !searched) return fail(searched.error());
      if (!suspect_again()) break;
    }
    if (walks_rather()) {
      alone_ = true;
      if (auto searched = search(); !searched) return fail(searched.error());
    }
    for (int round = 0; round < 4 && passes_scatter(); ++round)
      if (auto searched = search(); !searched) return fail(searched.error());
    const SignFlips flips =
        shuffled(*f_.bench, f_.best, f_.residual(f_.best), f_.repeats.pass, f_.seed);
    f_.chance = f_.unweighted = measure_chance(*f_.bench, f_.best, flips, false);
    if (std::any_of(f_.terms.begin(), f_.terms.end(),
                    [](const Term& t) { return t.weight != 1.0; }))
      f_.chance = measure_chance(*f_.bench, f_.best, flips, true);
    prune();
    if (auto fitted = fit_both(); !fitted) return fail(fitted.error());
    return std::move(f_);
  }

 private:
  Expected<void> search() {
    f_.weight = weights_without(f_.part.table.size(), f_.suspects);
    f_.noise = noise_of(f_.part, f_.repeats, f_.weight);
    if (alone_) f_.noise.in_repeats = f_.noise.neighbours = 0.0;
    if (of_pass_ > 0.0) {
      f_.noise.zero = Noise::Zero::of_pass;
      f_.noise.zero_size = f_.noise.zero_found = of_pass_;
    }
    f_.bench.emplace(f_.part.table, f_.terms, f_.weight, f_.repeats.target, f_.in_model, &made_,
                     f_.noise, scatter());
    NONIO_TRY(auto start, best_start());
    f_.start = std::move(start);
    f_.best = best_explanation(*f_.bench, f_.start);
    // Refine shapes: another effect would otherwise fit the error of a grid value.
    constexpr double worth_another_round = 1.0;
    for (int round = 0; round < 3; ++round) {
      const bool finer = add_refined(f_.start), alone = round == 0 && add_refined_alone();
      if (!add_refined(f_.best) && !finer && !alone) break;
      const double before = f_.best.criterion;
      f_.start = f_.bench->settled(std::move(f_.start));
      f_.best = best_explanation(*f_.bench, f_.start);
      if (!(f_.best.criterion < before - worth_another_round)) break;
    }
    return {};
  }

  /// Returns the standard deviation of the repeats; 0 if there are too few.
  double scatter() const {
    constexpr double fewest = 8.0;
    const Saturated repeated = saturate(f_.repeats, f_.part.table.deviation, f_.weight);
    return repeated.dof >= fewest ? std::sqrt(repeated.squares / repeated.dof) : 0.0;
  }

  /// Whether the model with a random zero (a random walk, or one of each run) is better than all
  /// found effects with a correlation of adjacent readings, which a random walk resembles within a
  /// pass. The readings are then treated as independent, so that the random walk remains visible.
  bool walks_rather() {
    if (!(f_.noise.in_repeats > 0.0)) return false;
    Noise alone = f_.noise;
    alone.in_repeats = alone.neighbours = 0.0;
    const Observations& o = f_.part.table;
    const auto model = f_.columns_of(terms_of_state(f_.start));
    const auto all = f_.columns_of(terms_of_state(f_.best));
    if (!model || !all) return false;
    const double alike = criterion_of_neighbours(o, f_.weight, alone, *all) + f_.best.price +
                         std::log(f_.bench->readings());
    const double walk =
        walk_with(o, f_.weight, alone, *model).least() + f_.start.price + f_.price_of_zero();
    return walk < alike;
  }

  /// Whether zeros of passes scatter at random. They are then noise, and the search is repeated
  /// until their size is stable.
  bool passes_scatter() {
    constexpr double same_size = 1.2;  // docs/dev/constants.md, M48
    if (of_pass_ == 0.0) return (of_pass_ = size_of_zeros()) > 0.0;
    const double size = f_.walk_with(terms_of_state(f_.best)).size_of_pass;
    if (!(size > same_size * of_pass_)) return false;
    of_pass_ = size;
    return true;
  }

  /// Size of random zeros of passes, relative to s; 0 if they are not noise. With such zeros in any
  /// order the model, the best explanation, or the model with one of its effects must be better than
  /// everything found without, and about as good as with a random walk or zeros of runs. Effects
  /// found without zeros may describe these, so each is also tried alone.
  double size_of_zeros() {
    if (!(zeros_left(f_.best).p_of_differences(scatter()) < named_below)) return 0.0;
    std::vector<State> tried{f_.start, f_.best};
    const Workbench::Gains gains = f_.bench->gains(f_.start);
    for (const std::size_t b : f_.best.blocks)
      if (const std::size_t e = f_.bench->effect_of(b); e >= f_.in_model)
        tried.push_back(f_.bench->with(f_.start, gains, e));
    const State* likeliest = nullptr;
    double with_passes = f_.best.criterion, otherwise = std::numeric_limits<double>::infinity();
    double size = 0.0;
    for (const State& state : tried) {
      const Unsteady unsteady = f_.walk_with(terms_of_state(state));
      const double price = state.price + f_.price_of_zero();
      otherwise = std::min(otherwise, unsteady.least() + price);
      if (!(unsteady.of_pass + price < with_passes)) continue;
      likeliest = &state;
      with_passes = unsteady.of_pass + price;
      size = unsteady.size_of_pass;
    }
    const bool random = likeliest != nullptr && zeros_left(*likeliest).unordered();
    return random && with_passes < otherwise + alias_evidence ? size : 0.0;
  }

  ZerosOfPasses zeros_left(const State& state) const {
    const auto fitted =
        fit_near(f_.part.table, terms_of_state(state), flags(state, false), f_.weight);
    return {f_.part, f_.repeats, f_.weight, fitted ? fitted->residual : f_.part.table.deviation};
  }

  /// Refines each effect of the best explanation, and the causes of the library that explain most,
  /// alone with the model, because other effects must not fit the error of a coarse grid. Returns
  /// whether a shape was added.
  bool add_refined_alone() {
    constexpr std::size_t causes = 4;  // docs/dev/constants.md, M37
    const Workbench::Gains gains = f_.bench->gains(f_.start);
    std::vector<State> alone, of_library;
    for (std::size_t e = f_.in_model; e < f_.terms.size(); ++e) {
      State one = f_.bench->with(f_.start, gains, e);
      if (one.blocks.size() == f_.start.blocks.size() ||
          f_.bench->blocks()[one.blocks.back()].searched == 0)
        continue;
      if (f_.bench->holds(f_.best, e))
        alone.push_back(std::move(one));
      else if (f_.terms[e].library)
        of_library.push_back(std::move(one));
    }
    std::stable_sort(of_library.begin(), of_library.end(),
                     [](const State& a, const State& b) { return a.criterion < b.criterion; });
    if (of_library.size() > causes) of_library.resize(causes);
    alone.insert(alone.end(), of_library.begin(), of_library.end());
    bool any = false;
    for (const State& one : alone) {
      any = add_fitted(one, terms_of_state(one)) || any;
      any = add_moved(one) || any;
    }
    return any;
  }

  /// Shapes of the terms depend on each other, so they are searched in the order of the model, and
  /// with the term first that explains most. If both fail, curves are added last, because they can
  /// fit what other terms explain.
  Expected<State> best_start() const {
    std::vector<std::size_t> written(f_.in_model);
    std::iota(written.begin(), written.end(), std::size_t{0});
    auto start = started(written, false);
    const auto other = started(written, true);
    if (other && (!start || other->squares < start->squares)) return other;
    if (start) return start;
    std::stable_partition(written.begin(), written.end(),
                          [&](std::size_t e) { return !f_.terms[e].effect->curve; });
    if (auto last = started(written, false)) return last;
    return start;
  }

  /// Adds the terms in the order of `open`, or those that explain most first.
  Expected<State> started(std::vector<std::size_t> open, bool largest_first) const {
    State start = f_.bench->state({});
    while (!open.empty()) {
      const Workbench::Gains gains = f_.bench->gains(start);
      State best;
      std::size_t at = open.size();
      for (std::size_t k = 0; k < (largest_first ? open.size() : 1); ++k) {
        State next = f_.bench->with(start, gains, open[k]);
        if (next.blocks.size() == start.blocks.size()) {
          const std::string& why = f_.bench->instances()[open[k]].error;
          return fail(!why.empty() ? why
                                   : "not separable with these readings: " +
                                         f_.terms[open[k]].name() + " from the rest of the model");
        }
        if (at == open.size() || next.squares < best.squares) best = std::move(next), at = k;
      }
      start = std::move(best);
      open.erase(open.begin() + static_cast<std::ptrdiff_t>(at));
    }
    return in_order(f_.bench->settled(std::move(start)));
  }

  /// Sorts the blocks of a state by the indices of their effects in `f_.terms`.
  State in_order(State state) const {
    std::sort(state.blocks.begin(), state.blocks.end(), [&](std::size_t a, std::size_t b) {
      return f_.bench->effect_of(a) < f_.bench->effect_of(b);
    });
    return state;
  }

  /// Adds optimal shapes between grid values to the grids. Returns whether a shape was added.
  bool add_refined(const State& state) {
    bool any = add_fitted(state, terms_of_state(state));
    any = add_moved(state) || any;
    // Another effect may have fitted the error of a grid value.
    for (const std::size_t b : state.blocks)
      if (const std::size_t e = f_.bench->effect_of(b); e >= f_.in_model)
        any = add_without(state, e) || any;
    return any;
  }

  bool add_without(const State& state, std::size_t effect) {
    const State rest = f_.bench->settled(f_.bench->without(state, effect));
    const auto free = [&](std::size_t b) {
      const Term& term = f_.terms[f_.bench->effect_of(b)];
      for (std::size_t k = 0; k < term.effect->shapes.size(); ++k)
        if (usual_of(term, k)) return true;
      return false;
    };
    if (std::none_of(rest.blocks.begin(), rest.blocks.end(), free)) return false;
    const bool any = add_fitted(rest, terms_of_state(rest));
    return add_moved(rest) || any;
  }

  /// Shapes with usual values do not change otherwise, although another value may be better.
  bool add_moved(const State& state) {
    std::vector<Term> moved = terms_of_state(state);
    bool usual = false;
    for (Term& term : moved)
      for (std::size_t k = 0; k < term.shape.size(); ++k) {
        const auto grid = term.effect->shapes[k].grid(f_.part.table, term.axis);
        if (!is_usual(term, term.shape, k) || grid.size() < 2) continue;
        term.shape[k] += 1e-6 * (grid.back() - grid.front());
        usual = true;
      }
    return usual && add_fitted(state, moved);
  }

  bool add_fitted(const State& state, const std::vector<Term>& terms) {
    const auto fitted = fit_near(f_.part.table, terms, flags(state, true), f_.weight, f_.noise);
    if (!fitted) return false;
    bool any = false;
    for (std::size_t t = 0; t < terms.size(); ++t) {
      const Workbench::Block& block = f_.bench->blocks()[state.blocks[t]];
      if (fitted->terms[t].shape == block.shape) continue;
      f_.bench->add_shape(f_.part.table, block.effect, fitted->terms[t].shape);
      any = true;
    }
    return any;
  }

  /// With few readings and no repeats, one outlier affects every effect. Each reading is omitted in
  /// turn and predicted by the best explanation of the others.
  std::vector<Suspect> suspect_without_repeats() {
    // docs/dev/constants.md, M18.
    constexpr std::size_t fewest = 8, most = 40;
    const std::size_t n = f_.part.table.size();
    const auto repeated = saturate(f_.repeats, f_.part.table.deviation, {});
    if (n < fewest || n > most || repeated.dof >= 3.0 || f_.part.table.axes.size() > 1) return {};
    f_.suspects.clear();
    if (!search()) return {};
    const double all = f_.best.criterion;
    Suspect worst;
    double least = all;
    std::vector<std::pair<double, std::vector<Term>>> each{{all, terms_of_state(f_.best)}};
    // the cost of the error as one more unknown, and of the choice of one of n readings
    const double price = 3.0 * std::log(static_cast<double>(n));
    for (std::size_t i = 0; i < n; ++i) {
      f_.suspects = {{i, 0.0, 0.0, 0.0}};
      if (!search()) continue;
      // Convert to all readings, because a criterion of fewer readings is not comparable.
      const double used = f_.bench->readings();
      const double criterion = f_.best.criterion + price +
                               (static_cast<double>(n) - used) * std::log(f_.best.squares / used);
      if (!(criterion < least + alias_evidence)) continue;
      const auto s = predicted(i);
      if (!s) continue;
      each.emplace_back(criterion, terms_of_state(f_.best));
      if (criterion < least) least = criterion, worst = *s;
    }
    f_.suspects.clear();
    for (const auto& one : each)
      for (const Term& term : one.second)
        if (one.first < least + alias_evidence) f_.otherwise.push_back(term.name());
    return least < all ? std::vector<Suspect>{worst} : std::vector<Suspect>{};
  }

  /// Compares a reading of weight 0 with its prediction; std::nullopt if the distance is not
  /// significant.
  std::optional<Suspect> predicted(std::size_t row) const {
    // docs/dev/constants.md, M12.
    constexpr double rarely = 0.01;
    const MatrixXd basis = f_.bench->basis(f_.best);
    const double dof = f_.dof(f_.best), n = f_.bench->readings() + 1.0;
    const auto fitted = fit_near(f_.part.table, terms_of_state(f_.best), flags(false), f_.weight);
    if (!fitted || !(dof >= 3.0) || !(f_.best.squares > 0.0)) return {};
    // The leverage of a row that is not in the fit is approximated by the largest one in the fit.
    double leverage = 1.0 / n;
    for (Index i = 0; i < basis.rows(); ++i)
      leverage = std::max(leverage, 1.0 / n + basis.row(i).squaredNorm());
    const double sigma = f_.left() * std::sqrt(1.0 + leverage);
    const double e = fitted->residual[row];
    if (math::t_two_sided(e / sigma, dof) * n > rarely) return {};
    double least = 3.0;
    while (math::t_two_sided(least, dof) * n > rarely) least += 0.05;
    return Suspect{row, e, e / sigma, least * sigma};
  }

  /// Uses the residuals of the best explanation. Returns whether the suspects changed; nothing is
  /// changed if more than an eighth of the readings would be suspect.
  bool suspect_again() {
    const std::size_t n = f_.part.table.size();
    const auto fitted = fit_near(f_.part.table, terms_of_state(f_.best), flags(false), f_.weight);
    if (!fitted) return false;
    std::vector<double> e = fitted->residual;
    for (std::size_t i = 0; i < f_.noise.rough.size(); ++i) e[i] /= f_.noise.rough[i];
    const double s = math::robust_deviation(e);
    if (!(s > 0.0)) return false;
    double least = 3.0;
    while (math::t_two_sided(least, 50.0) * static_cast<double>(n) > 0.01) least += 0.05;
    std::vector<std::uint32_t> high;
    for (std::uint32_t i = 0; i < n; ++i)
      if (std::fabs(e[i]) >= least * s) high.push_back(i);
    const std::vector<double> apart = apart_from_others(f_.repeats, high, e);
    // The original deviations must contradict the repeats too, because an error of the explanation
    // in one run does not make a reading suspect.
    const std::vector<double> as_read =
        apart_from_others(f_.repeats, high, f_.part.table.deviation);
    std::vector<Suspect> now;
    for (std::size_t k = 0; k < high.size(); ++k)
      if (std::fabs(apart[k]) >= least * s && std::fabs(as_read[k]) >= least * s)
        now.push_back({high[k], e[high[k]], e[high[k]] / s, least * s});
    if (now.size() > n / 8) return false;
    const bool changed =
        now.size() != f_.suspects.size() ||
        !std::equal(now.begin(), now.end(), f_.suspects.begin(),
                    [](const Suspect& a, const Suspect& b) { return a.row == b.row; });
    f_.suspects = std::move(now);
    return changed;
  }

  std::vector<Term> terms_of_state(const State& state) const {
    std::vector<Term> terms;
    for (const std::size_t b : state.blocks) {
      terms.push_back(f_.bench->instances()[f_.bench->effect_of(b)].term);
      terms.back().shape = f_.bench->blocks()[b].shape;
    }
    return terms;
  }
  std::vector<char> flags(bool searched) const { return flags(f_.best, searched); }
  std::vector<char> flags(const State& state, bool searched) const {
    std::vector<char> out;
    for (const std::size_t b : state.blocks) {
      const Term& term = f_.bench->instances()[f_.bench->effect_of(b)].term;
      out.push_back(searched && term.shape.empty() && !term.effect->shapes.empty());
    }
    return out;
  }

  /// Removes effects from the best explanation that are not significant or too small.
  void prune() {
    while (true) {
      std::size_t weakest = f_.terms.size();
      double largest_p = 0.0;
      const double s = f_.left();
      for (const std::size_t b : f_.best.blocks) {
        const std::size_t e = f_.bench->effect_of(b);
        if (e < f_.in_model) continue;
        const double p = f_.deciding_p(e);
        const double fall = f_.bench->without(f_.best, e).squares - f_.best.squares;
        const bool small = std::sqrt(fall / f_.bench->readings()) < least_rms * s;
        if ((p >= named_below || small) && p >= largest_p) {
          weakest = e;
          largest_p = p;
        }
      }
      if (weakest == f_.terms.size()) return;
      f_.best = f_.bench->settled(f_.bench->without(f_.best, weakest));
    }
  }

  /// `start` if the best explanation has no effect besides the model.
  State without_weakest() const {
    State out = f_.start;
    bool any = false;
    for (const std::size_t b : f_.best.blocks) {
      const std::size_t e = f_.bench->effect_of(b);
      if (e < f_.in_model) continue;
      State rest = f_.bench->settled(f_.bench->without(f_.best, e));
      if (!any || rest.squares < out.squares) out = std::move(rest);
      any = true;
    }
    return out;
  }

  Expected<void> fit_both() {
    auto of_model = fit_near(f_.part.table, terms_of_state(f_.start), flags(f_.start, true),
                             f_.weight, f_.noise);
    if (of_model)
      of_model = with_its_zero(f_.part.table, std::move(*of_model), flags(f_.start, true));
    if (!of_model) return fail(of_model.error());
    f_.of_model = comparison_of(f_.part, f_.repeats, std::move(*of_model), f_.suspects);
    // Effects that the grid of a shape separates may not be separable where the shape is fitted.
    Expected<Fit> of_best = fail("nothing was found");
    while (!of_best) {
      if (f_.best.blocks == f_.start.blocks) {
        f_.of_best = f_.of_model;
        return {};
      }
      of_best = fit_near(f_.part.table, terms_of_state(f_.best), flags(true), f_.weight, f_.noise);
      if (of_best) of_best = with_its_zero(f_.part.table, std::move(*of_best), flags(true));
      if (!of_best) f_.best = without_weakest();
    }
    f_.of_best = comparison_of(f_.part, f_.repeats, std::move(*of_best), f_.suspects);
    return {};
  }

  Finding f_;
  bool alone_ = false;  ///< whether readings are treated as independent
  /// size of the zeros of passes relative to s, if these are treated as noise; otherwise 0
  double of_pass_ = 0.0;
  const std::vector<Term>& model_;
  Workbench::Made made_;
};

}  // namespace

std::size_t Finding::index_of(const std::string& name) const {
  return static_cast<std::size_t>(
      std::find_if(terms.begin(), terms.end(), [&](const Term& t) { return t.name() == name; }) -
      terms.begin());
}

double Finding::dof(const State& state) const {
  return bench->readings() - static_cast<double>(bench->zeros() + state.parameters);
}

double Finding::p_of(std::size_t effect) const {
  const double p = model::p_of(*bench, best, effect);
  if (noise.zero != Noise::Zero::of_pass) return p;
  const auto block = std::find_if(best.blocks.begin(), best.blocks.end(),
                                  [&](std::size_t b) { return bench->effect_of(b) == effect; });
  Term term = terms[effect];
  term.shape = bench->blocks()[*block].shape;
  const auto columns = columns_of({term});
  if (!columns || share_of_passes(repeats, *columns) < 0.5) return p;
  const Workbench::State rest = bench->without(best, effect);
  const auto k = static_cast<double>(best.parameters - rest.parameters);
  const double s2 = best.squares / std::max(dof(best), 1.0);
  return std::max(p, math::f_upper((rest.squares - best.squares) / k / s2, k,
                                   std::max(degrees_of_passes(repeats), 1.0)));
}

double Finding::deciding_p(std::size_t effect) const {
  return chance.corrected(p_of(effect) / bench->weight(effect));
}

double Finding::left() const { return std::sqrt(best.squares / std::max(dof(best), 1.0)); }

Unsteady Finding::walk_with(const std::vector<Term>& some) const {
  const auto columns = columns_of(some);
  return columns ? model::walk_with(part.table, weight, noise, *columns) : Unsteady{};
}

Expected<MatrixXd> Finding::columns_of(const std::vector<Term>& some) const {
  NONIO_TRY(const auto blocks, blocks_of(part.table, some, bench->root_weight()));
  MatrixXd out(static_cast<Index>(part.table.size()), 0);
  for (const MatrixXd& block : blocks) {
    out.conservativeResize(Eigen::NoChange, out.cols() + block.cols());
    out.rightCols(block.cols()) = block;
  }
  return out;
}

double Finding::price_of_zero() const {
  return std::log(bench->readings()) + 2.0 * std::log(static_cast<double>(terms.size()));
}

VectorXd Finding::residual(const State& state) const {
  const MatrixXd basis = bench->basis(state);
  return math::orthogonal_part(basis, bench->y());
}

Expected<Finding> find_best(const Part& part, const std::vector<Term>& model,
                            const std::vector<Term>& catalogue, std::uint64_t seed) {
  return Finder(part, model, catalogue, seed).run();
}

}  // namespace nonio::model
