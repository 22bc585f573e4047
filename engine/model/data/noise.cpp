// SPDX-License-Identifier: Apache-2.0
#include "noise.h"

#include <cmath>
#include <map>

#include "nonio/math/distributions.h"
#include "whitening.h"

namespace nonio::model {

namespace {

constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();
constexpr double least_dof = 8.0;
constexpr double most_neighbours = 0.95;

/// Trace, sum next to the diagonal, and sum of squares of M = P V P for a pass of m readings with
/// the correlation matrix V; P removes a polynomial with k terms in the order.
struct Moments {
  double trace = 0.0, lagged = 0.0, squares = 0.0;
};

MatrixXd powers_of_order(Index m, Index k) {
  MatrixXd columns(m, k);
  const VectorXd z = VectorXd::LinSpaced(m, -1.0, 1.0);
  for (Index c = 0; c < k; ++c) columns.col(c) = z.array().pow(static_cast<double>(c));
  return math::orthonormal(Eigen::HouseholderQR<MatrixXd>(columns), k);
}

MatrixXd without_powers(const MatrixXd& q, const MatrixXd& v) {
  MatrixXd half = math::orthogonal_part(q, v);
  half -= math::product_transposed(math::product(half, q), q);
  return half;
}

MatrixXd correlations(Index m, double rho) {
  MatrixXd v(m, m);
  VectorXd power = VectorXd::Ones(m);
  for (Index i = 1; i < m; ++i) power(i) = power(i - 1) * rho;
  for (Index i = 0; i < m; ++i)
    for (Index j = 0; j < m; ++j) v(i, j) = power(std::abs(i - j));
  return v;
}

Moments moments(Index m, Index k, double rho) {
  if (rho == 0.0) {
    const MatrixXd q = powers_of_order(m, k);
    const auto left = static_cast<double>(m - k);
    return {left, -q.topRows(m - 1).cwiseProduct(q.bottomRows(m - 1)).sum(), left};
  }
  const MatrixXd M = without_powers(powers_of_order(m, k), correlations(m, rho));
  return {M.trace(), M.diagonal<1>().sum(), M.squaredNorm()};
}

/// Variance of the sum of products of adjacent residuals of m independent readings of unit
/// variance, after a polynomial with k terms is fitted.
double variance_of_products(Index m, Index k) {
  MatrixXd b = MatrixXd::Zero(m, m);
  b.diagonal<1>().setConstant(0.5);
  b.diagonal<-1>().setConstant(0.5);
  return 2.0 * without_powers(powers_of_order(m, k), b).squaredNorm();
}

/// Passes grouped by numbers of readings and of fitted powers. `share_`: number of passes of each
/// group, reduced for the means of their cells.
class AlikePasses {
 public:
  AlikePasses(const Repeats& r, const std::vector<double>& weight) {
    std::vector<double> in_cell(r.cells, 0.0), share(r.passes, 0.0);
    std::vector<Index> used(r.passes, 0);
    for (std::size_t i = 0; i < weight.size(); ++i)
      if (weight[i] > 0.0) in_cell[r.cell[i]] += 1.0;
    for (std::size_t i = 0; i < weight.size(); ++i)
      if (weight[i] > 0.0) ++used[r.pass[i]], share[r.pass[i]] += 1.0 - 1.0 / in_cell[r.cell[i]];
    for (std::size_t p = 0; p < r.passes; ++p)
      if (used[p] > shared_columns(used[p]))
        share_[{std::min(used[p], longest), shared_columns(used[p])}] +=
            share[p] / static_cast<double>(std::min(used[p], longest));
  }

  Moments operator()(double rho) const {
    Moments sum;
    for (const auto& [pass, share] : share_) {
      const Moments one = moments(pass.first, pass.second, rho);
      sum.trace += share * one.trace;
      sum.lagged += share * one.lagged;
      sum.squares += share * one.squares;
    }
    return sum;
  }
  double variance() const {
    double sum = 0.0;
    for (const auto& [pass, share] : share_)
      sum += share * variance_of_products(pass.first, pass.second);
    return sum;
  }

