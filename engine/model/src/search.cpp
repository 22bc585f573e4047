// SPDX-License-Identifier: Apache-2.0
#include "search.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "nonio/math/distributions.h"

namespace nonio::model {

namespace {

using State = Workbench::State;

constexpr std::size_t side_by_side = 4;
constexpr int most_effects_added = 7;

std::set<std::size_t> effects_of(const Workbench& bench, const State& s) {
  std::set<std::size_t> out;
  for (const std::size_t b : s.blocks) out.insert(bench.effect_of(b));
  return out;
}

/// All states with one more effect, best first, one for each set of effects.
std::vector<State> grown(const Workbench& bench, const std::vector<State>& level) {
  std::vector<State> next;
  std::set<std::set<std::size_t>> seen;
  for (const State& s : level) {
    const VectorXd gains = bench.gains(s);
    for (std::size_t e = 0; e < bench.instances().size(); ++e) {
      if (bench.holds(s, e)) continue;
      std::set<std::size_t> effects = effects_of(bench, s);
      effects.insert(e);
      if (seen.contains(effects)) continue;
      State more = bench.with(s, gains, e);
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

/// One effect dropped, or exchanged for another, if that is better.
bool improve(const Workbench& bench, const State& start, State& best) {
  const auto fixed = effects_of(bench, start);
  for (const std::size_t e : effects_of(bench, best)) {
    if (fixed.contains(e)) continue;
    const State rest = bench.settled(bench.without(best, e));
    if (rest.criterion < best.criterion - 1e-9) {
      best = rest;
      return true;
    }
    const VectorXd gains = bench.gains(rest);
    for (std::size_t other = 0; other < bench.instances().size(); ++other) {
      if (other == e || bench.holds(rest, other)) continue;
      State changed = bench.with(rest, gains, other);
      if (changed.criterion < best.criterion + 3.0) changed = bench.settled(std::move(changed));
      if (changed.criterion < best.criterion - 1e-9) {
        best = std::move(changed);
        return true;
      }
    }
  }
  return false;
}

}  // namespace

State best_explanation(const Workbench& bench, const State& start) {
  State best = start;
  std::vector<State> level{start};
  int without_gain = 0;
  for (int depth = 0; depth < most_effects_added && without_gain < 2; ++depth) {
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
  for (int step = 0; step < 20 && improve(bench, start, best); ++step) {
  }
  return best;
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

Shuffles shuffled(const Workbench& bench, const State& complete, const VectorXd& residual,
                  const Observations& o, const std::vector<std::uint32_t>& pass,
                  std::uint64_t seed) {
  constexpr std::size_t stretch = 5;  // readings whose sign is flipped together
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
  Shuffles out;
  out.noise.resize(residual.size(), shuffles);
  for (Index s = 0; s < shuffles; ++s)
    for (Index i = 0; i < residual.size(); ++i)
      out.noise(i, s) = sign(block[static_cast<std::size_t>(i)], s) * residual(i);
  take_out_zeros(o, bench.root_weight(), out.noise);
  const MatrixXd basis = bench.basis(complete);
  const MatrixXd said = basis.transpose() * out.noise;
  out.noise.noalias() -= basis * said;
  out.squares = out.noise.colwise().squaredNorm().transpose();
  // Products with the columns (which hold no zeros) by stretches: a fifth of the work.
  const MatrixXd& x = bench.columns();
  MatrixXd of_stretch = MatrixXd::Zero(blocks + basis.cols(), x.cols());
  for (Index k = 0; k < x.cols(); ++k)
    for (Index i = 0; i < residual.size(); ++i)
      of_stretch(block[static_cast<std::size_t>(i)], k) += x(i, k) * residual(i);
  of_stretch.bottomRows(basis.cols()).noalias() = -basis.transpose() * x;
  MatrixXd factors(blocks + basis.cols(), shuffles);
  factors << sign, said;
  out.products.noalias() = of_stretch.transpose() * factors;
  return out;
}

namespace {

/// One effect added to a complete model in every shuffle: its p, and whether the criterion falls.
struct Added {
  std::vector<double> p;
  std::vector<char> better;
};

class ChanceOf {
 public:
  ChanceOf(const Workbench& bench, const State& complete, const Shuffles& shuffles)
      : bench_(bench),
        llt_(bench.gram(complete.blocks)),
        with_complete_(bench.products(complete.blocks)),
        products_(shuffles.products),
        squares_(shuffles.squares) {
    dof_ = bench.readings() - static_cast<double>(bench.zeros() + complete.parameters);
  }

  /// p of those only that lower the criterion, if asked for: an F-test costs more than all else.
  Added add(std::size_t effect, bool better_only) const {
    const Workbench::Instance& instance = bench_.instances()[effect];
    const Index shuffles = products_.cols();
    Added out{std::vector<double>(static_cast<std::size_t>(shuffles), 1.0),
              std::vector<char>(static_cast<std::size_t>(shuffles), 0)};
    VectorXd fall_of_best = VectorXd::Zero(shuffles);
    VectorXd k_of_best = VectorXd::Ones(shuffles), price_of_best = VectorXd::Zero(shuffles);
    // Fall of the criterion: how the search itself would choose.
    const auto value = [&](Index i, double fall, double price) {
      return -bench_.readings() * std::log1p(-std::min(fall / squares_(i), 1.0 - 1e-12)) - price;
    };
    for (const std::size_t b : instance.blocks) {
      const Workbench::Block& block = bench_.blocks()[b];
      MatrixXd s = block.own;
      MatrixXd t = products_.middleRows(block.first, block.count);
      if (with_complete_.cols() > 0) {
        MatrixXd w = with_complete_.middleRows(block.first, block.count).transpose();
        llt_.matrixL().solveInPlace(w);
        s.noalias() -= w.transpose() * w;
      }
      const Eigen::LLT<MatrixXd> llt(s);
      if (llt.info() != Eigen::Success || !(llt.matrixLLT().diagonal().minCoeff() > 1e-4)) continue;
      llt.matrixL().solveInPlace(t);
      const bool searched = instance.blocks.size() > 1 && !instance.term.effect->curve;
      const double price = bench_.price(effect, block.count);
      const double k = static_cast<double>(block.count) +
                       (searched ? static_cast<double>(instance.term.effect->shapes.size()) : 0.0);
      const VectorXd falls = t.colwise().squaredNorm().transpose();
      for (Index i = 0; i < shuffles; ++i) {
        const double fall = falls(i);
        if (fall_of_best(i) > 0.0 &&
            (price == price_of_best(i)
                 ? fall <= fall_of_best(i)
                 : value(i, fall, price) <= value(i, fall_of_best(i), price_of_best(i))))
          continue;
        fall_of_best(i) = fall;
        k_of_best(i) = k;
        price_of_best(i) = price;
      }
    }
    for (Index i = 0; i < shuffles; ++i) {
      const auto at = static_cast<std::size_t>(i);
      out.better[at] = fall_of_best(i) > 0.0 && value(i, fall_of_best(i), price_of_best(i)) > 0.0;
      if (better_only && out.better[at] == 0) continue;
      const double dof = dof_ - k_of_best(i);
      out.p[at] =
          math::f_upper(fall_of_best(i) / k_of_best(i) / ((squares_(i) - fall_of_best(i)) / dof),
                        k_of_best(i), dof);
    }
    return out;
  }

 private:
  const Workbench& bench_;
  Eigen::LLT<MatrixXd> llt_;
  MatrixXd with_complete_;
  const MatrixXd& products_;
  const VectorXd& squares_;
  double dof_ = 0.0;
};

}  // namespace

Chance measure_chance(const Workbench& bench, const State& complete, const Shuffles& shuffles) {
  const ChanceOf of(bench, complete, shuffles);
  std::vector<double> least(static_cast<std::size_t>(shuffles.squares.size()), 1.0);
  for (std::size_t e = 0; e < bench.instances().size(); ++e) {
    if (bench.holds(complete, e)) continue;
    const Added added = of.add(e, false);
    for (std::size_t i = 0; i < least.size(); ++i) least[i] = std::min(least[i], added.p[i]);
  }
  // The smallest of m independent p: -ln(1 - p) is exponential with rate m.
  double sum = 0.0;
  for (const double p : least) sum -= std::log1p(-std::min(p, 1.0 - 1e-12));
  return {std::max(static_cast<double>(least.size()) / std::max(sum, 1e-12), 1.0)};
}

std::vector<char> named_in(const Workbench& bench, const State& complete, const Shuffles& shuffles,
                           const Chance& chance) {
  const ChanceOf of(bench, complete, shuffles);
  std::vector<char> named(static_cast<std::size_t>(shuffles.squares.size()), 0);
  for (std::size_t e = 0; e < bench.instances().size(); ++e) {
    if (bench.holds(complete, e)) continue;
    const Added added = of.add(e, true);
    for (std::size_t i = 0; i < named.size(); ++i)
      if (added.better[i] != 0 && chance.corrected(added.p[i]) < named_below) named[i] = 1;
  }
  return named;
}

}  // namespace nonio::model
