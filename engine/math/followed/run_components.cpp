// SPDX-License-Identifier: Apache-2.0
#include "run_components.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "common/constants.h"
#include "dense.h"
#include "nonio/math/statistics.h"

namespace nonio::math {
namespace {

using Eigen::Index, Eigen::MatrixXd;
using RunPart = RunComponents::Part;

struct PassExtent {
  double n = 0.0, z = 0.0, zz = 0.0;
  double spread() const { return n > 0.0 ? zz - z * z / n : 0.0; }
};

std::vector<PassExtent> pass_extents(const AxisTest& test, const PassModel& passes) {
  std::vector<PassExtent> out(passes.passes.size());
  for (std::size_t k = 0; k < passes.pass.size(); ++k) {
    PassExtent& e = out[passes.pass[k]];
    const double z = test.targets[passes.target[k]] - passes.middle;
    e.n += 1.0, e.z += z, e.zz += z * z;
  }
  return out;
}

/// `noise`: contribution of single readings to the variance of the values.
RunPart run_part(const std::vector<double>& values, double noise) {
  const double s = standard_deviation(values);
  return {std::max(0.0, s * s - noise), noise, s * s};
}

/// Values of the complete runs. `noise`: mean contribution of single readings to their variance.
struct RunValues {
  std::vector<double> shared_offset, own_offset, shared_slope, own_slope;
  double offset_noise = 0.0, slope_noise = 0.0;
};

RunValues run_values(const RunComponents& c, const std::vector<PassExtent>& extent, bool both) {
  RunValues out;
  const auto& passes = c.passes.passes;
  for (std::size_t p = 0; p + 1 < passes.size(); p += 2) {
    const bool has[2] = {passes[p].readings > 0, passes[p + 1].readings > 0};
    if (both ? !(has[0] && has[1]) : !(has[0] || has[1])) continue;
    double offset[2] = {}, slope[2] = {}, of_offset = 0.0, of_slope = 0.0;
    for (const std::size_t d : {0U, 1U}) {
      if (!has[d]) continue;
      offset[d] = passes[p + d].offset, slope[d] = passes[p + d].slope;
      of_offset += c.reading[d] / extent[p + d].n;
      if (extent[p + d].spread() > 0.0) of_slope += c.reading[d] / extent[p + d].spread();
    }
    const double part = both ? 0.5 : 1.0;  // with one direction, the sum is its value
    out.shared_offset.push_back(part * (offset[0] + offset[1]));
    out.shared_slope.push_back(part * (slope[0] + slope[1]));
    out.own_offset.push_back(0.5 * (offset[0] - offset[1]));
    out.own_slope.push_back(0.5 * (slope[0] - slope[1]));
    out.offset_noise += squared(part) * of_offset;
    out.slope_noise += squared(part) * of_slope;
  }
  const auto n = static_cast<double>(out.shared_offset.size());
  if (n > 0.0) out.offset_noise /= n, out.slope_noise /= n;
  return out;
}

/// Effects of correlated adjacent readings on a pass of m readings from which a line is subtracted.
struct Alike {
  double lag1 = 0.0;      ///< expected lag-1 correlation of the residuals
  double residual = 1.0;  ///< residual variance per degree of freedom, relative to a reading
  /// variances of mean and slope, relative to those with independent readings
  double offset = 1.0, slope = 1.0;
  double dof = 1.0;  ///< degrees of freedom, relative to those of independent readings
};

Alike alike(Index m, double r) {
  MatrixXd R(m, m), X(m, 2);
  for (Index i = 0; i < m; ++i) {
    for (Index j = 0; j < m; ++j) R(i, j) = std::pow(r, std::fabs(static_cast<double>(i - j)));
    X(i, 0) = 1.0 / std::sqrt(static_cast<double>(m));
    X(i, 1) = static_cast<double>(i) - static_cast<double>(m - 1) / 2.0;
  }
  X.col(1).normalize();
  MatrixXd M = MatrixXd::Identity(m, m);
  M -= product_transposed(X, X);
  const MatrixXd e = product(product(M, R), M);
  const double n = static_cast<double>(m);
  return {e.diagonal(1).sum() / (n - 1.0) / (e.trace() / n), e.trace() / (n - 2.0),
          X.col(0).dot(times(R, X.col(0))), X.col(1).dot(times(R, X.col(1))),
          squared(e.trace()) / e.squaredNorm() / (n - 2.0)};
}

/// Returns nothing unless the lag-1 correlation is significant (one-sided 5 %).
std::optional<double> lag_of_residuals(const PassModel& m, const Alike& white) {
  std::vector<double> before(m.passes.size(), std::numeric_limits<double>::quiet_NaN());
  double products = 0.0, squares = 0.0, pairs = 0.0, readings = 0.0;
  for (std::size_t k = 0; k < m.e.size(); ++k) {  // sorted by target, so in the order of each pass
    if (std::isnan(m.e[k])) continue;
    double& last = before[m.pass[k]];
    if (!std::isnan(last)) products += last * m.e[k], pairs += 1.0;
    squares += m.e[k] * m.e[k], readings += 1.0;
    last = m.e[k];
  }
  constexpr double one_sided = 1.645;
  if (!(pairs > 0.0) || !(squares > 0.0)) return std::nullopt;
  const double lag = products / pairs / (squares / readings);
  if (!(lag - white.lag1 > one_sided / std::sqrt(pairs))) return std::nullopt;
  return lag;
}

/// Stores in `c` the correlation of adjacent readings that explains the lag-1 correlation of the
/// residuals (0 if not significant or with fewer than four targets), and returns its effects.
Alike find_neighbours(RunComponents& c, std::size_t targets) {
  constexpr double most = 0.95;
  constexpr std::size_t longest = 80;  // with more targets the effect of the ends is negligible
  const auto m = static_cast<Index>(std::min(targets, longest));
  if (m < 4) return {};
  const auto lag = lag_of_residuals(c.passes, alike(m, 0.0));
  if (!lag) return {};
  double low = 0.0, high = most;
  for (int step = 0; step < 12; ++step)
    (alike(m, (low + high) / 2.0).lag1 > *lag ? high : low) = (low + high) / 2.0;
  c.neighbours = (low + high) / 2.0;
  return alike(m, c.neighbours);
}

struct PassSums {
  std::vector<double> offset, slope;
};

std::size_t place_of(const PassModel& m, std::size_t reading) {
  return 2 * m.target[reading] + (m.passes[m.pass[reading]].minus ? 1 : 0);
}

PassSums pass_sums(const AxisTest& test, const PassModel& m, const TargetWeights& J) {
  PassSums out{std::vector<double>(m.passes.size(), 0.0),
               std::vector<double>(m.passes.size(), 0.0)};
  for (std::size_t k = 0; k < m.pass.size(); ++k) {
    const double w = J[place_of(m, k)];
    out.offset[m.pass[k]] += w;
    out.slope[m.pass[k]] += w * (test.targets[m.target[k]] - m.middle);
  }
  return out;
}

/// Contribution of single readings, if adjacent readings are independent.
double covariance_of_singles(const AxisTest& test, const RunComponents& c, const TargetWeights& a,
                             const TargetWeights& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < test.targets.size(); ++i)
    sum += c.reading[0] * static_cast<double>(test.plus(i).size()) * a[2 * i] * b[2 * i] +
           c.reading[1] * static_cast<double>(test.minus(i).size()) * a[2 * i + 1] * b[2 * i + 1];
  return sum;
}

/// Contribution of single readings, if readings k and l of a pass have the correlation r^|k - l|.
double covariance_of_neighbours(const RunComponents& c, const TargetWeights& a,
                                const TargetWeights& b) {
  const PassModel& m = c.passes;
  double sum = 0.0;
  std::vector<double> tail_a(m.passes.size(), 0.0), tail_b = tail_a;
  for (std::size_t k = 0; k < m.pass.size(); ++k) {
    const double wa = a[place_of(m, k)], wb = b[place_of(m, k)];
    double &ta = tail_a[m.pass[k]], &tb = tail_b[m.pass[k]];
    sum += c.reading[m.passes[m.pass[k]].minus ? 1 : 0] *
           (wa * wb + c.neighbours * (wa * tb + wb * ta));
    ta = wa + c.neighbours * ta, tb = wb + c.neighbours * tb;
  }
  return sum;
}

double covariance_of_runs(const PassSums& a, const PassSums& b, const RunComponents& c) {
  const auto runs = [](const std::vector<double>& x, const std::vector<double>& y,
                       const RunPart& shared, const RunPart& own) {
    double total = 0.0;
    for (std::size_t p = 0; p + 1 < x.size(); p += 2)
      total += shared.variance * (x[p] + x[p + 1]) * (y[p] + y[p + 1]) +
               own.variance * (x[p] - x[p + 1]) * (y[p] - y[p + 1]);
    return total;
  };
  return runs(a.offset, b.offset, c.shared_offset, c.own_offset) +
         runs(a.slope, b.slope, c.shared_slope, c.own_slope);
}

}  // namespace

