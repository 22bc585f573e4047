// SPDX-License-Identifier: Apache-2.0
//
// Differences of a campaign from the test plan of ISO 230-2:2014 for linear and rotary axes:
//   linear to 2 m   5 targets per meter, at least 5; 5 approaches from each direction
//   linear above    the whole travel once, targets every 250 mm; 2 m of it by the full test
//   rotary          3, 5, 8 targets for travels up to 90, 180, 360 deg; 0, 90, 180, 270 among them
//   all             targets not evenly spaced, so that errors periodic with the screw are measured
//                   at different phases
#include <algorithm>
#include <cmath>

#include "common/constants.h"
#include "common/finding_builder.h"
#include "nonio/math/axis_findings.h"
#include "nonio/math/measuring_path.h"

namespace nonio::math {
namespace {

// Length above which ISO 230-2 has a separate test plan: docs/dev/constants.md, A11.
constexpr double long_axis = 2.0;  // m
constexpr double close = 1e-6;     // m or rad, tolerance for nominal positions

bool is_long(const AxisTest& test) {
  return test.length() > (test.rotary ? full_turn : long_axis) + close;
}

std::size_t wanted_targets(const AxisTest& test) {
  const double L = test.length();
  const auto whole = [](double x) {
    constexpr double most = 1e9;
    return static_cast<std::size_t>(std::min(most, std::ceil(x - 1e-9)));
  };
  if (test.rotary) return static_cast<std::size_t>(rotary_points(L));
  if (L > long_axis + close) return whole(L / 0.25);
  return std::max<std::size_t>(5, whole(5.0 * L));
}

// Returns whether a range of 2 m (a full turn) has the targets and approaches of the full test.
bool has_full_test(const AxisTest& test) {
  constexpr std::size_t runs = 5;
  const double stretch = test.rotary ? full_turn : long_axis;
  const std::size_t wanted = test.rotary ? 8 : 10;
  std::vector<double> often;
  for (std::size_t i = 0; i < test.targets.size(); ++i)
    if (test.plus(i).size() >= runs && test.minus(i).size() >= runs)
      often.push_back(test.targets[i]);
  for (std::size_t i = 0, j = 0; j < often.size(); ++j) {
    while (often[j] - often[i] > stretch + close) ++i;
    if (j - i + 1 >= wanted) return true;
  }
  return false;
}

// Targets are even within rounding; a plan that varies by 1 % is uneven.
bool even(const AxisTest& test) {
  constexpr double rounding = 5e-4;  // tolerance, as a fraction of an interval
  const std::size_t m = test.targets.size();
  if (m < 4) return false;
  const double p = test.length() / static_cast<double>(m - 1);
  for (std::size_t i = 1; i < m; ++i)
    if (std::fabs(test.targets[i] - test.targets[i - 1] - p) > rounding * p) return false;
  return true;
}

double period_of(const AxisTest& test, const Axis* axis) {
  if (axis == nullptr) return 0.0;
  if (test.rotary) return axis->teeth.value_or(0) > 0 ? full_turn / *axis->teeth : 0.0;
  return axis->screw_pitch.value_or(0.0);
}

bool multiples(const AxisTest& test, double period) {
  if (!(period > 0.0) || test.targets.size() < 2) return false;
  for (const double target : test.targets) {
    const double turns = (target - test.targets.front()) / period;
    if (std::fabs(turns - std::round(turns)) > 0.01) return false;
  }
  return true;
}

bool has_angle(const AxisTest& test, double angle) {
  return std::any_of(test.targets.begin(), test.targets.end(), [&](double target) {
    return std::fabs(std::remainder(target - angle, full_turn)) < 2e-4;  // tolerance of 0.01 deg
  });
}

void cardinal_angles(const AxisTest& test, std::vector<Finding>& findings) {
  if (!test.rotary || test.length() < 0.75 * full_turn - close) return;
  std::string missing;
  for (int quarter = 0; quarter < 4; ++quarter)
    if (!has_angle(test, full_turn / 4.0 * quarter))
      missing += (missing.empty() ? "" : ", ") + std::to_string(90 * quarter);
  if (!missing.empty())
    findings.push_back(
        FindingBuilder("plan.cardinal-angles", false, true).text("angles", missing).done());
}

void absent_directions(const AxisTest& test, std::vector<Finding>& findings) {
  if (test.targets.empty() || test.bidirectional()) return;
  const bool only_plus = test.has_plus();
  findings.push_back(FindingBuilder("direction.missing", false, test.rotary)
                         .text("direction", only_plus ? "-" : "+")
                         .text("given", only_plus ? "+" : "-")
                         .text("absent", only_plus ? "A, A-, E, E-, M, R, R-, B, B_mean"
                                                   : "A, A+, E, E+, M, R, R+, B, B_mean")
                         .done());
}

void counts(const AxisTest& test, const Observations& o, std::vector<Finding>& findings) {
  const auto number = [](std::size_t n) { return static_cast<double>(n); };
  if (o.missing > 0)
    findings.push_back(FindingBuilder("readings.missing", false, test.rotary)
                           .count("missing", static_cast<double>(o.missing))
                           .count("taken", number(o.size()))
                           .done());
  if (!is_long(test) && approaches_per_mean(test) < 5)
    findings.push_back(FindingBuilder("plan.too-few-runs", false, test.rotary)
                           .count("runs", number(approaches_per_mean(test)))
                           .count("wanted", 5.0)
                           .done());
}

void outside_travel(const AxisTest& test, const Axis* axis, std::vector<Finding>& findings) {
  if (axis == nullptr || !axis->travel) return;
  const auto [from, to] = *axis->travel;
  std::vector<std::size_t> outside;
  for (std::size_t i = 0; i < test.targets.size(); ++i)
    if (test.targets[i] < from - close || test.targets[i] > to + close) outside.push_back(i);
  if (outside.empty()) return;
  findings.push_back(FindingBuilder("targets.outside-travel", true, test.rotary)
                         .count("concerned", static_cast<double>(outside.size()))
                         .count("targets", static_cast<double>(test.targets.size()))
                         .position("from", from)
                         .position("to", to)
                         .text("which", target_list(test, outside))
                         .done());
}

}  // namespace

void plan_findings(const AxisTest& test, const Observations& o, const Axis* axis,
                   std::vector<Finding>& findings) {
  if (test.targets.empty()) return;
  absent_directions(test, findings);
  counts(test, o, findings);
  outside_travel(test, axis, findings);
  const double m = static_cast<double>(test.targets.size());
  const std::size_t wanted = wanted_targets(test);
  if (test.targets.size() < wanted)
    findings.push_back(FindingBuilder("plan.too-few-targets", false, test.rotary)
                           .count("targets", m)
                           .count("wanted", static_cast<double>(wanted))
                           .position("length", test.length())
                           .done());
  const double period = period_of(test, axis);
  if (multiples(test, period))
    findings.push_back(FindingBuilder("plan.pitch-multiples", false, test.rotary)
                           .position("pitch", period)
                           .count("targets", m)
                           .done());
  else if (even(test))
    findings.push_back(FindingBuilder("plan.even-targets", false, test.rotary)
                           .position("interval", test.length() / (m - 1.0))
                           .count("targets", m)
                           .done());
  if (is_long(test) && !has_full_test(test))
    findings.push_back(FindingBuilder("plan.long-axis", false, test.rotary)
                           .position("length", test.length())
                           .count("runs", static_cast<double>(test.most_approaches()))
                           .done());
  cardinal_angles(test, findings);
}

}  // namespace nonio::math
