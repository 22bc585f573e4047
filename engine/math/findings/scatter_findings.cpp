// SPDX-License-Identifier: Apache-2.0
//
// docs/dev/estimators.md describes the tests. Externally studentized residuals: R. D. Cook, S.
// Weisberg 1982, Residuals and Influence in Regression, section 2.1.
#include <algorithm>
#include <cmath>
#include <vector>

#include "axis/pass_model.h"
#include "common/constants.h"
#include "common/finding_builder.h"
#include "nonio/math/axis_findings.h"
#include "nonio/math/distributions.h"
#include "nonio/math/iso230_2.h"
#include "nonio/math/statistics.h"

namespace nonio::math {
namespace {

struct SideScatter {
  double variance = 0.0;  // variance of readings about the means of their targets
  double single = 0.0, single_dof = 0.0;
  double pass = 0.0, pass_dof = 0.0;
  double s() const { return std::sqrt(variance); }
};

double about_target(const PassModel& m, std::size_t k) {
  return m.e[k] + m.passes[m.pass[k]].offset;
}

SideScatter scatter_of(const PassModel& m, std::size_t d) {
  double squares = 0.0;
  for (std::size_t k = 0; k < m.e.size(); ++k)
    if (m.passes[m.pass[k]].minus == (d == 1) && !std::isnan(m.e[k]))
      squares += about_target(m, k) * about_target(m, k);
  const PassModel::Side& side = m.side[d];
  const double f = static_cast<double>(side.readings) - static_cast<double>(side.targets);
  const double f_pass = static_cast<double>(side.passes) - 1.0;
  if (f <= 0.0 || f_pass <= 0.0) return {};
  const double of_passes = std::max(0.0, squares - side.squares);
  return {squares / f, side.dof > 0.0 ? side.variance() : 0.0, side.dof, of_passes / f_pass,
          f_pass};
}

struct Asymmetry {
  SideScatter side[2];
  double ratio = 1.0, p = 1.0;
  bool clear() const { return significant(p, significance) && ratio >= 1.5; }
};

Asymmetry asymmetry_of(const PassModel& m) {
  Asymmetry a;
  for (std::size_t d = 0; d < 2; ++d) a.side[d] = scatter_of(m, d);
  if (a.side[0].pass_dof <= 0.0 || a.side[1].pass_dof <= 0.0) return a;
  const std::size_t wide = a.side[0].variance >= a.side[1].variance ? 0 : 1;
  const SideScatter &more = a.side[wide], &less = a.side[1 - wide];
  if (more.s() < rounding) return a;
  a.ratio = more.s() / less.s();
  const double single =
      f_upper(test_ratio(more.single, less.single), more.single_dof, less.single_dof);
  const double pass = f_upper(test_ratio(more.pass, less.pass), more.pass_dof, less.pass_dof);
  a.p = std::min(1.0, 4.0 * std::min(single, pass));  // factor 4: two tests, each for two sides
  return a;
}

std::vector<std::size_t> largest_residuals(const PassModel& m) {
  std::vector<std::size_t> out;
  for (const bool minus : {false, true}) {
    std::size_t largest = m.e.size();
    for (std::size_t k = 0; k < m.e.size(); ++k)
      if (m.passes[m.pass[k]].minus == minus &&
          (largest == m.e.size() ||
           std::fabs(about_target(m, k)) > std::fabs(about_target(m, largest))))
        largest = k;
    if (largest < m.e.size()) out.push_back(largest);
  }
  return out;
}

Asymmetry assess_asymmetry(const AxisTest& test) {
  if (!test.bidirectional() || test.most_approaches() < 2) return {};
  const PassModel all = fit_passes(test, false);
  const Asymmetry first = asymmetry_of(all);
  if (!first.clear()) return {};
  if (!asymmetry_of(fit_passes(test, false, largest_residuals(all))).clear()) return {};
  return first;
}

void asymmetry_finding(const AxisTest& test, std::vector<Finding>& findings) {
  const Asymmetry a = assess_asymmetry(test);
  if (!a.clear()) return;
  const Iso230Result iso = evaluate_iso230_2(test, 2.0);
  auto finding = FindingBuilder("repeatability.asymmetric", true, test.rotary);
  finding.deviation("s+", a.side[0].s()).deviation("s-", a.side[1].s());
  if (!std::isnan(iso.R_plus)) finding.deviation("R+", iso.R_plus);
  if (!std::isnan(iso.R_minus)) finding.deviation("R-", iso.R_minus);
  findings.push_back(finding.number("ratio", a.ratio, Quantity::ratio)
                         .number("p", a.p, Quantity::probability)
                         .text("direction", a.side[0].variance > a.side[1].variance ? "+" : "-")
                         .done());
}

struct Suspect {
  std::size_t reading = 0;
  double t = 0.0, p = 1.0, expected = 0.0;
};

struct Spread {
  double n = 0, zz = 0;
};

Suspect most_suspect(const AxisTest& test, const PassModel& m, bool slopes) {
  std::vector<Spread> spread(m.passes.size());
  std::vector<std::size_t> at(2 * test.targets.size());
  double taken = 0.0;
  for (std::size_t k = 0; k < m.e.size(); ++k) {
    if (std::isnan(m.e[k])) continue;
    const double z = test.targets[m.target[k]] - m.middle;
    spread[m.pass[k]].n += 1.0;
    spread[m.pass[k]].zz += z * z;
    ++at[2 * m.target[k] + (m.passes[m.pass[k]].minus ? 1 : 0)];
    taken += 1.0;
  }
  Suspect worst;
  double dof = 0.0;
  for (std::size_t k = 0; k < m.e.size(); ++k) {
    const bool minus = m.passes[m.pass[k]].minus;
    const auto& side = m.side[minus ? 1 : 0];
    const double n = static_cast<double>(at[2 * m.target[k] + (minus ? 1 : 0)]);
    if (std::isnan(m.e[k]) || n < 3.0 || side.dof < 4.0 || std::fabs(m.e[k]) < rounding) continue;
    const double z = test.targets[m.target[k]] - m.middle;
    const Spread& s = spread[m.pass[k]];
    const double of_pass = 1.0 / s.n + (slopes && s.zz > 0.0 ? z * z / s.zz : 0.0);
    // 1 - h, with the leverage h of equal runs
    const double free = (1.0 - 1.0 / n) * (1.0 - std::min(of_pass, 0.9));
    const double rest = std::max(0.0, side.squares - m.e[k] * m.e[k] / free) / (side.dof - 1.0);
    const double t = test_ratio(m.e[k], std::sqrt(rest * free));
    if (std::fabs(t) <= std::fabs(worst.t)) continue;
    worst = {k, t, 1.0, test.readings()[k].deviation - m.e[k] / free};
    dof = side.dof - 1.0;
  }
  worst.p = std::min(1.0, taken * t_two_sided(worst.t, dof));
  return worst;
}

struct Curve {
  std::vector<double> x, y;
};

Curve mean_curve(const AxisTest& test) {
  Curve curve;
  for (const auto& p : evaluate_iso230_2(test, 2.0).points) {
    const double y = test.bidirectional() ? p.mean : test.has_plus() ? p.mean_plus : p.mean_minus;
    if (std::isnan(y)) continue;
    curve.x.push_back(p.target);
    curve.y.push_back(y);
  }
  return curve;
}

struct Worst {
  std::size_t target = 0;
  double height = 0.0, p = 1.0;
};

Worst worst_of(const Curve& c) {
  const std::size_t m = c.x.size();
  Worst worst;
  if (m < 5) return worst;
  // q_i = sum of w_ij y_j over j = i - 1, i, i + 1
  std::vector<double> q(m, 0.0);
  std::vector<double> w[3] = {q, q, q};
  for (std::size_t i = 1; i + 1 < m; ++i) {
    const double right = (c.x[i] - c.x[i - 1]) / (c.x[i + 1] - c.x[i - 1]), left = 1.0 - right;
    const double size = std::sqrt(1.0 + left * left + right * right);
    w[0][i] = -left / size, w[1][i] = 1.0 / size, w[2][i] = -right / size;
    q[i] = w[0][i] * c.y[i - 1] + w[1][i] * c.y[i] + w[2][i] * c.y[i + 1];
  }
  double largest = -1.0;
  for (std::size_t t = 0; t < m; ++t) {
    double vq = 0.0, vv = 0.0;
    for (std::size_t i = std::max<std::size_t>(t, 2) - 1; i + 1 < m && i <= t + 1; ++i) {
      const double v = w[t + 1 - i][i];
      vq += v * q[i], vv += v * v;
    }
    if (!(vv > 0.0) || vq * vq / vv <= largest) continue;
    largest = vq * vq / vv;
    worst = {t, vq / vv, 1.0};
  }
  if (largest < 0.0) return worst;
  double rest = 0.0, others = 0.0, vv = 0.0;
  for (std::size_t i = 1; i + 1 < m; ++i) {
    if (i + 1 >= worst.target && i <= worst.target + 1)
      vv += w[worst.target + 1 - i][i] * w[worst.target + 1 - i][i];
    else
      rest += q[i] * q[i], others += 1.0;
  }
  const double t_value = test_ratio(worst.height * std::sqrt(vv), std::sqrt(rest / others));
  // Adjacent q_i share readings: their correlations of -2/3 and 1/6 reduce the number of
  // independent squares to the fraction 1/(1 + 2 (4/9 + 1/36)) = 18/35.
  const double dof = others * 18.0 / 35.0;
  worst.p = std::min(1.0, static_cast<double>(m) * t_two_sided(t_value, dof));
  return worst;
}

void worst_target_finding(const AxisTest& test, std::vector<Finding>& findings) {
  const Curve curve = mean_curve(test);
  const Worst worst = worst_of(curve);
  if (!significant(worst.p, significance) || std::fabs(worst.height) < 10.0 * rounding) return;
  const PassModel m = fit_passes(test, false);
  double variance = 0.0;
  for (const auto& side : m.side)
    if (side.dof > 0.0 && side.passes > 0)
      variance +=
          side.variance() / static_cast<double>(side.passes) / (test.bidirectional() ? 4.0 : 1.0);
  if (std::fabs(worst.height) < 4.0 * std::sqrt(1.5 * variance)) return;
  const auto [low, high] = std::minmax_element(curve.y.begin(), curve.y.end());
  const bool attention = std::fabs(worst.height) >= 0.2 * (*high - *low);
  findings.push_back(FindingBuilder("target.worst", attention, test.rotary)
                         .position("target", curve.x[worst.target])
                         .deviation("value", curve.y[worst.target])
                         .deviation("away", worst.height)
                         .number("p", worst.p, Quantity::probability)
                         .done());
}

}  // namespace

bool scatter_is_asymmetric(const AxisTest& test) { return assess_asymmetry(test).clear(); }

void suspect_findings(const AxisTest& test, std::vector<Finding>& findings) {
  // more than three indicate another distribution, not single outliers
  constexpr std::size_t most = 3;
  const bool slopes = test.targets.size() >= 4;
  std::vector<std::size_t> left_out;
  while (left_out.size() < most && test.most_approaches() >= 3) {
    const PassModel m = fit_passes(test, slopes, left_out);
    const Suspect s = most_suspect(test, m, slopes);
    if (!significant(s.p, significance)) break;
    const auto& reading = test.readings()[s.reading];
    findings.push_back(FindingBuilder("reading.suspect", true, test.rotary)
                           .count("run", reading.run)
                           .text("direction", m.passes[m.pass[s.reading]].minus ? "-" : "+")
                           .position("target", test.targets[m.target[s.reading]])
                           .deviation("value", reading.deviation)
                           .deviation("expected", s.expected)
                           .deviation("away", reading.deviation - s.expected)
                           .number("p", s.p, Quantity::probability)
                           .done());
    left_out.push_back(s.reading);
  }
}

void scatter_findings(const AxisTest& test, std::vector<Finding>& findings) {
  asymmetry_finding(test, findings);
  worst_target_finding(test, findings);
  suspect_findings(test, findings);
}

}  // namespace nonio::math
