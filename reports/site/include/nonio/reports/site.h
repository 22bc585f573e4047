// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "nonio/reports/history_value.h"
#include "nonio/reports/quantity_words.h"
#include "nonio/sdk/history.h"
#include "nonio/sdk/results.h"
#include "nonio/sdk/settings.h"

/// The pages of a laboratory: the worklist and the history of its machines. All values are inputs;
/// nothing is computed here. Numbers are SI, days "YYYY-MM-DD", uncertainties standard (k = 1),
/// links relative to index.html.
namespace nonio::reports {

/// A value that does not conform or is indeterminate; without `value` no result could be compared
/// with the limit.
struct OpenValue {
  std::string axis, quantity, campaign, measurement;
  std::optional<double> value{}, u{};
  double limit = 0.0;
  Quantity unit = Quantity::deviation;
  bool undecided = false;
};

/// One line requests one decision, in the order of what ignoring it costs.
struct WorkItem {
  enum class Kind { lost, failed, out, changed, soon, overdue, withheld, undecided, information };
  enum class State { fresh, known, fixed };
  Kind kind = Kind::information;
  State state = State::fresh;
  std::string id;  ///< the same in every run; `nonio machine ack` accepts it
  std::string machine, axis, quantity;
  std::string campaign, customer;
  std::string measurement{};  ///< of the value
  std::optional<double> value{}, u{}, limit{};
  Quantity unit = Quantity::deviation;
  Finding finding;      ///< its words: says, advice
  std::string since{};  ///< day of the run or campaign since which
  std::string link{};
  std::string by{}, until{}, why{};      ///< of an acknowledgement
  bool sure = true;                      ///< enough for a mail
  std::vector<OpenValue> also{};         ///< what else of the axis is open: every view lists it
  std::vector<std::string> campaigns{};  ///< all of a line that is one of several
};

using nonio::HistoryChange;
using nonio::HistoryForecast;
using nonio::HistoryPoint;
using nonio::HistorySegment;
using nonio::HistorySeries;
using nonio::MachineEvent;

/// Mean deviation along an axis, as one campaign found it.
struct ErrorCurve {
  std::string campaign, date, axis;
  bool rotary = false;
  std::vector<double> position, mean;
  double u = 0.0;  ///< of a mean
};

/// When to measure next. Nothing is changed by it.
struct IntervalProposal {
  std::optional<int> months{};     ///< none: refused, and `why` states why
  std::string method{};            ///< staircase, control-chart, fleet; empty: not required
  std::string axis{}, quantity{};  ///< what decides it, where it is one quantity
  Finding why{};                   ///< its words: says
};

/// Whether a table did what it promised: of one axis, the result that missed it by most.
struct TableKept {
  std::string axis, quantity;
  std::string campaign, date;  ///< in which it was left
  Quantity unit = Quantity::deviation;
  double found = 0.0, promised = 0.0, left = 0.0;
  bool good = true;
};

/// A change between two campaigns of an axis that is a table.
struct TableLoaded {
  std::string axis;
  std::string kind;   ///< loaded, removed, wrong-sign, twice, in-addition, offset
  std::string table;  ///< day of the campaign from which it was made, or of its state in the record
  int points = 0;     ///< of an offset
  std::string after, before;  ///< days
  std::string after_campaign, before_campaign;
  Quantity unit = Quantity::deviation;
  double rms = 0.0, left = 0.0;  ///< of the change, and of what the table does not explain; SI
  bool is_stated = false;        ///< the campaigns or the record state it
};

struct MachineHistory {
  std::string id, maker, model, serial, customer, place, control;
  std::vector<MachineEvent> events;
  std::vector<HistorySeries> series;
  std::vector<ErrorCurve> curves;  ///< by day
  std::vector<TableLoaded> tables_loaded{};
  /// Between which campaigns a table may have been loaded, because one of them (`before_campaign`)
  /// does not state what was active; kind "unknown". `rms` 0: no table explains more than half of it.
  std::vector<TableLoaded> tables_unstated{};
  std::vector<TableKept> tables{};  ///< the last one of each axis, where it can be determined
  std::string due{}, why_due{};     ///< next calibration; months that the site states
  IntervalProposal proposal{};      ///< of an interval
  std::string file{};               ///< name of its page, without the folder
};

/// Of one month: the gravest line, and whether something happened.
struct MonthOfMachine {
  std::string machine, month;  ///< YYYY-MM
  std::optional<WorkItem::Kind> gravest{};
  bool measured = false, event = false;
};

struct InstrumentUse {
  std::string name, certificate, valid_until;
  struct On {
    std::string campaign, date, machine, number, link;  ///< number: of the certificate
  };
  std::vector<On> results;
};

/// One quantity of all machines of a model, read over about the same travel.
struct ModelComparison {
  std::string model, axis, quantity;
  Quantity unit = Quantity::deviation;
  struct Travel {
    double shortest = 0.0, longest = 0.0;
    bool rotary = false;
  };
  std::optional<Travel> travel{};     ///< of quantities along an axis
  std::size_t count = 0;              ///< of machines
  double median = 0.0, spread = 0.0;  ///< of all; one robust standard deviation
  struct Of {
    std::string machine;
    double value = 0.0, u = 0.0;
    double z = 0.0;  ///< distance from the median in robust standard deviations
  };
  std::vector<Of> machines;  ///< by name; of very many those that are furthest from the median
};

struct SiteHistory {
  std::uint64_t run = 0, campaigns = 0, done = 0, unchanged = 0;
  std::string date;
  std::uint64_t certificates = 0, waiting = 0;  ///< issued in this run; waiting for release
  std::vector<WorkItem> lines;                  ///< in their order
  std::vector<MachineHistory> machines;         ///< by id
  std::vector<MonthOfMachine> months;
  std::vector<InstrumentUse> instruments;
  std::vector<ModelComparison> comparisons;
  bool judged = true;      ///< some campaign states a limit
  std::size_t hidden = 0;  ///< lines that are not in `lines`, because the request excludes them
};

/// A part (says, advice) of a line's words, in a language: with the titles of the findings that it
/// names, and the campaigns that it stands for.
std::string line_text(const Templates&, std::string_view language, const WorkItem&,
                      std::string_view part);

/// Whether it requires action: it is new, and more than a note.
bool asks(const WorkItem& line);
/// The same, and significant enough for a mail.
bool asks_by_mail(const WorkItem& line);

/// summary.txt and `nonio status --actions`: one line per action, at most `most`, then how many
/// more there are of each kind. Where there is none, the one sentence that states that.
Expected<std::string> worklist_text(const SiteHistory&, const Templates&,
                                    const std::string& language, std::size_t most);

inline constexpr const char* machines_folder = "machines";

/// Machines whose series index.html draws: those of the first lines.
std::vector<std::string> drawn_first(const SiteHistory&);

/// index.html, due.html, due.ics, instruments.html, compare.html. Of series they need those of
/// `drawn_first`.
Expected<std::vector<Artifact>> site_lists(const SiteHistory&, const Templates&,
                                           const std::string& language);
/// The page of one machine, with all its series; of `site` its lines.
Expected<Artifact> machine_page_of(const SiteHistory& site, const MachineHistory&, const Templates&,
                                   const std::string& language);

/// All of these, machines/<file> too. The same bytes for the same values.
Expected<std::vector<Artifact>> site_pages(const SiteHistory&, const Templates&,
                                           const std::string& language);

}  // namespace nonio::reports
