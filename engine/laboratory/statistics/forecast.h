// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "laboratory/statistics/trend.h"

namespace nonio::statistics {

inline constexpr double keep_below = 0.05;  ///< highest probability of a value beyond the limit
                                            ///< with the answer keep

enum class Answer { keep, watch, act, cannot_say };

struct Forecast {
  double time = 0.0;
  double value = 0.0, u = 0.0;  ///< state of the machine
  double u_reading = 0.0;       ///< uncertainty of the next campaign's reading
  double p_out = 0.0, p_read_out = 0.0;
  std::optional<double> leaves{};  ///< earliest time at which the 95 % bound meets the limit
  Answer answer = Answer::cannot_say;
};

/// Amount by which the quantity with the limit exceeds the absolute value of the followed one: B =
/// max |B_i| is never smaller than |B_mean|. u: standard deviation of this amount.
struct Beyond {
  double value = 0.0, u = 0.0;
};

/// Forecasts a series at `time` (years). The state is x' b with u^2 = x' C x (plus walk dt).
/// `limit` applies to the absolute value plus `beyond`. Answers by P(out): below 5 % keep, up to 50
/// % watch, above 50 % or if the last point is out already, act. The answer is cannot_say for fewer
/// than three points, or beyond half of their span (points on one day count once). Source: ISO
/// 14253-1 and ILAC-G8 for the three answers (general knowledge; the bounds are ours). `u_new`: u
/// of the next campaign; none: that of the last one.
Forecast forecast(const Series&, const Trend&, double time, std::optional<double> limit,
                  std::optional<double> u_new = std::nullopt, Beyond beyond = {});

}  // namespace nonio::statistics