 private:
  // Longer passes are treated as several passes of this length: their ends have little effect.
  static constexpr Index longest = 60;
  std::map<std::pair<Index, Index>, double> share_;
};

/// Sums of the products of adjacent weighted residuals of a pass, and of all their squares.
struct Products {
  double lagged = 0.0, squares = 0.0;
};

Products products_of(const Repeats& r, const Saturated& s, const std::vector<double>& weight) {
  Products out;
  std::vector<double> before(r.passes, not_measured);
  for (std::size_t i = 0; i < weight.size(); ++i) {
    double& last = before[r.pass[i]];
    const double e = weight[i] > 0.0 ? std::sqrt(weight[i]) * s.e[i] : not_measured;
    if (std::isfinite(e)) out.squares += e * e;
    if (std::isfinite(e) && std::isfinite(last)) out.lagged += e * last;
    last = e;
  }
  return out;
}

/// Ratio of the sums of Products, and the sum of all squares, as functions of the correlation,
/// interpolated on a grid.
class ExpectedProducts {
 public:
  explicit ExpectedProducts(const AlikePasses& passes) {
    for (int k = 0; k <= steps; ++k) {
      const Moments m = passes(step * k);
      ratio_.push_back(m.lagged / m.trace);
      trace_.push_back(m.trace);
    }
  }
  double ratio(double rho) const { return at(ratio_, rho); }
  double trace(double rho) const { return at(trace_, rho); }

 private:
  static constexpr int steps = 19;
  static constexpr double step = 0.05;

  static double at(const std::vector<double>& grid, double rho) {
    const double place = std::min(rho / step, static_cast<double>(steps) - 1e-9);
    const auto k = static_cast<std::size_t>(place);
    return grid[k] + (place - static_cast<double>(k)) * (grid[k + 1] - grid[k]);
  }

