// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/constants.h"
#include "nonio/math/budget.h"

namespace nonio::math {
namespace {

// 2/(2 sqrt 3), rounded up: docs/dev/constants.md, A7.
constexpr double of_range = 0.6;

double get(const std::optional<double>& given, const std::string& key,
           std::vector<std::string>& missing) {
  if (given && std::isfinite(*given)) return *given;
  missing.push_back(key);
  return 0.0;
}

Budget angular(const Campaign& c, const Environment& e, std::vector<std::string>& missing) {
  Budget b;
  b.U_DEV = get(c.instrument.U_angle, "instrument.U_arcsec", missing);
  b.U_EVE = of_range * get(e.drift_angle, "environment.drift_arcsec", missing);
  return b;
}

Budget linear(const Campaign& c, const Environment& e, const std::string& name, double L,
              std::vector<std::string>& missing) {
  const Axis* axis = c.machine.axis(name);
  const Instrument& i = c.instrument;
  const double U_fixed = get(i.U_fixed, "instrument.U_fixed_um", missing);
  const double U_per_length = get(i.U_per_length, "instrument.U_per_m_um", missing);
  const double R_mis = get(e.misalignment, "environment.misalignment_mm", missing);
  const double R_theta = get(e.temperature_range, "environment.temperature_range_K", missing);
  const double dT = get(e.temperature_difference, "environment.temperature_difference_K", missing);
  const double R_alpha = get(e.expansion_range, "environment.expansion_range_um_per_m_K", missing);
  const double E_VE = get(e.drift, "environment.drift_um", missing);
  const double alpha = get(axis != nullptr ? axis->expansion : std::nullopt,
                           "machine.axes." + name + ".expansion_um_per_m_K", missing);
  Budget b;
  b.U_DEV = U_fixed + U_per_length * L;
  b.U_MIS = L > 0.0 ? of_range * R_mis * R_mis / (2.0 * L) : 0.0;
  b.U_M = of_range * std::fabs(alpha) * L * R_theta;
  b.U_E = of_range * std::fabs(dT) * L * R_alpha;
  b.U_EVE = of_range * E_VE;
  if (i.expansion) {
    b.U_MD = of_range * std::fabs(*i.expansion) * L *
             get(i.temperature_range, "instrument.temperature_range_K", missing);
    b.U_ED = of_range * std::fabs(dT) * L *
             get(i.expansion_range, "instrument.expansion_range_um_per_m_K", missing);
  }
  return b;
}

double root(double a, double b) { return std::sqrt(a * a + b * b); }

}  // namespace

double Budget::systematic() const {
  return std::sqrt(U_DEV * U_DEV + U_MIS * U_MIS + U_M * U_M + U_E * U_E + U_MD * U_MD +
                   U_ED * U_ED);
}

BudgetOrGap uncertainty_budget(const Campaign& campaign, const Environment& environment,
                               const std::string& axis, const AxisTest& test) {
  BudgetOrGap out;
  const double L = test.length();
  Budget b = test.rotary ? angular(campaign, environment, out.missing)
                         : linear(campaign, environment, axis, L, out.missing);
  b.length = L;
  b.rotary = test.rotary;
  if (b.U_EVE > 0.0) b.seen = drift_share(test);
  if (const auto exact = exact_instrument(campaign.instrument, test.rotary))
    out.missing.push_back(*exact);
  if (out.missing.empty()) out.budget = b;
  return out;
}

std::size_t approaches_per_mean(const AxisTest& test) {
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (std::size_t i = 0; i < test.targets.size(); ++i)
    for (const std::size_t n : {test.plus(i).size(), test.minus(i).size()})
      if (n > 0) least = std::min(least, n);
  return least == std::numeric_limits<std::size_t>::max() ? 0 : least;
}

Iso230Uncertainty iso230_2_uncertainty(const Budget& b, std::size_t n, double k) {
  const double root_n = std::sqrt(static_cast<double>(n));
  const double two_means = std::sqrt(2.0) * b.U_EVE / root_n;
  Iso230Uncertainty U{};
  const auto of = [](double others, double readings) {
    return ResultUncertainty{root(others, readings), readings};
  };
  const double S = b.systematic(), s = 2.0 * k * b.seen.s;
  U.B = of(two_means, b.seen.B);
  U.B_mean = of(two_means, b.seen.B_mean);
  U.M = of(root(S, b.U_EVE / root_n), b.seen.M);
  U.E = U.E_plus = U.E_minus = of(root(S, two_means), b.seen.E);
  U.R_plus = U.R_minus = of(k * b.U_EVE, s);
  U.R = of(root(k * b.U_EVE, two_means), root(s, b.seen.B));
  U.A = U.A_plus = U.A_minus = of(root(root(S, two_means), k * b.U_EVE), b.seen.E);
  return U;
}

// Pa corresponds to M of ISO 230-2, U_j to |B_i|, Ps_j = 6 s_j to R_i and P to A. k is 3, because
// Ps_j and P contain 3 s_j on each side of the mean.
VdiUncertainty vdi3441_uncertainty(const Budget& b, std::size_t n) {
  const Iso230Uncertainty iso = iso230_2_uncertainty(b, n, 3.0);
  const double two_means = std::sqrt(2.0 / static_cast<double>(n)) * b.U_EVE;
  return {iso.A,      iso.M, iso.R_plus,
          iso.R_plus, iso.B, {root(two_means, b.seen.U_mean), b.seen.U_mean}};
}

ResultUncertainty rule_uncertainty(const Budget& b, std::size_t n, const RuleShare& share) {
  const double S = share.systematic ? b.systematic() : 0.0, E_VE = b.U_EVE / of_range;
  const double of_s = share.systematic ? 0.0 : 2.0 * share.scatter * b.seen.s,
               of_means = share.seen != nullptr ? share.seen_factor * b.seen.*share.seen : 0.0,
               of_readings = root(of_s, of_means);
  return {std::sqrt(S * S + share.means * b.U_EVE * b.U_EVE / static_cast<double>(n) +
                    share.scatter * share.scatter * b.U_EVE * b.U_EVE + share.band * E_VE * E_VE +
                    of_readings * of_readings),
          of_readings};
}

ResultUncertainty slope_uncertainty(const Budget& b, std::size_t n) {
  const ResultUncertainty M = iso230_2_uncertainty(b, n, 2.0).M;
  return {M.U / b.length, M.of_readings / b.length};
}

Budget slope_budget(const Budget& b) {
  Budget out = b;
  out.U_MIS = b.U_MIS / of_range * 2.0 * of_limit;
  return out;
}

std::optional<double> common_scale_uncertainty(const Campaign& campaign, const std::string& axis,
                                               double length) {
  AxisTest ends;
  ends.targets = {0.0, length};
  const auto of = uncertainty_budget(campaign, campaign.environment, axis, ends);
  if (!of.budget || !(length > 0.0)) return std::nullopt;
  return slope_budget(*of.budget).systematic() / length / 2.0;
}

UncertaintyBudget contributions_of(const Budget& b, const std::string& axis, bool rotary) {
  UncertaintyBudget out;
  if (!rotary) out.length = b.length;
  const auto add = [&](const char* id, double U, Distribution d, Correlation c, bool with_length,
                       std::string source) {
    out.contributions.push_back({.id = id,
                                 .u = U / 2.0,
                                 .quantity = deviation_of(rotary),
                                 .with_length = with_length,
                                 .distribution = d,
                                 .correlation = c,
                                 .source = std::move(source)});
  };
  using D = Distribution;
  using C = Correlation;
  const auto add_readings = [&] {
    add("repetition", 2.0 * b.seen.scatter, D::normal, C::readings, false, "readings");
  };
  if (rotary) {
    add("device-angle", b.U_DEV, D::normal, C::lines, false, "instrument.U_arcsec");
    add("drift-angle", b.U_EVE, D::rectangular, C::readings, false, "environment.drift_arcsec");
    add_readings();
    return out;
  }
  add("device", b.U_DEV, D::normal, C::lines, true, "instrument.U_fixed_um, instrument.U_per_m_um");
  add("misalignment", b.U_MIS, D::rectangular, C::lines, true, "environment.misalignment_mm");
  add("temperature", b.U_M, D::rectangular, C::lines, true,
      "environment.temperature_range_K, machine.axes." + axis + ".expansion_um_per_m_K");
  add("expansion", b.U_E, D::rectangular, C::lines, true,
      "environment.temperature_difference_K, environment.expansion_range_um_per_m_K");
  if (b.U_MD > 0.0)
    add("device-temperature", b.U_MD, D::rectangular, C::lines, true,
        "instrument.temperature_range_K, instrument.expansion_um_per_m_K");
  if (b.U_ED > 0.0)
    add("device-expansion", b.U_ED, D::rectangular, C::lines, true,
        "environment.temperature_difference_K, instrument.expansion_range_um_per_m_K");
  add("drift", b.U_EVE, D::rectangular, C::readings, false, "environment.drift_um");
  add_readings();
  return out;
}

std::vector<double> shares_of(const Budget& b, const ResultUncertainty& of, bool systematic) {
  std::vector<double> out;
  const auto add = [&](double part) { out.push_back(systematic ? part / 2.0 : 0.0); };
  add(b.U_DEV);
  if (!b.rotary) {
    for (const double part : {b.U_MIS, b.U_M, b.U_E}) add(part);
    for (const double part : {b.U_MD, b.U_ED})
      if (part > 0.0) add(part);
  }
  const double S = systematic ? b.systematic() : 0.0;
  out.push_back(std::sqrt(std::max(0.0, of.U * of.U - S * S - of.of_readings * of.of_readings)) /
                2.0);
  out.push_back(of.of_readings / 2.0);
  return out;
}

}  // namespace nonio::math
