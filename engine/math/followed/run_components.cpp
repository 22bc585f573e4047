// SPDX-License-Identifier: Apache-2.0
#include "run_components.h"

#include <algorithm>
#include <cmath>

#include "nonio/math/statistics.h"

namespace nonio::math {
namespace {

using RunPart = RunComponents::Part;

/// Of one pass: readings, and sum of squared distances from their own middle.
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

double squared(double x) { return x * x; }

/// Of values of the runs that have the mean 0 but for what is missing.
RunPart run_part(const std::vector<double>& values, double noise) {
  const double s = standard_deviation(values);
  return {std::max(0.0, s * s - noise), noise};
}

/// Collects the offsets and slopes of the runs.
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
    const double part = both ? 0.5 : 1.0;  // of one direction only the sum is there
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

/// Sums of weights over each pass: as they are, and times the distance from the middle.
struct PassSums {
  std::vector<double> offset, slope;
};

PassSums pass_sums(const AxisTest& test, const PassModel& m, std::span<const double> J) {
  PassSums out{std::vector<double>(m.passes.size(), 0.0),
               std::vector<double>(m.passes.size(), 0.0)};
  for (std::size_t k = 0; k < J.size(); ++k) {
    out.offset[m.pass[k]] += J[k];
    out.slope[m.pass[k]] += J[k] * (test.targets[m.target[k]] - m.middle);
  }
  return out;
}

}  // namespace

RunComponents run_components(const AxisTest& test) {
  RunComponents out;
  out.passes = fit_passes(test, true);
  for (const std::size_t d : {0U, 1U})
    if (out.passes.side[d].dof > 0.0) out.reading[d] = out.passes.side[d].variance();
  const bool both = test.bidirectional();
  const RunValues c = run_values(out, pass_extents(test, out.passes), both);
  out.runs = static_cast<double>(c.shared_offset.size());
  if (out.runs < 2.0) return out;
  out.shared_offset = run_part(c.shared_offset, c.offset_noise);
  out.shared_slope = run_part(c.shared_slope, c.slope_noise);
  if (!both) return out;
  out.own_offset = run_part(c.own_offset, c.offset_noise);
  out.own_slope = run_part(c.own_slope, c.slope_noise);
  return out;
}

double covariance_of(const AxisTest& test, const RunComponents& c, std::span<const double> a,
                     std::span<const double> b) {
  const PassModel& m = c.passes;
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k)
    sum += c.reading[m.passes[m.pass[k]].minus ? 1 : 0] * a[k] * b[k];
  const PassSums of_a = pass_sums(test, m, a), of_b = pass_sums(test, m, b);
  const auto runs = [&](const std::vector<double>& x, const std::vector<double>& y,
                        const RunPart& shared, const RunPart& own) {
    double total = 0.0;
    for (std::size_t p = 0; p + 1 < x.size(); p += 2)
      total += shared.variance * (x[p] + x[p + 1]) * (y[p] + y[p + 1]) +
               own.variance * (x[p] - x[p + 1]) * (y[p] - y[p + 1]);
    return total;
  };
  return sum + runs(of_a.offset, of_b.offset, c.shared_offset, c.own_offset) +
         runs(of_a.slope, of_b.slope, c.shared_slope, c.own_slope);
}

PooledScatter pooled_scatter(const AxisTest& test, const RunComponents& c) {
  double squares = 0.0, n = 0.0, zz = 0.0, single = 0.0, dof = 0.0;
  for (std::size_t i = 0; i < test.targets.size(); ++i) {
    zz += squared(test.targets[i] - c.passes.middle);
    for (const auto side : {test.plus(i), test.minus(i)}) {
      if (side.size() < 2) continue;
      squares += squared(standard_deviation(deviations(side))), n += 1.0;
    }
  }
  if (n == 0.0) return {};
  zz /= static_cast<double>(test.targets.size());
  for (const auto& side : c.passes.side) {
    if (side.dof <= 0.0) continue;
    single += 2.0 * squared(side.variance() * static_cast<double>(side.targets) / n) / side.dof;
    dof += side.dof;
  }
  const double mean_square = squares / n;
  // The pooled variance is the sum of its parts; each part's estimate has the variance
  // 2 (part + noise)^2/(runs - 1).
  double variance = single;
  const double of_runs = c.runs - 1.0;
  const bool both = test.bidirectional();
  for (const RunPart* p : {&c.shared_offset, &c.own_offset})
    if (p == &c.shared_offset || both)
      variance += 2.0 * squared(p->variance + (p->variance > 0.0 ? p->noise : 0.0)) / of_runs;
  for (const RunPart* p : {&c.shared_slope, &c.own_slope})
    if (p == &c.shared_slope || both)
      variance +=
          2.0 * squared(zz * (p->variance + (p->variance > 0.0 ? p->noise : 0.0))) / of_runs;
  return {std::sqrt(mean_square), dof > 0.0 ? 0.5 * std::sqrt(variance) / mean_square : 0.0};
}

}  // namespace nonio::math
