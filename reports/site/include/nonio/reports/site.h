// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "nonio/sdk/results.h"
#include "nonio/sdk/settings.h"

/// The pages of a laboratory: the morning and the history of its machines. What they show was
/// computed elsewhere; here nothing is. Numbers are SI, days "YYYY-MM-DD", uncertainties standard
/// (k = 1), links relative to index.html.
namespace nonio::reports {

/// One line asks for one decision, in the order of what ignoring it costs.
struct MorningLine {
  enum class Kind { lost, failed, out, changed, soon, overdue, undecided, information };
  enum class State { fresh, known, fixed };
  Kind kind = Kind::information;
  State state = State::fresh;
  std::string id;  ///< the same every night; `nonio ack` takes it
  std::string machine, axis, quantity;
  std::string campaign, customer;
  std::optional<double> value{}, u{}, limit{};
  Quantity unit = Quantity::deviation;
  Finding finding;      ///< its words: says, advice
  std::string since{};  ///< the night or campaign's day from which on
  std::string link{};
  std::string by{}, until{}, why{};  ///< of an acknowledgement
};

struct HistoryPoint {
  enum class State { as_found, as_left, check };
  std::string campaign, date, link;
  State state = State::as_found;
  double value = 0.0, u = 0.0;
  bool joined = true;
  std::string why_not{};  ///< it is not joined
};

/// What the model of a series says between two days.
struct HistorySegment {
  std::string from, to;
  double first = 0.0, last = 0.0;      ///< at `from`, at `to`
  double u_first = 0.0, u_last = 0.0;  ///< of these
  double slope = 0.0, u_slope = 0.0;   ///< per year
};

struct HistoryChange {
  std::string after, before;            ///< days of the last campaign before it, the first after it
  double size = 0.0, u = 0.0, p = 1.0;  ///< p: adjusted for all that was asked
  std::string cause;                    ///< undeclared, event, instrument, table
  std::string event{};
};

struct HistoryForecast {
  std::string date;
  double value = 0.0, u = 0.0;
  double p_out = 0.0;
  std::string leaves{};  ///< day on which the 95 % bound meets the limit; empty: never
  std::string answer;    ///< keep, watch, act, cannot-say
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
};

struct MachineEvent {
  std::string date, axis, kind, text;
};

/// Mean deviation along an axis, as one campaign found it.
struct ErrorCurve {
  std::string campaign, date, axis;
  bool rotary = false;
  std::vector<double> position, mean;
  double u = 0.0;  ///< of a mean
};

struct MachineHistory {
  std::string id, maker, model, serial, customer, place, control;
  std::vector<MachineEvent> events;
  std::vector<HistorySeries> series;
  std::vector<ErrorCurve> curves;  ///< by day
  std::string due{}, why_due{};    ///< next calibration; which rule says so
  std::string proposal{};          ///< of another interval, in words
  std::string file{};              ///< name of its page, without the folder
};

/// Of one month: the gravest line, and whether something happened.
struct MonthOfMachine {
  std::string machine, month;  ///< YYYY-MM
  std::optional<MorningLine::Kind> gravest{};
  bool measured = false, event = false;
};

struct InstrumentUse {
  std::string name, certificate, valid_until;
  struct On {
    std::string campaign, date, machine, number, link;  ///< number: of the certificate
  };
  std::vector<On> results;
};

/// One quantity of all machines of a model.
struct ModelComparison {
  std::string model, axis, quantity;
  Quantity unit = Quantity::deviation;
  struct Of {
    std::string machine;
    double value = 0.0, u = 0.0;
    double z = 0.0;  ///< distance from the median in robust standard deviations
  };
  std::vector<Of> machines;
};

struct SiteHistory {
  std::uint64_t night = 0, campaigns = 0, done = 0, unchanged = 0;
  std::string date;
  std::uint64_t certificates = 0, waiting = 0;  ///< issued tonight; waiting for release
  std::vector<MorningLine> lines;               ///< in their order
  std::vector<MachineHistory> machines;         ///< by id
  std::vector<MonthOfMachine> months;
  std::vector<InstrumentUse> instruments;
  std::vector<ModelComparison> comparisons;
  bool judged = true;  ///< some campaign states a limit
};

/// index.html, machines/<file>, due.html, due.ics, instruments.html, compare.html. The same bytes
/// for the same values.
Expected<std::vector<Artifact>> site_pages(const SiteHistory&, const Templates&,
                                           const std::string& language);

}  // namespace nonio::reports
