// SPDX-License-Identifier: Apache-2.0
//
// Uncertainty of a positioning test, after ISO/TR 230-9:2005 Annex C and ISO 230-2:2006 Annex A.
//
// A quantity that lies within a full range r, all places equally likely, has the standard
// uncertainty r/(2 sqrt 3) and the expanded one (k = 2) r/sqrt 3 = 0.577 r, rounded up to 0.6 r.
//   U_DEV = U_fixed + U_per_length L              m      certificate of the instrument
//   U_MIS = 0.6 R_mis^2/(2 L)                     m      R_mis: beam against axis over L, m
//   U_M   = 0.6 alpha L R(theta)                  m      alpha: 1/K, R(theta): K
//   U_E   = 0.6 dT L R(alpha)                     m      dT: largest distance from 20 degC, K
//   U_EVE = 0.6 E_VE                              m      E_VE: range of the drift test
// With S2 = U_DEV^2 + U_MIS^2 + U_M^2 + U_E^2, n approaches, and R+ = 2 k s, A with k s:
//   U(B)^2 = 2 U_EVE^2/n                 systematic parts cancel
//   U(M)^2 = S2 + U_EVE^2/n;   U(E)^2 = S2 + 2 U_EVE^2/n
//   U(R+)  = k U_EVE;          U(R)^2 = (k U_EVE)^2 + 2 U_EVE^2/n
//   U(A)^2 = U(E)^2 + (k U_EVE)^2
// S2 is that of the whole length, hence an upper bound; so is U(B) for B_mean.
#include "nonio/math/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nonio::math {
namespace {

constexpr double of_range = 0.6;  // see above: 2/(2 sqrt 3), rounded up

double get(const std::optional<double>& given, const std::string& key,
           std::vector<std::string>& missing) {
  if (given && std::isfinite(*given)) return *given;
  missing.push_back(key);
  return 0.0;
}

Budget angular(const Campaign& c, std::vector<std::string>& missing) {
  Budget b;
  b.U_DEV = get(c.instrument.U_angle, "instrument.U_arcsec", missing);
  b.U_EVE = of_range * get(c.environment.drift_angle, "environment.drift_arcsec", missing);
  return b;
}

Budget linear(const Campaign& c, const std::string& name, double L,
              std::vector<std::string>& missing) {
  const Axis* axis = c.machine.axis(name);
  const Instrument& i = c.instrument;
  const Environment& e = c.environment;
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
  return b;
}

double root(double a, double b) { return std::sqrt(a * a + b * b); }

}  // namespace

double Budget::systematic() const {
  return std::sqrt(U_DEV * U_DEV + U_MIS * U_MIS + U_M * U_M + U_E * U_E);
}

BudgetOrGap uncertainty_budget(const Campaign& campaign, const std::string& axis,
                               const AxisTest& test) {
  BudgetOrGap out;
  const double L = test.length();
  Budget b = test.rotary ? angular(campaign, out.missing) : linear(campaign, axis, L, out.missing);
  b.length = L;
  if (out.missing.empty()) out.budget = b;
  return out;
}

std::size_t approaches_behind_means(const AxisTest& test) {
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
  U.B = U.B_mean = two_means;
  U.M = root(b.systematic(), b.U_EVE / root_n);
  U.E = U.E_plus = U.E_minus = root(b.systematic(), two_means);
  U.R_plus = U.R_minus = k * b.U_EVE;
  U.R = root(U.R_plus, two_means);
  U.A = U.A_plus = U.A_minus = root(U.E, k * b.U_EVE);
  return U;
}

// Pa is M and U_j is |B_i|; Ps = 6 S and P with 3 S are the forms of k = 3.
VdiUncertainty vdi3441_uncertainty(const Budget& b, std::size_t n) {
  const Iso230Uncertainty iso = iso230_2_uncertainty(b, n, 3.0);
  return {iso.A, iso.M, iso.R_plus, iso.R_plus, iso.B, iso.B};
}

}  // namespace nonio::math
