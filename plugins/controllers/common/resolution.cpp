// SPDX-License-Identifier: Apache-2.0
#include "resolution.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "nonio/math/statistics.h"

namespace nonio::controllers {
namespace {

constexpr double least_step = 1e-6, least_angle = 1.0 / arcsec_per_rad, digits = 3.0,
                 steepest = 1e-3, impossible = 5e-2;

double resolution_of(std::vector<double> all) {
  std::sort(all.begin(), all.end());
  const double size = all.empty() ? 0.0 : std::max(std::fabs(all.front()), std::fabs(all.back()));
  double least = 0.0;
  for (std::size_t k = 1; k < all.size(); ++k) {
    const double d = all[k] - all[k - 1];
    if (d > 1e-9 * size && (least == 0.0 || d < least)) least = d;
  }
  return least;
}

enum class Side { plus, minus, both };

double variance_at(const math::AxisTest& test, std::size_t i, Side side) {
  double sum = 0.0, sides = 0.0;
  for (const bool minus : {false, true}) {
    const auto readings = minus ? test.minus(i) : test.plus(i);
    if (readings.empty() || side == (minus ? Side::plus : Side::minus)) continue;
    ++sides;
    if (readings.size() < 2) continue;
    std::vector<double> values;
    for (const auto& r : readings) values.push_back(r.deviation);
    const double s = math::standard_deviation(values);
    sum += s * s / static_cast<double>(readings.size());
  }
  return sides > 0.0 ? sum / (sides * sides) : 0.0;
}

template <class Variance>
void look_at(const std::vector<double>& position, const std::vector<double>& value,
             const Variance& variance, double resolution, bool rotary,
             std::optional<Unresolved>& found) {
  for (std::size_t i = 1; i < value.size(); ++i) {
    const double step = std::fabs(value[i] - value[i - 1]);
    const double slope = step / (position[i] - position[i - 1]);
    if (!(step > (rotary ? least_angle : least_step)) || !(slope > steepest) ||
        (found && !(slope > found->slope)))
      continue;
    const double scatter = std::sqrt(variance(i) + variance(i - 1));
    const double explained = std::max(digits * resolution, 3.0 * scatter) * (1.0 + 1e-9);
    const double limit = step > explained ? impossible : steepest;
    if (slope > limit) found = {position[i - 1], position[i], step, resolution, slope, limit};
  }
}

}  // namespace

std::optional<Unresolved> unresolved_step(const math::AxisTest& test,
                                          const math::ErrorCurve& curve) {
  std::vector<double> all;
  for (const auto& r : test.readings()) all.push_back(r.deviation);
  const double resolution = resolution_of(std::move(all));
  std::optional<Unresolved> found;
  for (const auto& [value, side] :
       {std::pair{&curve.mean, Side::both}, std::pair{&curve.plus, Side::plus},
        std::pair{&curve.minus, Side::minus}}) {
    const auto variance = [&, side = side](std::size_t k) {
      const auto [at, after] =
          std::equal_range(test.targets.begin(), test.targets.end(), curve.position[k]);
      const auto i = static_cast<std::size_t>(at - test.targets.begin());
      return at == after ? 0.0 : variance_at(test, i, side);
    };
    look_at(curve.position, *value, variance, resolution, test.rotary, found);
  }
  return found;
}

std::optional<Unresolved> unresolved_step(const ControllerInput& in, const std::string& measurement,
                                          const std::vector<double>& position,
                                          const std::vector<double>& value) {
  const auto& all = in.campaign.measurements;
  double resolution = 0.0;
  for (std::size_t i = 0; i < std::min(all.size(), in.observations.size()); ++i)
    if (all[i].id == measurement) resolution = resolution_of(in.observations[i].deviation);
  std::optional<Unresolved> found;
  const auto not_known = [](std::size_t) { return 0.0; };
  look_at(position, value, not_known, resolution, false, found);
  return found;
}

void refuse_unresolved(const std::string& axis, const std::string& measurement, bool rotary,
                       const Unresolved& step, OutputResult& result) {
  const Quantity at = position_of(rotary), q = deviation_of(rotary), slope = slope_of(rotary);
  result.findings.push_back({"table.refused-resolution",
                             true,
                             {{"step", step.step, q},
                              {"from", step.from, at},
                              {"to", step.to, at},
                              {"slope", step.slope, slope},
                              {"limit", step.limit, slope},
                              {"resolution", step.resolution, q}},
                             {{"axis", axis}},
                             measurement,
                             "Leave out one of the two targets, or measure them with an "
                             "instrument of finer resolution."});
}

bool any_unresolved(const ControllerInput& in, const CrossJob& job, OutputResult& result) {
  for (const CrossCurve& curve : job.curves)
    if (const auto step = unresolved_step(in, job.measurement, curve.position, curve.value)) {
      refuse_unresolved(curve.output, job.measurement, false, *step, result);
      return true;
    }
  return false;
}

}  // namespace nonio::controllers