  std::vector<double> ratio_, trace_;
};

/// Variance of repeated readings including the terms of their passes, over the variance without.
double scatter_with_passes(const Repeats& r, const Saturated& s, const std::vector<double>& y,
                           const std::vector<double>& weight) {
  std::vector<double> sum(r.cells, 0.0), weights(r.cells, 0.0);
  for (std::size_t i = 0; i < y.size(); ++i)
    sum[r.cell[i]] += weight[i] * y[i], weights[r.cell[i]] += weight[i];
  double squares = 0.0, dof = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    if (!(weight[i] > 0.0)) continue;
    const double e = y[i] - sum[r.cell[i]] / weights[r.cell[i]];
    squares += weight[i] * e * e, dof += 1.0 - weight[i] / weights[r.cell[i]];
  }
  return squares / dof / (s.squares / s.dof);
}

/// The correlation is used if it exceeds `least_seen` standard deviations, and is then reduced
/// towards 0 by a normal prior with standard deviation `usual`. In short passes it is very uncertain,
/// but strongly correlated noise would make their offsets differ, too: the variance of the noise that
/// the correlation implies is at most `most` times that of the repeats with these offsets. With fewer
/// than 8 degrees of freedom, the correlation is not known.
void find_neighbours(const Repeats& r, const Saturated& s, const std::vector<double>& y,
                     const std::vector<double>& weight, Noise& noise) {
  // docs/dev/constants.md, M25.
  constexpr double usual = 0.8, least_seen = 1.5, most = 2.0, fine = 0.01;
  noise.measured = not_measured;
  if (!(s.dof >= least_dof) || !(s.squares > 0.0)) return;
  const Products found = products_of(r, s, weight);
  const AlikePasses passes(r, weight);
  const Moments none = passes(0.0);
  if (!(none.trace > 0.0)) return;
  const double ratio = found.lagged / found.squares;
  const double sd = std::sqrt(passes.variance()) / none.trace;
  const double z = (ratio - none.lagged / none.trace) / sd;
  if (!std::isfinite(z)) return;
  noise.p = 0.5 * std::erfc(z / std::sqrt(2.0));
  // Near 0 the ratio is linear in the correlation, which is not used in this case.
  if (z <= least_seen) {
    const Moments little = passes(0.05);
    const double slope = (little.lagged / little.trace - none.lagged / none.trace) / 0.05;
    noise.measured = std::clamp(z * sd / slope, -most_neighbours, most_neighbours);
    return;
  }
  const ExpectedProducts expected(passes);
  const double largest = most * scatter_with_passes(r, s, y, weight);
  double least = std::numeric_limits<double>::infinity(), nearest = least;
  for (double rho = 0.0; rho <= most_neighbours; rho += fine) {
    const double off = (ratio - expected.ratio(rho)) / sd;
    if (std::fabs(off) < nearest) nearest = std::fabs(off), noise.measured = rho;
    const double value = off * off + rho * rho / (usual * usual);
    const bool is_possible = none.trace <= largest * expected.trace(rho);
    if (value < least && (is_possible || rho == 0.0))
      least = value, noise.neighbours = noise.in_repeats = rho;
  }
  noise.u_neighbours = noise.measured / z;
}

/// Scatter of the targets along the axis. A cell of one reading contributes nothing.
struct TargetScatter {
  std::vector<double> at, squares, dof;
};

TargetScatter scatter_of(const Part& part, const Repeats& repeats, const Saturated& s,
                         const std::vector<double>& weight, double independent) {
  std::vector<double> in_cell(repeats.cells, 0.0);
  for (std::size_t i = 0; i < weight.size(); ++i)
    if (weight[i] > 0.0) in_cell[repeats.cell[i]] += 1.0;
  std::map<double, std::pair<double, double>> of;
  for (std::size_t i = 0; i < weight.size(); ++i) {
    if (!(weight[i] > 0.0) || !(in_cell[repeats.cell[i]] > 1.0)) continue;
    auto& [squares, dof] = of[part.table.axes.front().position[i]];
    squares += s.e[i] * s.e[i], dof += independent * s.share[i];
  }
  TargetScatter out;
  for (const auto& [at, sum] : of) {
    out.at.push_back(at);
    out.squares.push_back(sum.first);
    out.dof.push_back(sum.second);
  }
  return out;
}

void spread_out(const Part& part, Noise& noise) {
  noise.rough.clear();
  for (const double x : part.table.axes.front().position)
    noise.rough.push_back(x >= noise.stretch->from && x <= noise.stretch->to
                              ? noise.stretch->inside
                              : noise.stretch->outside);
}

/// Finds the range of targets whose scatter differs most from that of the others, by a factor of at
/// least 1.5 and significantly: F-test, corrected for the number of ranges. At least three of at
/// most 400 targets must be inside and three outside.
void find_stretch(const Part& part, const Repeats& repeats, const Saturated& s,
                  const std::vector<double>& weight, Noise& noise) {
  constexpr std::size_t fewest = 3, most_targets = 400;
  // docs/dev/constants.md, M26.
  constexpr double least_ratio = 1.5, by_chance = 0.005;
  const double rho2 = noise.in_repeats * noise.in_repeats;
  // squares of correlated neighbors are correlated, too
  const double independent = (1.0 - rho2) / (1.0 + rho2);
  if (part.kind != Part::Kind::axis || !(s.dof >= 2.0 * least_dof)) return;
  const TargetScatter scatter = scatter_of(part, repeats, s, weight, independent);
  const std::size_t targets = scatter.at.size();
  if (targets < 2 * fewest || targets > most_targets) return;
  std::vector<double> squares(targets + 1, 0.0), dof(targets + 1, 0.0);
  for (std::size_t k = 0; k < targets; ++k) {
    squares[k + 1] = squares[k] + scatter.squares[k];
    dof[k + 1] = dof[k] + scatter.dof[k];
  }
  const double all = squares.back(), n = dof.back();
  const double stretches = 0.5 * static_cast<double>(targets * targets);
  double best = 12.0;  // larger values occur by chance in one of 2000 ranges
  for (std::size_t a = 0; a + fewest <= targets; ++a)
    for (std::size_t b = a + fewest; b <= targets; ++b) {
      const double in = squares[b] - squares[a], f = dof[b] - dof[a];
      const double out = all - in, g = n - f;
      if (targets - (b - a) < fewest || !(in > 0.0) || !(out > 0.0)) continue;
      if (!(f >= least_dof && g >= least_dof)) continue;
      // Bartlett's test of two variances, with his correction for few degrees of freedom.
      const double gain = (n * std::log(all / n) - f * std::log(in / f) - g * std::log(out / g)) /
                          (1.0 + (1.0 / f + 1.0 / g - 1.0 / n) / 3.0);
      const double ratio = std::sqrt(in / f / (out / g));
      const double p = gain > best ? ratio > 1.0 ? math::f_upper(ratio * ratio, f, g)
                                                 : math::f_upper(1.0 / (ratio * ratio), g, f)
                                   : 1.0;
      if (!(2.0 * p * stretches < by_chance) || (ratio < least_ratio && ratio > 1.0 / least_ratio))
        continue;
      best = gain;
      const double mean = std::sqrt(all / n);
      noise.stretch = Noise::Stretch{scatter.at[a], scatter.at[b - 1], std::sqrt(in / f) / mean,
                                     std::sqrt(out / g) / mean};
    }
  if (noise.stretch) spread_out(part, noise);
}

/// `s`: residuals of a fit that is weighted with the known range. Nothing changes if the readings
/// inside or outside have few degrees of freedom left: the terms of the passes would follow them
/// closer with every round, until they seem to have no scatter at all.
void measure_stretch(const Part& part, const Repeats& repeats, const Saturated& s,
                     const std::vector<double>& weight, Noise& noise) {
  const TargetScatter scatter = scatter_of(part, repeats, s, weight, 1.0);
  double in = 0.0, f = 0.0, out = 0.0, g = 0.0;
  for (std::size_t k = 0; k < scatter.at.size(); ++k) {
    const bool inside = scatter.at[k] >= noise.stretch->from && scatter.at[k] <= noise.stretch->to;
    (inside ? in : out) += scatter.squares[k];
    (inside ? f : g) += scatter.dof[k];
  }
  if (!(in > 0.0) || !(out > 0.0) || !(f >= least_dof && g >= least_dof)) return;
  const double mean = std::sqrt((in + out) / (f + g));
  noise.stretch->inside = std::sqrt(in / f) / mean;
  noise.stretch->outside = std::sqrt(out / g) / mean;
  spread_out(part, noise);
}

}  // namespace