RunComponents run_components(const AxisTest& test) {
  RunComponents out;
  out.passes = fit_passes(test, true);
  for (const std::size_t d : {0U, 1U})
    if (out.passes.side[d].dof > 0.0) out.reading[d] = out.passes.side[d].variance();
  const Alike of_pass = find_neighbours(out, test.targets.size());
  for (double& v : out.reading) v /= of_pass.residual;
  const bool both = test.bidirectional();
  RunValues c = run_values(out, pass_extents(test, out.passes), both);
  c.offset_noise *= of_pass.offset, c.slope_noise *= of_pass.slope;
  out.independent = of_pass.dof;
  out.runs = static_cast<double>(c.shared_offset.size());
  if (out.runs < 2.0) return out;
  out.shared_offset = run_part(c.shared_offset, c.offset_noise);
  out.shared_slope = run_part(c.shared_slope, c.slope_noise);
  if (!both) return out;
  out.own_offset = run_part(c.own_offset, c.offset_noise);
  out.own_slope = run_part(c.own_slope, c.slope_noise);
  return out;
}

double value_of(const AxisTest& test, const TargetWeights& weights) {
  double sum = 0.0;
  for (std::size_t i = 0; i < test.targets.size(); ++i) {
    for (const AxisTest::Reading& r : test.plus(i)) sum += weights[2 * i] * r.deviation;
    for (const AxisTest::Reading& r : test.minus(i)) sum += weights[2 * i + 1] * r.deviation;
  }
  return sum;
}

