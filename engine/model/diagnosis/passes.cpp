// SPDX-License-Identifier: Apache-2.0
#include "passes.h"

#include <algorithm>
#include <cmath>

#include "nonio/math/distributions.h"
#include "verdict.h"

namespace nonio::model {

namespace {

/// Whether a place is determined by differences within passes, of which many are known.
bool within_passes(const Where& where) {
  const auto has = [&](Factor f) { return where.has(f); };
  return (has(Factor::position) || has(Factor::screw_phase) || has(Factor::angle)) &&
         !has(Factor::run) && !has(Factor::time) && !has(Factor::temperature);
}

}  // namespace

PassZeros::PassZeros(const Finding& finding) : f_(finding), unordered_(unordered()) {
  const Noise::Zero zero = f_.of_best.fit.noise.zero;
  if (unordered_ && (zero == Noise::Zero::of_pass || zero == Noise::Zero::of_run))
    left_.emplace(f_.part, f_.repeats, f_.of_best.fit, with_passes());
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

/// Mean of what is left of each pass, in the order in which the passes were made.
std::vector<PassZeros::Offset> PassZeros::offsets() const {
  const Repeats& r = f_.repeats;
  std::vector<double> sum(r.passes, 0.0), n(r.passes, 0.0);
  std::vector<std::size_t> order;
  std::vector<double> way(r.passes, 0.0);
  for (std::size_t i = 0; i < f_.weight.size(); ++i) {
    const std::uint32_t p = r.pass[i];
    if (!(f_.weight[i] > 0.0)) continue;
    if (n[p] == 0.0) order.push_back(p);
    sum[p] += f_.weight[i] * f_.of_best.fit.residual[i], n[p] += f_.weight[i];
    way[p] = i < f_.part.way.size() ? f_.part.way[i] : 0.0;  // a part made by hand has none
  }
  std::vector<Offset> out;
  for (const std::size_t p : order) out.push_back({sum[p] / n[p], way[p], r.side[p]});
  return out;
}

/// Whether the zeros of passes come in any order. A step between two passes, a trend, or either of
/// the reversal is a cause and no scatter. Few passes do not show it.
bool PassZeros::unordered() const {
  constexpr double fewest = 4.0;
  const std::vector<Offset> all = offsets();
  const auto m = all.size();
  if (degrees() < fewest || m < f_.repeats.passes) return false;
  const double dof = degrees() - 1.0;
  double least = 1.0, tests = 0.0;
  for (const bool reversal : {false, true}) {
    VectorXd y(static_cast<Index>(m));
    for (std::size_t p = 0; p < m; ++p)
      y(static_cast<Index>(p)) = all[p].value * (reversal ? all[p].way : 1.0);
    centre(all, y);
    for (std::size_t step = 0; step < m; ++step) {
      VectorXd c(y.size());  // 0: a trend
      for (std::size_t p = 0; p < m; ++p)
        c(static_cast<Index>(p)) = step == 0 ? static_cast<double>(p) : p < step ? 0.0 : 1.0;
      centre(all, c);
      const double size = c.squaredNorm();
      if (!(size > 1e-9)) continue;
      const double fall = std::pow(c.dot(y), 2) / size;
      ++tests;
      least = std::min(
          least, math::f_upper(math::test_ratio(fall, (y.squaredNorm() - fall) / dof), 1.0, dof));
    }
  }
  return least * tests > serious_p;
}

/// Less the mean of each side.
void PassZeros::centre(const std::vector<Offset>& of, VectorXd& values) const {
  std::vector<double> sum(f_.repeats.sides, 0.0), n(f_.repeats.sides, 0.0);
  for (std::size_t p = 0; p < of.size(); ++p)
    sum[of[p].side] += values(static_cast<Index>(p)), n[of[p].side] += 1.0;
  for (std::size_t p = 0; p < of.size(); ++p)
    values(static_cast<Index>(p)) -= sum[of[p].side] / n[of[p].side];
}

double PassZeros::degrees() const {
  return static_cast<double>(f_.repeats.passes) - static_cast<double>(f_.repeats.sides);
}

/// With zeros of passes as a part of the noise.
Noise PassZeros::with_passes() const {
  Noise noise = f_.of_best.fit.noise;
  noise.neighbours = noise.in_repeats;
  noise.zero_size = std::max(noise.zero_size, noise.zero_found);
  return noise;
}

std::vector<Place> PassZeros::places(const std::vector<double>& residual,
                                     const std::optional<NoiseFloor>& floor, double least) const {
  std::vector<Place> out = (*left_)(residual, floor, least);
  if (!floor) return out;
  std::optional<NoiseFloor> of_passes = floor;
  of_passes->dof = std::max(std::min(floor->dof, degrees()), 3.0);
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
  const double of_passes = share_of_passes(name) > 0.5 ? std::max(degrees(), 1.0) : dof;
  if (!(k >= 1.0)) return true;
  return math::f_upper(math::test_ratio((more - left) / k, left / dof), k,
                       std::min(dof, of_passes)) < named_below;
}

/// Of what an effect predicts, how much is the same all through a pass.
double PassZeros::share_of_passes(const std::string& name) const {
  const std::vector<double>* part = nullptr;
  for (std::size_t t = 0; t < f_.of_best.fit.terms.size(); ++t)
    if (f_.of_best.fit.terms[t].name() == name) part = &f_.of_best.fit.part[t];
  if (part == nullptr) return 0.0;
  const Repeats& r = f_.repeats;
  std::vector<double> sum(r.passes, 0.0), n(r.passes, 0.0);
  double mean = 0.0, squares = 0.0, between = 0.0;
  for (const double x : *part) mean += x / static_cast<double>(part->size());
  for (std::size_t i = 0; i < part->size(); ++i) {
    const double x = (*part)[i] - mean;
    squares += x * x, sum[r.pass[i]] += x, n[r.pass[i]] += 1.0;
  }
  for (std::size_t p = 0; p < r.passes; ++p) between += n[p] > 0.0 ? sum[p] * sum[p] / n[p] : 0.0;
  return squares > 0.0 ? between / squares : 0.0;
}

}  // namespace nonio::model
