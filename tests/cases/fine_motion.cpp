// SPDX-License-Identifier: Apache-2.0
// Cases of fine motion: `given NAME x x x`.
//
//   periodic-error   period_mm; pass FROM_mm STEP_mm COUNT SLOPE_um_per_mm; wave ORDER AMPLITUDE_um PHASE
//                    of every pass: d = SLOPE (x - FROM) + sum AMPLITUDE cos(ORDER 2 pi x/p - PHASE)
//   small-steps      reading TARGET_um DEVIATION_um DIRECTION RUN
#include "fine_motion.h"

#include <cmath>
#include <numbers>

#include "nonio/math/fine_motion.h"

namespace {

using namespace nonio::math;
using Lists = std::vector<std::vector<double>>;

constexpr double um = 1e-6, mm = 1e-3;

const Lists& lists(const Case& c, const std::string& name) {
  static const Lists none;
  const auto found = c.lists.find(name);
  return found == c.lists.end() ? none : found->second;
}

Outcome of_period(const Case& c) {
  Outcome out;
  const Lists& given = lists(c, "period_mm");
  const double period = given.empty() ? 0.0 : given.front().front() * mm;
  std::vector<Pass> passes;
  for (const auto& p : lists(c, "pass")) {
    Pass& pass = passes.emplace_back();
    for (int i = 0; i < static_cast<int>(p[2]); ++i) {
      const double x = (p[0] + p[1] * i) * mm;
      double d = p[3] * p[1] * i * um;
      for (const auto& w : lists(c, "wave"))
        d += w[1] * um * std::cos(w[0] * 2.0 * std::numbers::pi * x / period - w[2]);
      pass.position.push_back(x), pass.deviation.push_back(d);
    }
  }
  const PeriodicError e = periodic_error(passes, period);
  static constexpr const char* answers[] = {"given", "no_pass", "too_short", "too_coarse"};
  out.words["answer"] = answers[static_cast<int>(e.answer)];
  out.values["periods"] = e.periods, out.values["step"] = e.step / mm;
  if (e.answer != PeriodicError::Answer::given) return out;
  out.values["range"] = e.range / um;
  for (std::size_t k = 0; k < 2; ++k) {
    const std::string number = std::to_string(k + 1);
    out.values["c" + number] = e.harmonics[k].amplitude / um;
    out.values["phase" + number] = e.harmonics[k].phase;
  }
  return out;
}

Outcome of_steps(const Case& c) {
  Outcome out;
  std::vector<SteppedReading> readings;
  for (const auto& r : lists(c, "reading"))
    readings.push_back(
        {r[0] * um, r[1] * um, static_cast<std::uint32_t>(r[3]), static_cast<int>(r[2])});
  const SmallSteps s = small_steps(readings);
  static constexpr const char* answers[] = {"given", "too_few", "several_sizes"};
  out.words["answer"] = answers[static_cast<int>(s.answer)];
  if (s.answer != SmallSteps::Answer::given) return out;
  out.values["commanded"] = s.commanded / um;
  out.values["least"] = s.steps[s.least].error / um;
  out.values["largest"] = s.steps[s.largest].error / um;
  if (s.least_first < s.steps.size()) out.values["first"] = s.steps[s.least_first].error / um;
  out.values["not_followed"] = static_cast<double>(s.not_followed);
  if (s.dof > 0.0) out.values["s"] = s.s / um;
  return out;
}

}  // namespace

bool is_fine_motion(const Case& c) {
  return c.analysis == "periodic-error" || c.analysis == "small-steps";
}

Outcome evaluate_fine_motion(const Case& c) {
  return c.analysis == "small-steps" ? of_steps(c) : of_period(c);
}
