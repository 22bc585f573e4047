// SPDX-License-Identifier: Apache-2.0
#include "resolution.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "nonio/math/statistics.h"

namespace nonio::controllers {
namespace {

constexpr double least_step = 1e-6, least_angle = 1.0 / arcsec_per_rad, steepest = 1e-3,
                 impossible = 1e-2;

/// Smallest difference of two readings that differ; 0 if all are equal.
double resolution_of(const math::AxisTest& test) {
  std::vector<double> all;
  for (std::size_t i = 0; i < test.targets.size(); ++i)
    for (const auto& readings : {test.plus(i), test.minus(i)})
      for (const auto& r : readings) all.push_back(r.deviation);
  std::sort(all.begin(), all.end());
  const double size = all.empty() ? 0.0 : std::max(std::fabs(all.front()), std::fabs(all.back()));
  double least = 0.0;
  for (std::size_t k = 1; k < all.size(); ++k) {
    const double d = all[k] - all[k - 1];
    if (d > 1e-9 * size && (least == 0.0 || d < least)) least = d;
  }
  return least;
}

/// Variance of the mean of both directions at a target, by its repeats.
double variance_at(const math::AxisTest& test, std::size_t i) {
  double sum = 0.0, sides = 0.0;
  for (const auto& readings : {test.plus(i), test.minus(i)}) {
    if (readings.empty()) continue;
    ++sides;
    if (readings.size() < 2) continue;
    std::vector<double> values;
    for (const auto& r : readings) values.push_back(r.deviation);
    const double s = math::standard_deviation(values);
    sum += s * s / static_cast<double>(readings.size());
  }
  return sides > 0.0 ? sum / (sides * sides) : 0.0;
}

}  // namespace

std::optional<Unresolved> unresolved_step(const math::AxisTest& test,
                                          const math::ErrorCurve& curve) {
  const double resolution = resolution_of(test);
  std::vector<double> variance;
  for (const double x : curve.position) {
    const auto at = std::find(test.targets.begin(), test.targets.end(), x);
    variance.push_back(
        at == test.targets.end()
            ? 0.0
            : variance_at(test, static_cast<std::size_t>(at - test.targets.begin())));
  }
  std::optional<Unresolved> found;
  double slope = steepest;
  for (std::size_t i = 1; i < curve.position.size(); ++i) {
    const double step = std::fabs(curve.mean[i] - curve.mean[i - 1]);
    const double apart = curve.position[i] - curve.position[i - 1];
    const double explained = std::max(resolution, 3.0 * std::sqrt(variance[i] + variance[i - 1]));
    if (!(step > (test.rotary ? least_angle : least_step)) || !(step > slope * apart) ||
        (step > explained * (1.0 + 1e-9) && !(step > impossible * apart)))
      continue;
    slope = step / apart;
    found = {curve.position[i - 1], curve.position[i], step, resolution};
  }
  return found;
}

void refuse_unresolved(const AxisJob& job, const Unresolved& step, OutputResult& result) {
  const Quantity at = position_of(job.rotary), q = deviation_of(job.rotary);
  result.findings.push_back({"table.refused-resolution",
                             true,
                             {{"step", step.step, q},
                              {"from", step.from, at},
                              {"to", step.to, at},
                              {"resolution", step.resolution, q}},
                             {{"axis", job.axis}},
                             job.measurement,
                             "Leave out one of the two targets, or measure them with an "
                             "instrument of finer resolution."});
}

}  // namespace nonio::controllers
