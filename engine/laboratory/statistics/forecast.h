// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "laboratory/statistics/trend.h"

namespace nonio::statistics {

inline constexpr double keep_below = 0.05;  ///< probability of a value beyond the limit

enum class Answer { keep, watch, act, cannot_say };

struct Forecast {
  double time = 0.0;
  double value = 0.0, u = 0.0;  ///< of the machine's state
  double u_reading = 0.0;       ///< of what the next campaign will read
  double p_out = 0.0, p_read_out = 0.0;
  std::optional<double> leaves{};  ///< earliest time at which the 95 % bound meets the limit
  Answer answer = Answer::cannot_say;
};

/// By how much the quantity that has the limit is larger than the size of the one that is followed:
/// B = max |B_i| is never smaller than |B_mean|. Standard uncertainty u: how it varies.
struct Beyond {
  double value = 0.0, u = 0.0;
};

/// State x' b with u^2 = x' C x (+ walk dt). Limit: of the absolute value with what is beyond it.
/// Answers by P(out): below 5 % keep, up to 50 % watch, beyond it, or if the last point is out
/// already, act. Nothing is stated about fewer than three points or beyond half of their span (one
/// point on a day counts). Source: ISO 14253-1 and ILAC-G8 for the three answers (general
/// knowledge; the bounds are ours). u_new: of the next campaign; none: that of the last one.
Forecast forecast(const Series&, const Trend&, double time, std::optional<double> limit,
                  std::optional<double> u_new = std::nullopt, Beyond beyond = {});

}  // namespace nonio::statistics
