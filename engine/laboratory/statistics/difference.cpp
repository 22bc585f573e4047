// SPDX-License-Identifier: Apache-2.0
#include "laboratory/statistics/difference.h"

#include <cmath>
#include <map>

#include "laboratory/statistics/gls.h"
#include "laboratory/statistics/trend.h"
#include "nonio/math/distributions.h"

namespace nonio::statistics {
namespace {

std::map<std::string, double> left_of_common(const Point& before, const Point& after) {
  std::map<std::string, double> out;
  for (const Common& c : before.common) out[c.source] -= c.u;
  for (const Common& c : after.common) out[c.source] += c.u;
  return out;
}

}  // namespace

Expected<Difference> difference(const Point& before, const Point& after, double expected,
                                double u_expected) {
  Series both;
  both.points = {before, after};
  both.points[1].time = both.points[0].time;
  if (auto sound = check(both); !sound) return fail(sound.error());
  if (!std::isfinite(expected) || !std::isfinite(u_expected) || u_expected < 0.0)
    return fail("expected a difference and its uncertainty, found what is not a number");
  double variance = before.u * before.u + after.u * after.u + u_expected * u_expected;
  for (const auto& [source, u] : left_of_common(before, after)) variance += u * u;
  Difference out{after.value - before.value - expected, std::sqrt(variance), 1.0};
  out.p = normal_two_sided(out.zeta());
  return out;
}

Expected<TableCheck> check_table(const Point& as_found, const Point& as_left, double promised,
                                 double u_promised) {
  NONIO_TRY(const auto compared, difference(as_found, as_left, promised, u_promised));
  TableCheck out{compared};
  out.as_promised = !(compared.p < named_below);
  double variance = as_found.u * as_found.u;
  for (const Common& c : as_found.common) variance += c.u * c.u;
  if (std::fabs(as_found.value) > 2.0 * std::sqrt(variance))
    out.taken = 1.0 - std::fabs(as_left.value) / std::fabs(as_found.value);
  return out;
}

}  // namespace nonio::statistics
