// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "nonio/sdk/units.h"

/// A machine over its campaigns, as it was computed. Numbers are SI, days "YYYY-MM-DD",
/// uncertainties standard (k = 1).
namespace nonio {

struct HistoryPoint {
  enum class State { as_found, as_left, check };
  std::string campaign, date, link;
  State state = State::as_found;
  double value = 0.0, u = 0.0;
  bool joined = true;
  std::string why_not{};  ///< it is not joined
  double u_common = 0.0;  ///< of what it shares with other campaigns: the instrument, the expansion
};

/// The model of a series between two days.
struct HistorySegment {
  std::string from, to;
  double first = 0.0, last = 0.0;      ///< at `from`, at `to`
  double u_first = 0.0, u_last = 0.0;  ///< of these
  double slope = 0.0, u_slope = 0.0;   ///< per year
  std::string from_campaign{}, to_campaign{};
};

struct HistoryChange {
  std::string after, before;            ///< days of the last campaign before it, the first after it
  double size = 0.0, u = 0.0, p = 1.0;  ///< p: adjusted for all tests of the run
  std::string cause;                    ///< undeclared, event, instrument, table
  std::string event{};
  std::string after_campaign{}, before_campaign{};
  double p_alone = 1.0;  ///< of this test alone
  bool mailed = true;    ///< significant enough for a mail
};

struct HistoryForecast {
  std::string date;
  double value = 0.0, u = 0.0;
  double p_out = 0.0;
  std::string leaves{};  ///< day on which the 95 % bound meets the limit; empty: never
  std::string answer;    ///< keep, watch, act, overdue, cannot-say
};

struct HistorySeries {
  std::string axis, quantity;
  Quantity unit = Quantity::deviation;
  std::vector<HistoryPoint> points;
  std::string model;  ///< none, level, drift, step, walk; empty of a largest deviation
  std::vector<HistorySegment> segments{};
  std::vector<HistoryChange> changes{};
  std::optional<double> smallest_change{}, limit{};
  std::optional<HistoryForecast> forecast{};
  bool ended = false;  ///< later campaigns measure it otherwise, in a series of their own
  /// Stretch of the axis over which its model compares campaigns that have other targets; the points
  /// are values of their own targets. None: as they are.
  struct Over {
    double from = 0.0, to = 0.0;
  };
  std::optional<Over> compared_over{};
};

struct MachineEvent {
  std::string date, axis, kind, text;
};

/// A value of one campaign less the one before it in its series. What both have in common (one
/// instrument under one certificate) is not in `u`.
struct HistoryStep {
  std::string axis, quantity;
  std::size_t series = 0;           ///< index into HistorySoFar::series
  std::string campaign;             ///< of the value
  std::string before, before_date;  ///< campaign and day of the one before it
  std::size_t point = 0;            ///< index into that series' points
  double size = 0.0, u = 0.0;
};

/// The history of a machine up to the day of a campaign, for its documents. It depends on nothing
/// later, on no other machine and on no run.
struct HistorySoFar {
  std::string machine;               ///< its name; empty: the campaign names none
  std::string day;                   ///< of the campaign; empty: it has none
  std::vector<std::string> aliases;  ///< other names of the machine
  /// The other campaigns that it is made from, by day: id, and digest of what the history has of
  /// their results.
  std::vector<std::pair<std::string, std::string>> campaigns;
  std::string sha256;  ///< of all that it is made from
  std::vector<MachineEvent> events;
  std::vector<HistorySeries> series;  ///< those that the campaign has a point of
  std::vector<HistoryStep> steps;     ///< of the campaign's own points
  std::string due;                    ///< next calibration by a rule; empty: there is no rule
  int months = 0;                     ///< that rule's
};

}  // namespace nonio
