// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/axis_statistics.h"

#include <algorithm>

#include "common/constants.h"
#include "nonio/math/statistics.h"

namespace nonio::math {
namespace {

AxisStatistics::Side side_of(std::span<const AxisTest::Reading> readings) {
  const std::vector<double> x = deviations(readings);
  AxisStatistics::Side side;
  side.n = x.size();
  side.mean = mean(x);
  side.s = standard_deviation(x);
  side.low = side.high = side.first = not_given;
  if (x.empty()) return side;
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  side.low = *low;
  side.high = *high;
  side.first = x.front();
  side.run = readings.front().run;
  return side;
}

}  // namespace

void Extent::put(double value) {
  known_ = known_ && !std::isnan(value);
  low_ = std::min(low_, value);
  high_ = std::max(high_, value);
}
double Extent::range() const { return given() ? high_ - low_ : not_given; }
double Extent::largest() const { return given() ? high_ : not_given; }
double Extent::smallest() const { return given() ? low_ : not_given; }

AxisStatistics axis_statistics(const AxisTest& test) {
  AxisStatistics out;
  out.targets.reserve(test.targets.size());
  for (std::size_t i = 0; i < test.targets.size(); ++i) {
    AxisStatistics::Target t;
    t.target = test.targets[i];
    t.plus = side_of(test.plus(i));
    t.minus = side_of(test.minus(i));
    t.mean = (t.plus.mean + t.minus.mean) / 2.0;
    t.B = t.plus.mean - t.minus.mean;
    out.targets.push_back(t);
  }
  return out;
}

Slopes slopes_of(const AxisStatistics& a) {
  const auto all = [&](auto n) {
    return std::all_of(a.targets.begin(), a.targets.end(), [&](const auto& t) { return n(t) > 0; });
  };
  const bool plus = all([](const auto&t) { return t.plus.n; }),
             minus = all([](const auto&t) { return t.minus.n; });
  if (a.targets.size() < 2 || (!plus && !minus)) return {not_given, not_given};
  const auto of = [&](const AxisStatistics::Target& t) {
    return plus && minus ? t.mean : plus ? t.plus.mean : t.minus.mean;
  };
  std::vector<double> x, y;
  for (const auto& t : a.targets) x.push_back(t.target), y.push_back(of(t));
  const double middle = mean(x), level = mean(y);
  double squares = 0.0, product = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    squares += (x[i] - middle) * (x[i] - middle);
    product += (x[i] - middle) * (y[i] - level);
  }
  return {product / squares, (y.back() - y.front()) / (x.back() - x.front())};
}

}  // namespace nonio::math
