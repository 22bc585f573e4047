// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "nonio/sdk/units.h"

/// The history of a machine over its campaigns, as computed. Numbers are SI, days "YYYY-MM-DD",
/// uncertainties standard (k = 1).
namespace nonio {

struct HistoryPoint {
  enum class State { as_found, as_left, check };
  std::string campaign, date, link;
  State state = State::as_found;
  double value = 0.0, u = 0.0;
  bool joined = true;
  std::string why_not{};  ///< reason why the point is not joined to the series
  /// part of u shared with other campaigns: instrument, expansion coefficient
  double u_common = 0.0;
};

/// The fitted model of a series between two days.
struct HistorySegment {
  std::string from, to;
  double first = 0.0, last = 0.0;      ///< fitted values at `from` and at `to`
  double u_first = 0.0, u_last = 0.0;  ///< standard uncertainties of `first` and `last`
  double slope = 0.0, u_slope = 0.0;   ///< change per year
  std::string from_campaign{}, to_campaign{};
};

struct HistoryChange {
  std::string after, before;  ///< day of the last campaign before the change, and of the first one
                              ///< after it
  double size = 0.0, u = 0.0, p = 1.0;  ///< p: p-value adjusted for all tests of the run
  std::string cause;                    ///< undeclared, event, instrument, table
  std::string event{};
  std::string after_campaign{}, before_campaign{};
  double p_alone = 1.0;  ///< p-value of this test without adjustment
  bool mailed = true;    ///< whether it is significant enough to be sent by mail
};

struct HistoryForecast {
  std::string date;
  double value = 0.0, u = 0.0;
  double p_out = 0.0;
  /// day on which the 95 % bound meets the limit; empty: not within 20 years, or without a limit
  std::string leaves{};
  std::string answer;  ///< recommendation: keep, watch, act, overdue, cannot-say
};

struct HistorySeries {
  std::string axis, quantity;
  Quantity unit = Quantity::deviation;
  std::vector<HistoryPoint> points;
  /// none, level, drift, step or walk (random walk); empty for a largest deviation
  std::string model;
  std::vector<HistorySegment> segments{};
  std::vector<HistoryChange> changes{};
  std::optional<double> smallest_change{}, limit{};
  std::optional<HistoryForecast> forecast{};
  /// whether later campaigns use another method and therefore form a new series
  bool ended = false;
  /// Range of the axis over which the model compares campaigns with different targets; the points
  /// themselves are evaluated at their own targets. None: points are compared directly.
  struct Over {
    double from = 0.0, to = 0.0;
  };
  std::optional<Over> compared_over{};
};

struct MachineEvent {
  std::string date, axis, kind, text;
};

/// Difference between the value of one campaign and the previous value of its series. Contributions
/// shared by both (one instrument under one certificate) are not part of `u`.
struct HistoryStep {
  std::string axis, quantity;
  std::size_t series = 0;           ///< index into HistorySoFar::series
  std::string campaign;             ///< campaign of the later value
  std::string before, before_date;  ///< campaign and day of the previous value
  std::size_t point = 0;            ///< index of the later value into the points of that series
  double size = 0.0, u = 0.0;
};

/// The history of a machine up to the day of a campaign, for that campaign's documents. It does not
/// depend on later campaigns, on other machines or on the run.
struct HistorySoFar {
  std::string machine;  ///< name of the machine; empty: the campaign states none
  std::string day;      ///< day of the campaign; empty: not stated
  std::vector<std::string> aliases;
  /// Id of each other campaign used, by day, with the digest of its results that the history uses.
  std::vector<std::pair<std::string, std::string>> campaigns;
  std::string sha256;  ///< digest of all inputs of this history
  std::vector<MachineEvent> events;
  std::vector<HistorySeries> series;  ///< series that contain a point of the campaign
  std::vector<HistoryStep> steps;     ///< steps to the campaign's own points
  /// day of the next calibration according to the laboratory's rule; empty without a rule
  std::string due;
  int months = 0;  ///< interval of that rule in months
};

}  // namespace nonio
