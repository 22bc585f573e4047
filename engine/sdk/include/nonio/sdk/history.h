// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "nonio/sdk/units.h"

/// The history of a machine over its campaigns. Numbers are SI, days "YYYY-MM-DD", uncertainties
/// standard (k = 1).
namespace nonio {

struct HistoryPoint {
  enum class State { as_found, as_left, check };
  std::string campaign, date, link;
  State state = State::as_found;
  double value = 0.0, u = 0.0;
  bool joined = true;
  std::string why_not{};  ///< reason why the point is not joined to the series
  /// Part of `u` that is common to campaigns: instrument, expansion coefficient.
  double u_common = 0.0;
};

/// Fitted model of a series between two days.
struct HistorySegment {
  std::string from, to;
  double first = 0.0, last = 0.0;      ///< fitted values at `from` and at `to`
  double u_first = 0.0, u_last = 0.0;  ///< standard uncertainties of `first` and `last`
  double slope = 0.0, u_slope = 0.0;   ///< change per year and its standard uncertainty
  std::string from_campaign{}, to_campaign{};
};

struct HistoryChange {
  /// Days of the last campaign before the change and of the first campaign after it.
  std::string after, before;
  double size = 0.0, u = 0.0, p = 1.0;  ///< p: p-value adjusted for all tests of the run
  std::string cause;                    ///< undeclared, event, instrument or table
  std::string event{};
  std::string after_campaign{}, before_campaign{};
  double p_alone = 1.0;  ///< p-value of this test without adjustment
  bool mailed = true;    ///< whether it is significant enough for an email

  /// Day of the campaign; with its id if both campaigns have the same day.
  std::string after_text() const { return day_text(after, after_campaign); }
  std::string before_text() const { return day_text(before, before_campaign); }
  std::string day_text(const std::string& day, const std::string& campaign) const {
    return after == before && !campaign.empty() ? day + " (" + campaign + ")" : day;
  }
};

struct HistoryForecast {
  std::string date;
  double value = 0.0, u = 0.0;
  double p_out = 0.0;
  /// Day on which the 95 % bound reaches the limit; empty without a limit, or if not within 20
  /// years.
  std::string leaves{};
  /// keep, watch, watch-now, act, overdue, passed (as overdue, but no date is stated), cannot-say,
  /// expected (no limit), or other-decides: within the limit, but another quantity of the axis may
  /// leave its own.
  std::string answer;
  /// Whether largest deviations themselves are extrapolated, which JSON does not contain.
  bool of_largest = false;
};

struct HistorySeries {
  std::string axis, quantity;
  Quantity unit = Quantity::deviation;
  std::vector<HistoryPoint> points;
  /// none, level, drift, step or walk (random walk); empty for a largest deviation.
  std::string model;
  std::vector<HistorySegment> segments{};
  std::vector<HistoryChange> changes{};
  std::optional<double> smallest_change{}, limit{};
  std::optional<HistoryForecast> forecast{};
  /// Whether later campaigns form a new series because they use another method.
  bool ended = false;
  /// Range of the axis over which the model compares campaigns with different targets; std::nullopt
  /// if points are compared directly. The points themselves are evaluated at their own targets.
  struct Over {
    double from = 0.0, to = 0.0;
  };
  std::optional<Over> compared_over{};
  std::string line{};  ///< measurement, if several lines of the axis are followed

  /// Quantity of positions of the axis.
  Quantity position() const {
    return unit == Quantity::angular_deviation || unit == Quantity::deviation_per_angle
               ? Quantity::angle
               : Quantity::length;
  }
};

struct MachineEvent {
  std::string date, axis, kind, text;
};

/// Difference between the value of a campaign and the previous value of its series. Common
/// contributions (one instrument under one certificate) are not part of `u`.
struct HistoryStep {
  std::string axis, quantity;
  std::size_t series = 0;
  std::string campaign;
  std::string before, before_date;  ///< campaign and day of the previous value
  std::size_t point = 0;            ///< index of the later value in the points of that series
  double size = 0.0, u = 0.0;
};

/// The history of a machine up to the day of a campaign. It does not depend on later campaigns, on
/// other machines or on the run.
struct HistorySoFar {
  std::string machine;  ///< empty if the campaign states no machine
  std::string day;      ///< day of the campaign; empty if not stated
  std::vector<std::string> aliases;
  /// Ids of the other campaigns in the history, by day, each with the digest of the results used.
  std::vector<std::pair<std::string, std::string>> campaigns;
  std::string sha256;  ///< digest of all inputs of this history
  std::vector<MachineEvent> events;
  std::vector<HistorySeries> series;  ///< series that contain a point of the campaign
  std::vector<HistoryStep> steps;     ///< steps to the points of the campaign
  /// Day of the next calibration according to the laboratory's rule; empty without a rule.
  std::string due;
  int months = 0;  ///< interval of that rule in months
};

}  // namespace nonio