double digit_of(const Observations& o) {
  constexpr double same = 1e-13;  // m or rad: beyond any display
  std::vector<double> value = o.deviation;
  std::sort(value.begin(), value.end());
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < value.size(); ++i)
    if (value[i] - value[i - 1] > same) step = std::min(step, value[i] - value[i - 1]);
  if (!std::isfinite(step)) return 0.0;
  // The whole range determines the step more accurately than two rounded values.
  const double steps = std::round((value.back() - value.front()) / step);
  if (!(steps >= 1.0) || steps > 1e6) return 0.0;
  step = (value.back() - value.front()) / steps;
  for (const double x : value) {
    const double k = (x - value.front()) / step;
    if (std::fabs(k - std::round(k)) > 0.02) return 0.0;
  }
  return step;
}

std::vector<double> with_scatter(const std::vector<double>& weight, const Noise& noise) {
  std::vector<double> out = weight;
  for (std::size_t i = 0; i < noise.rough.size(); ++i) out[i] /= noise.rough[i] * noise.rough[i];
  return out;
}

Noise noise_of(const Part& part, const Repeats& repeats, const std::vector<double>& weight) {
  Noise noise;
  noise.pass = repeats.pass;
  noise.digit = digit_of(part.table);
  Saturated left = saturate(repeats, part.table.deviation, weight);
  find_neighbours(repeats, left, part.table.deviation, weight, noise);
  find_stretch(part, repeats, left, weight, noise);
  if (!noise.stretch) return noise;
  std::vector<double> with = with_scatter(weight, noise);
  // Pass terms transfer scatter of the range to other readings. Weights reduce this, so iterate.
  for (int round = 0; round < 3; ++round) {
    left = saturate(repeats, part.table.deviation, with);
    measure_stretch(part, repeats, left, weight, noise);
    with = with_scatter(weight, noise);
  }
  left = saturate(repeats, part.table.deviation, with);
  noise.neighbours = noise.in_repeats = noise.u_neighbours = 0.0;
  find_neighbours(repeats, left, part.table.deviation, with, noise);
  return noise;
}

std::optional<NoiseFloor> noise_floor(const Repeats& repeats, const Saturated& s,
                                      const std::vector<double>& weight, const Noise& noise) {
  if (!(s.dof >= 3.0)) return std::nullopt;
  double variance = s.squares / s.dof, dof = s.dof, by_neighbours = 0.0;
  if (noise.in_repeats > 0.0) {
    const AlikePasses passes(repeats, weight);
    const Moments with = passes(noise.in_repeats), none = passes(0.0);
    variance *= none.trace / with.trace;
    // effective degrees of freedom (Satterthwaite)
    dof *= with.trace * with.trace / with.squares / none.trace;
    const Moments more = passes(std::min(noise.in_repeats + noise.u_neighbours, most_neighbours));
    by_neighbours = std::sqrt(with.trace / more.trace) - 1.0;
  }
  const double floor = std::max(std::sqrt(variance), noise.digit / std::sqrt(12.0));
  return NoiseFloor{floor, floor * std::hypot(1.0 / std::sqrt(2.0 * dof), by_neighbours), dof};
}

}  // namespace nonio::model
