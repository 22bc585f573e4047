// SPDX-License-Identifier: Apache-2.0
#include "passes.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "data/pass_zeros.h"
#include "nonio/math/distributions.h"
#include "scatter.h"
#include "verdict.h"

namespace nonio::model {

namespace {

/// Whether a place is determined by differences within passes, of which there are many.
bool within_passes(const Where& where) {
  const auto has = [&](Factor f) { return where.has(f); };
  return (has(Factor::position) || has(Factor::screw_phase) || has(Factor::angle)) &&
         !has(Factor::run) && !has(Factor::time) && !has(Factor::temperature);
}

}  // namespace

PassZeros::PassZeros(const Finding& finding)
    : f_(finding),
      unordered_(
          ZerosOfPasses(f_.part, f_.repeats, f_.weight, f_.of_best.fit.residual).unordered()) {
  const Noise::Zero zero = f_.of_best.fit.noise.zero;
  if (f_.noise.zero == Noise::Zero::of_pass ||
      (unordered_ && (zero == Noise::Zero::of_pass || zero == Noise::Zero::of_run)))
    left_.emplace(f_.part, f_.repeats, f_.of_best.fit, with_passes());
  compare_orders();
}

bool PassZeros::drawn_again() const {
  constexpr double by_chance = 0.05;
  const Noise& noise = f_.of_best.fit.noise;
  return unordered_ && (!noise.independent() || noise.p < by_chance);
}

std::vector<double> PassZeros::noise() const {
  const std::vector<double>& e = f_.of_best.fit.residual;
  std::vector<double> sum(f_.repeats.cells, 0.0), n(f_.repeats.cells, 0.0), out(e.size(), 0.0);
  for (std::size_t i = 0; i < e.size(); ++i)
    sum[f_.repeats.cell[i]] += f_.weight[i] * e[i], n[f_.repeats.cell[i]] += f_.weight[i];
  for (std::size_t i = 0; i < e.size(); ++i)
    if (const double of = n[f_.repeats.cell[i]]; of > 1.0)
      out[i] = (e[i] - sum[f_.repeats.cell[i]] / of) * std::sqrt(of / (of - 1.0));
  return out;
}

/// Returns copies of values of readings as columns, each with the passes of each side in another
/// order. Suspect readings do not move.
MatrixXd PassZeros::in_other_orders(const std::vector<double>& e) const {
  constexpr Index copies = 200;  // docs/dev/constants.md, M14
  constexpr std::size_t none = static_cast<std::size_t>(-1);
  const Repeats& r = f_.repeats;
  std::vector<std::size_t> row(r.passes * r.cells, none);
  for (std::size_t i = 0; i < e.size(); ++i) row[r.pass[i] * r.cells + r.cell[i]] = i;
  std::mt19937_64 random(f_.seed);
  MatrixXd out(static_cast<Index>(e.size()), copies);
  std::vector<std::size_t> from(r.passes);
  for (Index k = 0; k < copies; ++k) {
    for (std::size_t p = 0; p < r.passes; ++p) {
      // Fisher and Yates among the passes of its side up to this one
      std::size_t same = 0, other = p;
      from[p] = p;
      for (std::size_t q = 0; q <= p; ++q)
        if (r.side[q] == r.side[p] && random() % ++same == 0) other = q;
      std::swap(from[p], from[other]);
    }
    for (std::size_t i = 0; i < e.size(); ++i) {
      const std::size_t at = row[from[r.pass[i]] * r.cells + r.cell[i]];
      out(static_cast<Index>(i), k) = e[at != none && f_.weight[at] > 0.0 ? at : i];
    }
  }
  return out;
}

/// Whether the best explanation describes the zeros of passes, which `others` leaves, better than
/// so few passes in any order allow (F-test over passes).
bool PassZeros::explains_zeros(const Workbench::State& others) const {
  constexpr double by_chance = 1e-4;  // docs/dev/constants.md, M50.
  const auto zeros = [&](const Workbench::State& state) {
    const VectorXd e = f_.residual(state);
    return ZerosOfPasses(f_.part, f_.repeats, f_.weight, {e.begin(), e.end()});
  };
  const ZerosOfPasses before = zeros(others), after = zeros(f_.best);
  const auto k = static_cast<double>(f_.best.parameters - others.parameters);
  const double dof = after.degrees() - k;
  if (!(dof >= 1.0) || !(k >= 1.0)) return false;
  const double fall = std::max(before.squares() - after.squares(), 0.0);
  return math::f_upper(math::test_ratio(fall / k, after.squares() / dof), k, dof) < by_chance;
}

/// Returns the share of these orders whose zeros are in an order, so that they are no noise, or in
/// which one run scatters more than the others.
double PassZeros::share_with_order(const MatrixXd& orders) const {
  double alarms = 0.0;
  for (const auto& order : orders.colwise()) {
    const std::vector<double> e(order.begin(), order.end());
    if (!ZerosOfPasses(f_.part, f_.repeats, f_.weight, e).unordered() ||
        wild_run(f_.part.table, f_.repeats, e, f_.weight, f_.noise))
      ++alarms;
  }
  return alarms / static_cast<double>(orders.cols());
}

/// Compares the passes in their own order with passes in other orders: which effects of the best
/// explanation the order does not show, and how often other orders would show some effect.
void PassZeros::compare_orders() {
  // docs/dev/constants.md, M50.
  constexpr double fewest = 8.0, as_often = 0.05, of_cells = 0.5;
  if (f_.part.kind != Part::Kind::axis || degrees_of_passes(f_.repeats) < fewest) return;
  std::vector<std::string> in_time;
  Workbench::State others = f_.best;
  for (const Term& term : f_.of_best.fit.terms) {
    const std::size_t e = f_.index_of(term.name());
    if (e < f_.in_model) continue;
    if (const auto columns = f_.columns_of({term});
        !columns || share_of_cells(f_.repeats, *columns) > of_cells)
      continue;
    in_time.push_back(term.name());
    others = f_.bench->without(others, e);
  }
  if (in_time.empty() ? f_.of_best.fit.noise.independent() : explains_zeros(others)) return;
  const Workbench& bench = *f_.bench;
  const MatrixXd orders = in_other_orders(f_.of_model.fit.residual);
  const std::vector<double> least =
      least_p(bench, others, drawn(bench, others, bench.white()(orders)), true);
  const auto share = [&](const auto& which) {
    return static_cast<double>(std::count_if(least.begin(), least.end(), which)) /
           static_cast<double>(least.size());
  };
  alarms_ =
      std::min(as_often, share([&](double p) { return f_.chance.corrected(p) < named_below; }));
  if (f_.noise.zero == Noise::Zero::of_pass) alarms_ = std::max(alarms_, share_with_order(orders));
  const Workbench::Gains gains = bench.gains(others);
  double own = 1.0;
  for (std::size_t e = 0; e < bench.instances().size() && !in_time.empty(); ++e) {
    if (bench.holds(others, e)) continue;
    const Workbench::State more = bench.with(others, gains, e);
    if (more.blocks.size() > others.blocks.size())
      own = std::min(own, p_of(bench, more, e) / bench.weight(e));
  }
  if (share([&](double p) { return p <= own; }) > as_often) of_any_order_ = std::move(in_time);
}

Noise PassZeros::with_passes() const {
  Noise noise = f_.noise.zero == Noise::Zero::of_pass ? f_.noise : f_.of_best.fit.noise;
  noise.neighbours = noise.in_repeats;
  noise.zero_size = std::max(noise.zero_size, noise.zero_found);
  return noise;
}

std::vector<Place> PassZeros::places(const std::vector<double>& residual,
                                     const std::optional<NoiseFloor>& floor, double least) const {
  std::vector<Place> out = (*left_)(residual, floor, least);
  if (!floor) return out;
  std::optional<NoiseFloor> of_passes = floor;
  of_passes->dof = std::max(std::min(floor->dof, degrees_of_passes(f_.repeats)), 3.0);
  const std::vector<Place> others = (*left_)(residual, of_passes, least);
  for (Place& place : out)
    for (const Place& other : others)
      if (!within_passes(place.where) && other.where == place.where && other.line == place.line)
        place.p = std::max(place.p, other.p);
  return out;
}

bool PassZeros::shows(const std::string& name) const {
  const Fit& best = f_.of_best.fit;
  std::vector<Term> others = best.terms;
  std::erase_if(others, [&](const Term& t) { return t.name() == name; });
  const auto with = f_.columns_of(best.terms), without = f_.columns_of(others);
  if (!with || !without) return true;
  const Whitening white(f_.part.table, f_.weight, with_passes());
  const auto squares = [&](const MatrixXd& columns, Index& rank) {
    MatrixXd x = white(columns);
    MatrixXd y = white(Eigen::Map<const VectorXd>(f_.part.table.deviation.data(), x.rows()));
    white.take_out_zeros(x);
    white.take_out_zeros(y);
    rank = x.cols();
    if (x.cols() == 0) return y.squaredNorm();
    const Eigen::HouseholderQR<MatrixXd> qr(of_unit_length(std::move(x)));
    const VectorXd rotated = math::rotated(qr, y.col(0));
    return rotated.tail(rotated.size() - rank).squaredNorm();
  };
  Index all = 0, some = 0;
  const double left = squares(*with, all), more = squares(*without, some);
  const auto k = static_cast<double>(all - some);
  const double dof = std::max(f_.dof(f_.best), 1.0);
  const double of_passes =
      share_of(name) > 0.5 ? std::max(degrees_of_passes(f_.repeats), 1.0) : dof;
  if (!(k >= 1.0)) return true;
  return math::f_upper(math::test_ratio((more - left) / k, left / dof), k,
                       std::min(dof, of_passes)) < named_below;
}

/// Returns the fraction of an effect's prediction that is constant within each pass.
double PassZeros::share_of(const std::string& name) const {
  for (std::size_t t = 0; t < f_.of_best.fit.terms.size(); ++t)
    if (const std::vector<double>& part = f_.of_best.fit.part[t];
        f_.of_best.fit.terms[t].name() == name)
      return share_of_passes(
          f_.repeats, Eigen::Map<const VectorXd>(part.data(), static_cast<Index>(part.size())));
  return 0.0;
}

}  // namespace nonio::model
