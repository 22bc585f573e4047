// SPDX-License-Identifier: Apache-2.0
//
// Errors shared by a pass cancel in the difference of two readings of the pass one turn apart. A
// drift within the passes has opposite signs in the two directions and cancels as well. With one
// pass in each direction the scatter is not known, and nothing is reported.
#include <cmath>
#include <map>
#include <vector>

#include "common/constants.h"
#include "common/finding_builder.h"
#include "nonio/math/axis_findings.h"
#include "nonio/math/distributions.h"
#include "nonio/math/statistics.h"

namespace nonio::math {
namespace {

constexpr double same_place = 1e-6;  // rad, tolerance for nominal positions

struct Pair {
  std::size_t earlier, later;
};

std::vector<Pair> pairs_a_turn_apart(const AxisTest& test) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0, j = 0; i < test.targets.size(); ++i) {
    while (j < test.targets.size() && test.targets[j] < test.targets[i] + full_turn - same_place)
      ++j;
    if (j < test.targets.size() && test.targets[j] <= test.targets[i] + full_turn + same_place)
      pairs.push_back({i, j});
  }
  return pairs;
}

// Returns the mean of x(later) - x(earlier), rad, of each pass of one direction.
std::vector<double> gaps(const AxisTest& test, const std::vector<Pair>& pairs, bool minus) {
  struct Sum {
    double sum = 0.0, n = 0.0;
  };
  std::map<std::uint32_t, Sum> by_run;
  for (const Pair& pair : pairs) {
    const auto earlier = minus ? test.minus(pair.earlier) : test.plus(pair.earlier);
    const auto later = minus ? test.minus(pair.later) : test.plus(pair.later);
    for (std::size_t a = 0, b = 0; a < earlier.size() && b < later.size();) {
      if (earlier[a].run != later[b].run) {
        ++(earlier[a].run < later[b].run ? a : b);
        continue;
      }
      Sum& sum = by_run[earlier[a].run];
      sum.sum += later[b++].deviation - earlier[a++].deviation;
      sum.n += 1.0;
    }
  }
  std::vector<double> out;
  for (const auto& [run, sum] : by_run) out.push_back(sum.sum / sum.n);
  return out;
}

}  // namespace

void turn_findings(const AxisTest& test, std::vector<Finding>& findings) {
  if (!test.rotary) return;
  const auto pairs = pairs_a_turn_apart(test);
  if (pairs.empty()) return;
  double sum = 0.0, directions = 0.0, squares = 0.0, dof = 0.0, weight = 0.0;
  for (const bool minus : {false, true}) {
    const auto g = gaps(test, pairs, minus);
    if (g.empty()) continue;
    const double n = static_cast<double>(g.size()), middle = mean(g);
    for (const double one : g) squares += (one - middle) * (one - middle);
    sum += middle, directions += 1.0, dof += n - 1.0, weight += 1.0 / n;
  }
  if (!(dof > 0.0)) return;
  const double gap = sum / directions;
  const double u = std::sqrt(squares / dof * weight) / directions;
  const double p = t_two_sided(test_ratio(gap, u), dof);
  if (!(std::fabs(gap) > rounding) || !significant(p, significance)) return;
  findings.push_back(FindingBuilder("rotary.not-closed", matters(test, std::fabs(gap)), true)
                         .position("from", test.targets[pairs.front().earlier])
                         .position("to", test.targets[pairs.front().later])
                         .deviation("gap", gap)
                         .deviation("u", u)
                         .number("p", p, Quantity::probability)
                         .done());
}

}  // namespace nonio::math
