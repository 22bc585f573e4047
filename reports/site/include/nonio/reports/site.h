// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "nonio/reports/history_value.h"
#include "nonio/reports/quantity_words.h"
#include "nonio/sdk/history.h"
#include "nonio/sdk/results.h"
#include "nonio/sdk/templates.h"

/// The pages of a laboratory: worklist and history of its machines. All values are inputs; the
/// pages compute nothing. Numbers are SI, dates "YYYY-MM-DD", uncertainties standard (k = 1), links
/// relative to index.html.
namespace nonio::reports {

/// A nonconforming or indeterminate value; `value` is empty if no result could be compared with the
/// limit.
struct OpenValue {
  std::string axis, quantity, campaign, measurement;
  std::optional<double> value{}, u{};
  double limit = 0.0;
  Quantity unit = Quantity::deviation;
  bool undecided = false;
  std::string state{};  ///< as-found, as-left or check; empty: not known
};

/// A line that requires one decision; lines are sorted by the cost of ignoring them.
struct WorkItem {
  enum class Kind { lost, failed, out, changed, soon, overdue, withheld, undecided, information };
  enum class State { fresh, known, fixed };
  Kind kind = Kind::information;
  State state = State::fresh;
  std::string id;  ///< constant over runs, for `nonio machine ack`
  std::string machine, axis, quantity;
  std::string campaign, customer;
  std::string measurement{};
  std::string of_state{};  ///< state of the machine at the value: as-found, as-left or check
  std::optional<double> value{}, u{}, limit{};
  Quantity unit = Quantity::deviation;
  Finding finding;      ///< texts: says, advice
  std::string since{};  ///< date of the run or campaign of first occurrence
  std::string link{};
  std::string by{}, until{}, why{};      ///< person, end and reason of an acknowledgment
  bool sure = true;                      ///< whether it is significant enough for an email
  std::vector<OpenValue> also{};         ///< other open values of the axis
  std::vector<std::string> campaigns{};  ///< all campaigns of a merged line
};

using nonio::HistoryChange;
using nonio::HistoryForecast;
using nonio::HistoryPoint;
using nonio::HistorySegment;
using nonio::HistorySeries;
using nonio::MachineEvent;

/// Mean deviation along an axis from one campaign.
struct ErrorCurve {
  std::string campaign, date, axis;
  bool rotary = false;
  std::vector<double> position, mean;
  double u = 0.0;  ///< standard uncertainty of a mean
};

/// Proposal for the next measurement; it changes nothing.
struct IntervalProposal {
  std::optional<int> months{};     ///< absent if refused, with the reason in `why`
  std::string method{};            ///< staircase, control-chart or fleet; empty if not required
  std::string axis{}, quantity{};  ///< the deciding quantity, if it is a single one
  Finding why{};                   ///< text: says
};

/// Comparison of a table with its prediction: for each axis, the result that differs most.
struct TableKept {
  std::string axis, quantity;
  std::string campaign, date;  ///< of the as-left state
  Quantity unit = Quantity::deviation;
  double found = 0.0, promised = 0.0, left = 0.0;
  bool good = true;
};

/// A change between two campaigns of an axis that is a table.
struct TableLoaded {
  std::string axis;
  std::string kind;           ///< loaded, removed, wrong-sign, twice, in-addition, offset
  std::string table;          ///< date of the source campaign, or the state in the machine record
  int points = 0;             ///< number of points of an offset
  std::string after, before;  ///< dates of both campaigns
  std::string after_campaign, before_campaign;
  Quantity unit = Quantity::deviation;
  double rms = 0.0, left = 0.0;  ///< RMS of the change; RMS not explained by the table; SI
  bool is_stated = false;        ///< whether campaigns or record state the table
};

struct MachineHistory {
  std::string id, maker, model, serial, customer, place, control;
  std::vector<MachineEvent> events;
  std::vector<HistorySeries> series;
  std::vector<ErrorCurve> curves;  ///< by date
  std::vector<TableLoaded> tables_loaded{};
  /// Campaign pairs between which a table may have been loaded, because `before_campaign` does not
  /// state the active table. `kind` is "unknown"; `rms` is 0 if no table explains more than half of
  /// the change.
  std::vector<TableLoaded> tables_unstated{};
  std::vector<TableKept> tables{};  ///< last one of each axis, if determinable
  std::string due{}, why_due{};     ///< date of next calibration; its stated interval, months
  IntervalProposal proposal{};      ///< proposed calibration interval
  std::string file{};               ///< page file name without folder
};

/// One month of a machine: the most severe line, and whether it was measured or had an event.
struct MonthOfMachine {
  std::string machine, month;  ///< YYYY-MM
  std::optional<WorkItem::Kind> gravest{};
  bool measured = false, event = false;
};

struct InstrumentUse {
  std::string name, certificate, valid_until;
  struct On {
    std::string campaign, date, machine, number, link;  ///< number: certificate number
  };
  std::vector<On> results;
};

/// One quantity of all machines of a model over about the same travel.
struct ModelComparison {
  std::string model, axis, quantity;
  Quantity unit = Quantity::deviation;
  struct Travel {
    double shortest = 0.0, longest = 0.0;
    bool rotary = false;
  };
  std::optional<Travel> travel{};     ///< for quantities along an axis
  std::size_t count = 0;              ///< number of machines
  double median = 0.0, spread = 0.0;  ///< of all machines; `spread` is the robust standard
                                      ///< deviation
  struct Of {
    std::string machine;
    double value = 0.0, u = 0.0;
    double z = 0.0;  ///< distance from the median in robust standard deviations
  };
  std::vector<Of> machines;  ///< by name; of very many, the most distant from the median
};

struct SiteHistory {
  std::uint64_t run = 0, campaigns = 0, done = 0, unchanged = 0;
  std::string date;
  std::uint64_t certificates = 0, waiting = 0;  ///< issued in this run; waiting for approval
  std::vector<WorkItem> lines;                  ///< in worklist order
  std::vector<MachineHistory> machines;         ///< by id
  std::vector<MonthOfMachine> months;
  std::vector<InstrumentUse> instruments;
  std::set<std::string> out_of_force{};  ///< numbers of certificates no longer in force
  std::vector<ModelComparison> comparisons;
  bool judged = true;      ///< whether some campaign states a limit
  std::size_t hidden = 0;  ///< lines excluded by the request
};

/// A text (says, advice) of a line, including titles of findings and names of campaigns.
std::string line_text(const Templates&, std::string_view language, const WorkItem&,
                      std::string_view part);

/// Whether the line requires action: new, and more than information.
bool asks(const WorkItem& line);
/// Whether the line requires action and is significant enough for an email.
bool asks_by_mail(const WorkItem& line);

/// Text for summary.txt and `nonio status --actions`: one line per action (at most `most`), then
/// the number of others by kind; if none, a sentence that states this.
Expected<std::string> worklist_text(const SiteHistory&, const Templates&,
                                    const std::string& language, std::size_t most);

inline constexpr const char* machines_folder = "machines";

/// Machines whose series index.html shows: those of the first lines.
std::vector<std::string> drawn_first(const SiteHistory&);

/// index.html, due.html, due.ics, instruments.html, compare.html, charts.js. Only series of `drawn_first` are
/// needed.
Expected<std::vector<Artifact>> site_lists(const SiteHistory&, const Templates&,
                                           const std::string& language);
/// The page shows all series of the machine, and its lines of `site`.
Expected<Artifact> machine_page_of(const SiteHistory& site, const MachineHistory&, const Templates&,
                                   const std::string& language);

/// All pages including machines/<file>; equal values give equal bytes.
Expected<std::vector<Artifact>> site_pages(const SiteHistory&, const Templates&,
                                           const std::string& language);

/// Residuals of one axis in several campaigns, in order of date, or of the parts of one campaign
/// that a machine made; one entry per reading, SI and degC. NaN: not known, or a reading that is not
/// used.
struct JointResiduals {
  std::string name, axis;
  bool rotary = false, angular = false;
  double noise = 0.0;                   ///< standard deviation of a reading, m or rad
  std::vector<std::string> campaigns;   ///< or the parts that a machine made
  std::vector<std::uint32_t> campaign;  ///< index of the campaign of each reading
  std::vector<double> position, time, temperature, residual;
  /// Only of parts that a machine made: number of the coordinate in the order of machining.
  std::optional<std::vector<double>> made_order{};
};

/// A page of its own with the residuals over position, time, temperature and order.
Expected<std::string> residuals_page(const std::vector<JointResiduals>&, const Templates&,
                                     const std::string& language);

}  // namespace nonio::reports
