// SPDX-License-Identifier: Apache-2.0
#include "search.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "nonio/math/distributions.h"

namespace nonio::model {

namespace {

using State = Workbench::State;

// Number of sets of effects that are grown in parallel; docs/dev/constants.md, M16.
constexpr std::size_t side_by_side = 4;
// docs/dev/constants.md, M17.
constexpr int most_effects_added = 7, most_in_space = 24;

std::set<std::size_t> effects_of(const Workbench& bench, const State& s) {
  std::set<std::size_t> out;
  for (const std::size_t b : s.blocks) out.insert(bench.effect_of(b));
  return out;
}

/// The best `side_by_side` states with one more effect, one for each set of effects.
std::vector<State> grown(const Workbench& bench, const std::vector<State>& level) {
  std::vector<State> next;
  std::set<std::set<std::size_t>> seen;
  for (const State& s : level) {
    const Workbench::Gains gains = bench.gains(s);
    for (std::size_t e = 0; e < bench.instances().size(); ++e) {
      if (bench.holds(s, e)) continue;
      std::set<std::size_t> effects = effects_of(bench, s);
      effects.insert(e);
      if (seen.contains(effects)) continue;
      State more = bench.joined(s, gains, e);
      if (more.blocks.size() == s.blocks.size()) continue;
      seen.insert(std::move(effects));
      next.push_back(std::move(more));
    }
  }
  std::stable_sort(next.begin(), next.end(),
                   [](const State& a, const State& b) { return a.criterion < b.criterion; });
  if (next.size() > side_by_side) next.resize(side_by_side);
  for (State& s : next) s = bench.settled(std::move(s));
  return next;
}

/// Exchanges effects that were taken out of `best`, which leaves `rest`, for one other; returns false
/// if the criterion does not improve.
bool exchange(const Workbench& bench, const State& rest, const std::set<std::size_t>& taken,
              State& best) {
  const Workbench::Gains gains = bench.gains(rest);
  for (std::size_t other = 0; other < bench.instances().size(); ++other) {
    if (taken.contains(other) || bench.holds(rest, other)) continue;
    State changed = bench.joined(rest, gains, other);
    if (changed.criterion < best.criterion + 3.0) changed = bench.settled(std::move(changed));
    if (changed.criterion < best.criterion - 1e-9) {
      best = std::move(changed);
      return true;
    }
  }
  return false;
}

/// Removes or exchanges one effect, or exchanges two of an axis for one: two effects that were added
/// first may imitate it together. Returns false if the criterion does not improve.
bool improve(const Workbench& bench, const State& start, State& best) {
  const auto fixed = effects_of(bench, start);
  for (const std::size_t e : effects_of(bench, best)) {
    if (fixed.contains(e)) continue;
    const State rest = bench.settled(bench.without(best, e));
    if (rest.criterion < best.criterion - 1e-9) {
      best = rest;
      return true;
    }
    if (exchange(bench, rest, {e}, best)) return true;
  }
  if (bench.in_space()) return false;
  std::set<std::size_t> found = effects_of(bench, best);
  std::erase_if(found, [&](std::size_t e) { return fixed.contains(e); });
  for (auto a = found.begin(); a != found.end(); ++a)
    for (auto b = std::next(a); b != found.end(); ++b)
      if (exchange(bench, bench.settled(bench.without(bench.without(best, *a), *b)), {*a, *b},
                   best))
        return true;
  return false;
}

/// Adds the effect that improves the criterion most once the curves of the set are chosen again with
/// it; false if none does. In a volume two curves can share what neither shows alone, so that an
/// effect pays only with another size of a curve in the set.
bool extend(const Workbench& bench, State& best) {
  constexpr double worth_choosing_again = 30.0;  // docs/dev/constants.md, M49.
  const Workbench::Gains gains = bench.gains(best);
  State extended = best;
  for (std::size_t e = 0; e < bench.instances().size(); ++e) {
    if (bench.holds(best, e)) continue;
    State more = bench.with(best, gains, e);
    if (more.blocks.size() == best.blocks.size() ||
        !(more.criterion < best.criterion + worth_choosing_again))
      continue;
    more = bench.settled(std::move(more));
    if (more.criterion < extended.criterion - 1e-9) extended = std::move(more);
  }
  if (extended.blocks.size() == best.blocks.size()) return false;
  best = std::move(extended);
  return true;
}

bool is_curve(const Workbench& bench, std::size_t effect) {
  return bench.instances()[effect].term.effect->curve;
}

/// Curves that partly cancel each other can imitate several simple effects. Grows the set again
/// without its curves, and adds a curve only if no other effect improves the criterion.
State without_curves(const Workbench& bench, const State& start, const State& best, int most) {
  const auto fixed = effects_of(bench, start);
  State state = best;
  for (const std::size_t e : effects_of(bench, best))
    if (is_curve(bench, e) && !fixed.contains(e)) state = bench.without(state, e);
  for (int added = 0; added < most; ++added) {
    const Workbench::Gains gains = bench.gains(state);
    State simple = state, curved = state;
    for (std::size_t e = 0; e < bench.instances().size(); ++e) {
      if (bench.holds(state, e)) continue;
      State& known = is_curve(bench, e) ? curved : simple;
      State more = bench.with(state, gains, e);
      if (more.criterion < known.criterion - 1e-9) known = std::move(more);
    }
    const State& next = simple.blocks.size() > state.blocks.size() ? simple : curved;
    if (next.blocks.size() == state.blocks.size()) break;
    state = bench.settled(next);
  }
  return state;
}

}  // namespace

State best_explanation(const Workbench& bench, const State& start) {
  State best = start;
  std::vector<State> level{start};
  int without_gain = 0;
  const int most = bench.in_space() ? most_in_space : most_effects_added;
  for (int depth = 0; depth < most && without_gain < 2; ++depth) {
    level = grown(bench, level);
    if (level.empty()) break;
    std::stable_sort(level.begin(), level.end(),
                     [](const State& a, const State& b) { return a.criterion < b.criterion; });
    if (level.front().criterion < best.criterion - 1e-9) {
      best = level.front();
      without_gain = 0;
    } else {
      ++without_gain;
    }
  }
  const auto room = [&](const State& state) {
    return bench.in_space() && state.blocks.size() < start.blocks.size() + most_in_space;
  };
  const auto finish = [&](State& state) {
    for (int step = 0;
         step < 20 && (improve(bench, start, state) || (room(state) && extend(bench, state)));
         ++step) {
    }
  };
  finish(best);
  if (!bench.in_space()) return best;
  State simple = without_curves(bench, start, best, most);
  if (simple.blocks == best.blocks) return best;
  finish(simple);
  return simple.criterion < best.criterion ? simple : best;
}

double p_of(const Workbench& bench, const State& state, std::size_t effect) {
  const State rest = bench.without(state, effect);
  const auto k = static_cast<double>(state.parameters - rest.parameters);
  const double dof =
      bench.readings() - static_cast<double>(bench.zeros()) - static_cast<double>(state.parameters);
  if (!(state.squares > 0.0)) return 0.0;
  return math::f_upper((rest.squares - state.squares) / k / (state.squares / dof), k, dof);
}

double Chance::corrected(double p) const {
  return -std::expm1(trials * std::log1p(-std::min(p, 1.0)));
}

SignFlips shuffled(const Workbench& bench, const State& complete, const VectorXd& residual,
                   const std::vector<std::uint32_t>& pass, std::uint64_t seed,
                   std::size_t stretch) {
  // docs/dev/constants.md, M14.
  constexpr Index shuffles = 200;
  std::vector<Index> block(pass.size());
  std::vector<std::size_t> in_pass;
  std::vector<Index> current;
  Index blocks = 0;
  for (std::size_t i = 0; i < pass.size(); ++i) {
    if (pass[i] >= in_pass.size()) in_pass.resize(pass[i] + 1, 0), current.resize(pass[i] + 1, 0);
    if (in_pass[pass[i]]++ % stretch == 0) current[pass[i]] = blocks++;
    block[i] = current[pass[i]];
  }
  std::mt19937_64 random(seed);
  MatrixXd sign(blocks, shuffles);
  for (double& x : sign.reshaped()) x = (random() >> 63) != 0 ? 1.0 : -1.0;
  SignFlips out;
  out.noise.resize(residual.size(), shuffles);
  for (Index s = 0; s < shuffles; ++s)
    for (Index i = 0; i < residual.size(); ++i)
      out.noise(i, s) = sign(block[static_cast<std::size_t>(i)], s) * residual(i);
  bench.white().take_out_zeros(out.noise);
  const MatrixXd basis = bench.basis(complete);
  const MatrixXd said = math::transposed_product(basis, out.noise);
  out.noise.noalias() -= basis * said;
  out.squares = out.noise.colwise().squaredNorm().transpose();
  // Compute products with the columns (which contain no zeros) by stretches: a fifth of the work.
  const MatrixXd& x = bench.columns();
  MatrixXd of_stretch = MatrixXd::Zero(blocks + basis.cols(), x.cols());
  for (Index k = 0; k < x.cols(); ++k)
    for (Index i = 0; i < residual.size(); ++i)
      of_stretch(block[static_cast<std::size_t>(i)], k) += x(i, k) * residual(i);
  out.in_complete = math::transposed_product(basis, x);
  of_stretch.bottomRows(basis.cols()) = -out.in_complete;
  MatrixXd factors(blocks + basis.cols(), shuffles);
  factors << sign, said;
  out.products = math::transposed_product(factors, of_stretch);
  return out;
}

namespace {

/// One effect added to a complete model in every copy, with the best shape.
struct Added {
  VectorXd fall, parameters;
  std::vector<char> better;  ///< whether the criterion decreases
};

class ChanceOf {
 public:
  ChanceOf(const Workbench& bench, const State& complete, const SignFlips& shuffles)
      : bench_(bench),
        shuffles_(shuffles),
        dof_(bench.readings() - static_cast<double>(bench.zeros() + complete.parameters)) {}

