// SPDX-License-Identifier: Apache-2.0
//
// s is that of single readings about the means of their target and pass. u(B_mean) uses the
// differences between runs, because an error shared by a pass does not average out over the
// targets. With one run, the spread of B_i over the targets is an upper bound of u.
#include "nonio/math/reversal.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/constants.h"
#include "nonio/math/distributions.h"
#include "nonio/math/statistics.h"
#include "pass_model.h"
#include "statistics/harmonic.h"

namespace nonio::math {
namespace {

// Runs are pooled with single readings above this p; a pair of runs has only one degree of freedom
// (docs/dev/constants.md, A3).
constexpr double pooling_level = 0.5, pooling_level_of_pair = 0.05;
// Largest fraction of max |B_i| that one backlash value may leave: docs/dev/constants.md, A4.
constexpr double tolerated_share = 0.5;
constexpr double negligible = 1e-12;  // m or rad; smaller values are rounding errors

struct Estimate {
  double variance = 0.0, dof = 0.0;
};

double sized(std::size_t n) { return static_cast<double>(n); }

std::vector<double> means(const AxisTest& test, bool minus) {
  std::vector<double> out, x;
  for (std::size_t i = 0; i < test.targets.size(); ++i) {
    x.clear();
    for (const auto& r : minus ? test.minus(i) : test.plus(i)) x.push_back(r.deviation);
    out.push_back(mean(x));
  }
  return out;
}

// Mean over the targets of s+^2/n_i+ + s-^2/n_i-; 0 degrees of freedom without scatter.
Estimate scatter_of_B_i(const AxisTest& test, const PassModel& model) {
  double per[2] = {0.0, 0.0};
  for (std::size_t i = 0; i < test.targets.size(); ++i) {
    per[0] += 1.0 / sized(test.plus(i).size()) / sized(test.targets.size());
    per[1] += 1.0 / sized(test.minus(i).size()) / sized(test.targets.size());
  }
  if (model.side[0].dof <= 0.0 || model.side[1].dof <= 0.0) return {};
  const double a = model.side[0].variance() * per[0], b = model.side[1].variance() * per[1];
  return {a + b, joined_dof(a, model.side[0].dof, b, model.side[1].dof)};
}

// Uses the runs with both directions if there are at least two, otherwise the passes of each
// direction. 0 degrees of freedom if a direction has fewer than two passes.
Estimate scatter_of_passes(const PassModel& model) {
  std::vector<double> pairs, alone[2];
  for (std::size_t p = 0; p + 1 < model.passes.size(); p += 2) {
    const auto &plus = model.passes[p], &minus = model.passes[p + 1];
    if (plus.readings > 0 && minus.readings > 0) pairs.push_back(plus.offset - minus.offset);
    if (plus.readings > 0) alone[0].push_back(plus.offset);
    if (minus.readings > 0) alone[1].push_back(minus.offset);
  }
  const auto squared = [](double s) { return s * s; };
  if (pairs.size() >= 2)
    return {squared(standard_deviation(pairs)) / sized(pairs.size()), sized(pairs.size()) - 1.0};
  if (alone[0].size() < 2 || alone[1].size() < 2) return {};
  const double a = squared(standard_deviation(alone[0])) / sized(alone[0].size());
  const double b = squared(standard_deviation(alone[1])) / sized(alone[1].size());
  return {a + b, joined_dof(a, sized(alone[0].size()) - 1.0, b, sized(alone[1].size()) - 1.0)};
}

Estimate scatter_of_mean(const AxisTest& test, const PassModel& model) {
  const Estimate passes = scatter_of_passes(model);
  Estimate single = scatter_of_B_i(test, model);
  single.variance /= sized(test.targets.size());
  if (passes.dof <= 0.0 || single.dof <= 0.0) return passes.dof > 0.0 ? passes : Estimate{};
  const double p = f_upper(test_ratio(passes.variance, single.variance), passes.dof, single.dof);
  if (p < (passes.dof > 1.0 ? pooling_level : pooling_level_of_pair)) return passes;
  const double dof = passes.dof + single.dof;
  return {(passes.variance * passes.dof + single.variance * single.dof) / dof, dof};
}

Reversal::Kind decide(const Reversal& r, bool scatter_known) {
  using Kind = Reversal::Kind;
  if (r.largest < negligible) return scatter_known ? Kind::none : Kind::unknown;
  // with one target in one run, there is no scatter
  if (std::isnan(r.p_mean)) return Kind::unknown;
  const bool one_value_helps = r.largest_left <= tolerated_share * r.largest;
  const bool exists = significant(r.p_mean, significance) && r.mean != 0.0;
  const bool varies = scatter_known && significant(r.p_varies, significance);
  const Kind constant = r.mean < 0.0 ? Kind::lost_motion : Kind::over_compensated;
  if (!scatter_known) return exists && one_value_helps ? constant : Kind::unknown;
  if (exists && (!varies || one_value_helps)) return constant;
  return varies ? Kind::not_constant : Kind::none;
}

void fit_turn(const AxisTest& test, const std::vector<double>& plus,
              const std::vector<double>& minus, Reversal& r) {
  std::vector<double> half_B, middle;
  for (std::size_t i = 0; i < plus.size(); ++i) {
    half_B.push_back((plus[i] - minus[i]) / 2.0);
    middle.push_back((plus[i] + minus[i]) / 2.0);
  }
  // Least fraction of the variance that a sinusoid must explain: docs/dev/constants.md, A5.
  constexpr double most = 0.5;
  const Harmonic opposed = fit_harmonic(test.targets, half_B);
  const Harmonic concordant = fit_harmonic(test.targets, middle);
  if (!opposed.known || !concordant.known) return;
  r.opposed_amplitude = opposed.amplitude;
  r.p_opposed = opposed.p;
  r.opposed = significant(opposed.p, significance) && opposed.share >= most &&
              opposed.amplitude > negligible;
  r.concordant_amplitude = concordant.amplitude;
  r.p_concordant = concordant.p;
  r.concordant = significant(concordant.p, significance) && concordant.share >= most &&
                 concordant.amplitude > negligible;
}

}  // namespace

Reversal assess_reversal(const AxisTest& test) {
  constexpr double absent = std::numeric_limits<double>::quiet_NaN();
  Reversal r;
  r.opposed_amplitude = r.concordant_amplitude = absent;
  if (!test.bidirectional() || !test.complete()) {
    r.mean = r.u_mean = r.largest = r.largest_left = absent;
    return r;
  }
  const auto plus = means(test, false), minus = means(test, true);
  const double m = sized(test.targets.size());
  std::vector<double> B;
  for (std::size_t i = 0; i < plus.size(); ++i) B.push_back(plus[i] - minus[i]);
  r.mean = mean(B);
  for (const double B_i : B) {
    r.largest = std::max(r.largest, std::fabs(B_i));
    r.largest_left = std::max(r.largest_left, std::fabs(B_i - r.mean));
  }
  const PassModel model = fit_passes(test, false);
  const Estimate of_B_i = scatter_of_B_i(test, model);
  const Estimate of_mean = scatter_of_mean(test, model);
  const double spread = standard_deviation(B);
  if (of_B_i.dof > 0.0 && m > 1.0)
    r.p_varies = f_upper(test_ratio(spread * spread, of_B_i.variance), m - 1.0, of_B_i.dof);
  const bool known = of_mean.dof > 0.0;
  r.u_mean = known ? std::sqrt(of_mean.variance) : spread / std::sqrt(m);
  r.p_mean = t_two_sided(test_ratio(r.mean, r.u_mean), known ? of_mean.dof : m - 1.0);
  r.kind = decide(r, known);
  if (test.rotary) fit_turn(test, plus, minus, r);
  return r;
}

}  // namespace nonio::math
