// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "nonio/math/axis_findings.h"
#include "nonio/math/axis_test.h"
#include "nonio/math/budget.h"

namespace nonio::math {

namespace {

/// Returns the largest total drift of the findings about drift, m or rad; 0 without findings.
double drift_of(const Observations& o) {
  if (o.axes.empty() || o.axes.front().approach.empty()) return 0.0;
  std::vector<Finding> found;
  drift_findings(AxisTest::arrange(o), found);
  double most = 0.0;
  for (const Finding& f : found)
    for (const Number& n : f.evidence)
      if (n.name == "total") most = std::max(most, std::fabs(n.value));
  return most;
}

double distance_from_20(const Observations& o) {
  double most = 0.0;
  for (const double t : o.material)
    if (std::isfinite(t)) most = std::max(most, std::fabs(t - 20.0));
  return most;
}

double duration_of(const Observations& o) {
  double first = INFINITY, last = -INFINITY;
  for (const double t : o.time)
    if (std::isfinite(t)) first = std::min(first, t), last = std::max(last, t);
  return last > first ? last - first : 0.0;
}

/// Uses the value found in the readings if it is larger than the stated limit, and reports this.
void hold(std::optional<double>& stated, double found, const char* key, Quantity quantity,
          std::vector<Finding>& findings) {
  constexpr double slack = 1e-9;  // relative tolerance for rounding in files
  if (!stated || !(found > *stated * (1.0 + slack) + 1e-15)) return;
  findings.push_back({.id = "uncertainty.limit-exceeded",
                      .attention = true,
                      .evidence = {{"stated", *stated, quantity}, {"found", found, quantity}},
                      .texts = {{"key", key}}});
  stated = found;
}

}  // namespace

HeldLimits limits_held(const Campaign& c, std::span<const Observations* const> all) {
  HeldLimits out{c.environment, {}};
  double distance = 0.0, drift = 0.0, drift_angle = 0.0, duration = 0.0;
  for (const Observations* o : all) {
    distance = std::max(distance, distance_from_20(*o));
    duration = std::max(duration, duration_of(*o));
    double& of = o->angular ? drift_angle : drift;
    of = std::max(of, drift_of(*o));
  }
  Environment& e = out.environment;
  // A drift grows with time, so it is scaled up for a test that took longer than the drift test.
  if (e.drift_time && duration > *e.drift_time) {
    const double longer = duration / *e.drift_time;
    hold(e.drift_time, duration, "environment.drift_minutes", Quantity::time, out.findings);
    if (e.drift) *e.drift *= longer;
    if (e.drift_angle) *e.drift_angle *= longer;
  }
  hold(e.temperature_difference, distance, "environment.temperature_difference_K",
       Quantity::temperature_difference, out.findings);
  hold(e.drift, drift, "environment.drift_um", Quantity::deviation, out.findings);
  hold(e.drift_angle, drift_angle, "environment.drift_arcsec", Quantity::angular_deviation,
       out.findings);
  return out;
}

}  // namespace nonio::math
