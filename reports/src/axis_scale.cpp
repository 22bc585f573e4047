// SPDX-License-Identifier: Apache-2.0
#include "axis_scale.h"

#include <algorithm>
#include <cmath>

#include "nonio/sdk/format.h"

namespace nonio::reports {
namespace {

double round_step(double raw, Ticks ticks) {
  if (ticks == Ticks::whole) raw = std::max(raw, 1.0);
  if (ticks == Ticks::turn)
    for (const double step : {15.0, 30.0, 45.0, 60.0, 90.0, 180.0, 360.0})
      if (raw > 10.0 && raw <= step) return step;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double step : {1.0, 2.0, 2.5, 5.0})
    if ((step != 2.5 || power > 1 || ticks != Ticks::whole) && raw <= step * power * (1.0 + 1e-9))
      return step * power;
  return 10.0 * power;
}

std::string label(double value, double step, double largest, std::string_view language) {
  const bool plain = largest < 1e7 && step > 1e-6;
  int decimals = 0;
  for (double s = step; decimals < 9 && std::fabs(s - std::nearbyint(s)) > 1e-6 * s; s *= 10.0)
    ++decimals;
  std::string text =
      localised(plain ? fixed_text(value, decimals) : short_text(value, 3), language);
  for (std::size_t at = 0; (at = text.find('-', at)) != std::string::npos; at += 3)
    text.replace(at, 1, "\u2212");
  return text;
}

}  // namespace

AxisScale axis_scale(double low, double high, int count, Ticks ticks, std::string_view language) {
  AxisScale scale;
  const double largest = std::max(std::fabs(low), std::fabs(high));
  const double least = std::max(1e-3, 1e-6 * largest);  // smaller ranges would have equal labels
  if (high - low < least) {
    const double middle = low + (high - low) / 2;
    low = middle - least / 2;
    high = middle + least / 2;
  }
  scale.from = low;
  scale.to = high;
  const double step = round_step((high - low) / count, ticks);
  const double slack = 1e-6 * step;
  for (double k = std::ceil((low - slack) / step); k * step <= high + slack; ++k) {
    scale.ticks.push_back(k * step);
    scale.labels.push_back(label(k * step, step, largest, language));
  }
  return scale;
}

}  // namespace nonio::reports