  Added add(std::size_t effect) const {
    const Workbench::Instance& instance = bench_.instances()[effect];
    const Index shuffles = shuffles_.squares.size();
    Added out{VectorXd::Zero(shuffles), VectorXd::Ones(shuffles),
              std::vector<char>(static_cast<std::size_t>(shuffles), 0)};
    VectorXd paid = VectorXd::Zero(shuffles);
    for (const std::size_t b : instance.blocks) {
      const Workbench::Block& block = bench_.blocks()[b];
      const auto w = shuffles_.in_complete.middleCols(block.first, block.count);
      const Eigen::LLT<MatrixXd> llt(MatrixXd(block.own - math::transposed_product(w, w)));
      if (llt.info() != Eigen::Success || !(llt.matrixLLT().diagonal().minCoeff() > 1e-4)) continue;
      MatrixXd t = shuffles_.products.middleCols(block.first, block.count);
      llt.matrixU().solveInPlace<Eigen::OnTheRight>(t);
      const VectorXd falls = t.rowwise().squaredNorm();
      const double price = bench_.price(block);
      const auto k = static_cast<double>(Workbench::unknowns_of(block));
      for (Index i = 0; i < shuffles; ++i) {
        if (out.fall(i) > 0.0 &&
            (price == paid(i) ? falls(i) <= out.fall(i)
                              : fall_of_criterion(i, falls(i)) - price <=
                                    fall_of_criterion(i, out.fall(i)) - paid(i)))
          continue;
        out.fall(i) = falls(i);
        out.parameters(i) = k;
        paid(i) = price;
      }
    }
    for (Index i = 0; i < shuffles; ++i)
      out.better[static_cast<std::size_t>(i)] =
          out.fall(i) > 0.0 && fall_of_criterion(i, out.fall(i)) > paid(i);
    return out;
  }

