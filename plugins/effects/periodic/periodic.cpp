// SPDX-License-Identifier: Apache-2.0
// deviation = a sin(2 pi p/P) + b cos(2 pi p/P); p: position from the center of the measured range,
// m; P: period, m; a, b: m.
#include <algorithm>
#include <numbers>

#include "nonio/sdk/axis_readings.h"
#include "nonio/sdk/plugin.h"

namespace nonio::periodic {

/// Nominal leads of ISO 3408-2:1991, table 1, and of inch screws; m.
constexpr double usual_leads[] = {0.0025, 0.003, 0.004, 0.005, 0.006,  0.008, 0.010, 0.012,
                                  0.0127, 0.016, 0.020, 0.025, 0.0254, 0.032, 0.040};

/// Targets of several lines that differ only by rounding are merged.
static std::vector<double> places_of(const AxisReadings& r) {
  const double same = 1e-5 * r.length;
  std::vector<double> places = targets_of(r);
  places.erase(std::unique(places.begin(), places.end(),
                           [same](double a, double b) { return b - a < same; }),
               places.end());
  return places;
}

/// Periods to be tested, m: screw_pitch of the manifest if stated. Otherwise at least three periods
/// over the range, and fewer than half as many periods as intervals (uneven targets: twice as
/// many). The step is a quarter of a spectral line, wider above 240 periods, but not for circles,
/// whose readings are sparse at high speed. Of shorter periods, only usual screw leads are tested
/// with uneven targets, because some arbitrary period would always fit.
static std::vector<double> grid(const Observations& o, const Axis& axis) {
  constexpr double most = 240.0, fewest_periods = 3.0;
  constexpr std::size_t fewest_targets = 8;
  if (axis.screw_pitch) return {*axis.screw_pitch};
  const auto r = readings_of(o, axis);
  if (!r) return {};
  const std::vector<double> targets = places_of(*r);
  if (targets.size() < fewest_targets) return {};
  const double intervals = static_cast<double>(targets.size() - 1);
  const double mean = r->length / intervals;
  bool even = true;
  for (std::size_t k = 1; k < targets.size(); ++k)
    even = even && std::abs(targets[k] - targets[k - 1] - mean) <= 0.01 * mean;
  double limit = intervals * (even ? 0.5 : 2.0);  // largest number of periods over the range
  if (!o.sense.empty()) limit = std::min(limit, fewest_periods + 0.25 * most);
  const double step = std::max(0.25, (limit - fewest_periods) / most);
  std::vector<double> periods;
  for (int k = 0; fewest_periods + k * step < limit - step / 2.0; ++k)
    periods.push_back(r->length / (fewest_periods + k * step));
  const double shortest = periods.empty() ? r->length : periods.back();
  for (const double lead : usual_leads)
    if (!even && lead < shortest)
      for (const double line : {0.125, 0.0, -0.125})
        periods.push_back(lead * (1.0 + line * lead / r->length));
  std::sort(periods.begin(), periods.end());
  return periods;
}

static bool applies(const Observations& o, const Axis& axis) {
  return !axis.rotary && readings_of(o, axis) && !grid(o, axis).empty();
}

static Expected<Effect::Columns> columns(const Observations& o, const Axis& axis,
                                         const std::vector<double>& shape) {
  if (shape.size() != 1 || !(shape[0] > 0.0)) return fail("periodic: expected a period above 0");
  const double w = 2.0 * std::numbers::pi / shape[0];
  return columns_of(
      o, axis, [w](const AxisReadings& r, std::size_t i) { return std::sin(w * r.p[i]); },
      [w](const AxisReadings& r, std::size_t i) { return std::cos(w * r.p[i]); });
}

NONIO_PLUGIN(registry) {
  registry.add(Effect{.info = {"periodic", "1.0.0", "Once per screw revolution or scale period"},
                      .linear = {{"a", "part with the sine", Quantity::deviation},
                                 {"b", "part with the cosine", Quantity::deviation}},
                      .shapes = {{{"P", "period", Quantity::length}, grid}},
                      .compensable = true,
                      .applies = applies,
                      .columns = columns,
                      .why_not = [](const Observations& o, const Axis& axis) {
                        return WhyNot{!axis.rotary && readings_of(o, axis) ? "few-targets" : ""};
                      }});
}

}  // namespace nonio::periodic