std::vector<double> covariance_of(const AxisTest& test, const RunComponents& c,
                                  const std::vector<TargetWeights>& weights) {
  const std::size_t n = weights.size();
  std::vector<PassSums> sums;
  for (const TargetWeights& w : weights) sums.push_back(pass_sums(test, c.passes, w));
  std::vector<double> out(n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i; j < n; ++j)
      out[i * n + j] = out[j * n + i] =
          (c.neighbours == 0.0 ? covariance_of_singles(test, c, weights[i], weights[j])
                               : covariance_of_neighbours(c, weights[i], weights[j])) +
          covariance_of_runs(sums[i], sums[j], c);
  return out;
}

PooledScatter pooled_scatter(const AxisTest& test, const RunComponents& c) {
  double squares = 0.0, n = 0.0, zz = 0.0, all_dof = 0.0;
  for (std::size_t i = 0; i < test.targets.size(); ++i) {
    zz += squared(test.targets[i] - c.passes.middle);
    for (const auto side : {test.plus(i), test.minus(i)}) {
      if (side.size() < 2) continue;
      squares += squared(standard_deviation(deviations(side))), n += 1.0;
      all_dof += static_cast<double>(side.size() - 1);
    }
  }
  if (n == 0.0) return {};
  zz /= static_cast<double>(test.targets.size());
  const double mean_square = squares / n;
  double variance = 0.0, dof = 0.0;
  for (const auto& side : c.passes.side) {
    if (side.dof <= 0.0) continue;
    variance += 2.0 * squared(side.squares / all_dof) / (side.dof * c.independent);
    dof += side.dof;
  }
  // The estimate V of a component over the runs has the variance 2 V^2/(runs - 1). Because V itself
  // is uncertain, V^2 is too large on average, by a factor that depends on the fraction a of the
  // mean square that V contributes (second order).
  const double of_runs = c.runs - 1.0;
  const auto put = [&](const RunPart& p, double factor) {
    const double V = factor * p.whole, a = std::min(1.0, V / mean_square);
    variance += 2.0 * squared(V) / of_runs / (1.0 + 2.0 / of_runs * (1.0 - a) * (1.0 - 3.0 * a));
  };
  put(c.shared_offset, 1.0), put(c.shared_slope, zz);
  if (test.bidirectional()) put(c.own_offset, 1.0), put(c.own_slope, zz);
  return {std::sqrt(mean_square), dof > 0.0 ? 0.5 * std::sqrt(variance) / mean_square : 0.0};
}

}  // namespace nonio::math
