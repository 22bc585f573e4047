// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "laboratory/statistics/trend.h"

namespace nonio::statistics {

inline constexpr double keep_below = 0.05;  ///< probability of a value beyond the limit below which
                                            ///< the answer is keep

enum class Answer { keep, watch, act, cannot_say };

struct Forecast {
  double time = 0.0;
  double value = 0.0, u = 0.0;  ///< predicted value of the machine without the scatter of a
                                ///< campaign, and its standard uncertainty
  double u_reading = 0.0;       ///< standard uncertainty of the value that the next campaign will
                                ///< measure
  double p_out = 0.0, p_read_out = 0.0;
  /// time, from the last point to 20 years later, at which the 95 % bound first meets the limit;
  /// none if it does not, or without a limit
  std::optional<double> leaves{};
  Answer answer = Answer::cannot_say;
};

/// Amount by which the quantity with the limit exceeds the absolute value of the quantity of the
/// series, for example B = max |B_i| exceeds |B_mean|. u: standard deviation of this amount.
struct Beyond {
  double value = 0.0, u = 0.0;
};

/// Forecasts a series at `time` (years). The state is x' b with u^2 = x' C x (plus walk dt).
/// `limit` applies to the absolute value plus `beyond`. The answer depends on p_out: below 5 %
/// keep, up to 50 % watch, above 50 % act; without a limit it is keep. It is act in any case if the
/// last point is beyond the limit. Otherwise it is cannot_say for fewer than three points, or if
/// `time` is later than the last point by more than half of their span. `u_new` is the u of the
/// next campaign; none: that of the last point. Source: ISO 14253-1 and ILAC-G8 for the three
/// answers (general knowledge; the bounds of p_out are chosen for Nonio).
Forecast forecast(const Series&, const Trend&, double time, std::optional<double> limit,
                  std::optional<double> u_new = std::nullopt, Beyond beyond = {});

}  // namespace nonio::statistics
