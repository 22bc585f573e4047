// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "laboratory/statistics/trend.h"

namespace nonio::statistics {

inline constexpr double keep_below = 0.05;  ///< limit of p_out for the answer keep

enum class Answer { keep, watch, act, cannot_say };

struct Forecast {
  double time = 0.0;
  double value = 0.0, u = 0.0;  ///< without the scatter of a campaign, with standard uncertainty
  double u_reading = 0.0;       ///< standard uncertainty of the next measured value
  double p_out = 0.0, p_read_out = 0.0;
  /// Time at which the 95 % bound first meets the limit, within 20 years after the last point.
  std::optional<double> leaves{};
  Answer answer = Answer::cannot_say;
};

/// Amount by which the quantity with the limit exceeds the absolute value of the series, such as
/// that of B = max |B_i| over |B_mean|, with standard deviation u.
struct Beyond {
  double value = 0.0, u = 0.0;
};

/// Forecasts a series at `time` (years). `limit` applies to the absolute value plus `beyond`. The
/// answer is keep for p_out below 5 % or without a limit, watch up to 50 %, otherwise act; act if
/// the last point is beyond the limit. It is cannot_say for fewer than three points or if `time` is
/// later than the last point by more than half of the time span. `u_new` is the u of the next
/// campaign, by default that of the last point. The three answers are based on ISO 14253-1 and
/// ILAC-G8 (general knowledge); the bounds of p_out are chosen for Nonio.
Forecast forecast(const Series&, const Trend&, double time, std::optional<double> limit,
                  std::optional<double> u_new = std::nullopt, Beyond beyond = {});

}  // namespace nonio::statistics