  /// Returns p of a decrease of squares by this number of parameters.
  double p(Index shuffle, double fall, double parameters) const {
    const double dof = dof_ - parameters;
    return math::f_upper(
        math::test_ratio(fall / parameters, (shuffles_.squares(shuffle) - fall) / dof), parameters,
        dof);
  }

 private:
  double fall_of_criterion(Index shuffle, double fall) const {
    return -bench_.readings() *
           std::log1p(-std::min(fall / shuffles_.squares(shuffle), 1.0 - 1e-12));
  }

  const Workbench& bench_;
  const SignFlips& shuffles_;
  double dof_;
};

}  // namespace

SignFlips drawn(const Workbench& bench, const State& complete, MatrixXd noise) {
  SignFlips out;
  bench.white().take_out_zeros(noise);
  const MatrixXd basis = bench.basis(complete);
  noise -= basis * math::transposed_product(basis, noise);
  out.squares = noise.colwise().squaredNorm().transpose();
  out.in_complete = math::transposed_product(basis, bench.columns());
  out.products = math::transposed_product(noise, bench.columns());
  out.noise = std::move(noise);
  return out;
}

std::vector<double> least_p(const Workbench& bench, const State& complete,
                            const SignFlips& shuffles, bool weighted) {
  const ChanceOf of(bench, complete, shuffles);
  // The F-test is by far the most expensive step, so only the largest decreases are tested.
  std::vector<std::map<std::pair<double, double>, double>> largest(  // by parameters and weight
      static_cast<std::size_t>(shuffles.squares.size()));
  for (std::size_t e = 0; e < bench.instances().size(); ++e) {
    if (bench.holds(complete, e)) continue;
    const Added added = of.add(e);
    const double weight = weighted ? bench.weight(e) : 1.0;
    for (Index i = 0; i < added.fall.size(); ++i) {
      double& fall = largest[static_cast<std::size_t>(i)][{added.parameters(i), weight}];
      fall = std::max(fall, added.fall(i));
    }
  }
  std::vector<double> least(largest.size(), 1.0);
  for (std::size_t i = 0; i < largest.size(); ++i)
    for (const auto& [of_effect, fall] : largest[i])
      least[i] =
          std::min(least[i], of.p(static_cast<Index>(i), fall, of_effect.first) / of_effect.second);
  return least;
}

Chance measure_chance(const Workbench& bench, const State& complete, const SignFlips& shuffles,
                      bool weighted) {
  // For the smallest of m independent p, -ln(1 - p) is exponentially distributed with rate m.
  double sum = 0.0;
  const std::vector<double> least = least_p(bench, complete, shuffles, weighted);
  for (const double p : least) sum -= std::log1p(-std::min(p, 1.0 - 1e-12));
  return {std::max(static_cast<double>(least.size()) / std::max(sum, 1e-12), 1.0)};
}

std::vector<char> named_in(const Workbench& bench, const State& complete, const SignFlips& shuffles,
                           const Chance& chance) {
  const ChanceOf of(bench, complete, shuffles);
  std::vector<char> named(static_cast<std::size_t>(shuffles.squares.size()), 0);
  for (std::size_t e = 0; e < bench.instances().size(); ++e) {
    if (bench.holds(complete, e)) continue;
    const Added added = of.add(e);
    for (std::size_t i = 0; i < named.size(); ++i) {
      const auto at = static_cast<Index>(i);
      if (added.better[i] != 0 && chance.corrected(of.p(at, added.fall(at), added.parameters(at)) /
                                                   bench.weight(e)) < named_below)
        named[i] = 1;
    }
  }
  return named;
}

}  // namespace nonio::model
