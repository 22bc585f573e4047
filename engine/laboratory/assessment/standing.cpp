// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/standing.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "laboratory/assessment/days.h"
#include "laboratory/assessment/describe.h"
#include "laboratory/assessment/lines_of_machine.h"
#include "laboratory/assessment/open_values.h"
#include "laboratory/assessment/series.h"
#include "nonio/reports/site.h"

namespace nonio::assessment {

using reports::WorkItem;

namespace {

/// An acknowledgement names a line by its id, by the id of the finding, or by this id without the
/// suffix after the first dash.
bool is_of(const config::Acknowledgement& a, const WorkItem& l) {
  const std::string& id = l.finding.id;
  return a.finding == l.id || a.finding == id || a.finding == id.substr(0, id.find('-', 8));
}

struct Knew {
  double value = 0.0, U = 0.0;
};

std::optional<Knew> known_on(const AssessedMachine& m, const WorkItem& l, const std::string& day) {
  std::optional<Knew> out;
  for (const store::StoredResult& r : m.stored.results) {
    if (r.axis != l.axis || r.quantity != l.quantity || quantity_of_unit(r.unit) != l.unit ||
        m.stored.campaigns[r.campaign].day > day)
      continue;
    const double u =
        r.followed ? r.u_repeat.value_or(0.0) : r.expanded.value_or(0.0) / r.k.value_or(2.0);
    out = Knew{r.value, 2.0 * u};
  }
  return out;
}

/// Whether the value has changed by more than U since the acknowledgement. An acknowledged forecast
/// is accepted until the stated date.
bool has_moved(const config::Acknowledgement& a, const AssessedMachine& m, const WorkItem& l) {
  if (!l.value || l.kind == WorkItem::Kind::soon) return false;
  const double now = *l.value * unit_of(l.unit).per_si;
  const auto then = known_on(m, l, a.date);
  if (!a.value && !then) return false;
  const double value = a.value.value_or(then ? then->value : 0.0);
  const double U = a.U.value_or(then ? then->U : 2.0 * l.u.value_or(0.0) * unit_of(l.unit).per_si);
  return std::fabs(now - value) > U;
}

bool is_of_quantity(const config::Acknowledgement& a, const std::string& quantity) {
  return a.quantity.empty() || a.quantity == quantity;
}

/// Whether the value did not conform or was indeterminate at the acknowledgement and has changed by
/// at most U since.
bool was_known(const config::Acknowledgement& a, const AssessedMachine& m, const WorkItem& l,
               const reports::OpenValue& v) {
  if (a.finding != l.id && !is_of_quantity(a, v.quantity)) return false;
  if (!v.value)
    for (const auto& limit : m.stored.without_value)
      if (limit.axis == v.axis && limit.quantity == v.quantity &&
          m.stored.campaigns[limit.campaign].day <= a.date)
        return true;
  bool open = false;
  Knew knew;
  for (const store::StoredResult& r : m.stored.results) {
    if (r.followed || r.axis != v.axis || r.quantity != v.quantity ||
        (v.axis.empty() && r.measurement != v.measurement) || quantity_of_unit(r.unit) != v.unit ||
        m.stored.campaigns[r.campaign].day > a.date)
      continue;
    open = r.decision == does_not_conform ||
           (v.undecided && !r.decision.empty() && r.decision != conforms);
    knew = {r.value, 2.0 * r.expanded.value_or(0.0) / r.k.value_or(2.0)};
  }
  return open && v.value && std::fabs(*v.value * unit_of(v.unit).per_si - knew.value) <= knew.U;
}

WorkItem line_of_rest(const WorkItem& known, std::vector<reports::OpenValue> rest) {
  const auto first = std::find_if(rest.begin(), rest.end(),
                                  [](const reports::OpenValue& v) { return !v.undecided; });
  if (first != rest.end()) std::rotate(rest.begin(), first, first + 1);
  const reports::OpenValue& v = rest.front();
  const char* finding = !v.value      ? "worklist.no-value"
                        : v.undecided ? (v.u ? "worklist.undecided" : "worklist.no-uncertainty")
                                      : "worklist.out";
  WorkItem l = line_of(v.undecided ? WorkItem::Kind::undecided : WorkItem::Kind::out, finding,
                       known.id.substr(known.id.find(':') + 1) + ":" + v.quantity);
  l.machine = known.machine, l.customer = known.customer, l.link = known.link;
  l.since = known.since;
  l.axis = v.axis, l.quantity = v.quantity, l.campaign = v.campaign, l.measurement = v.measurement;
  l.of_state = v.state, l.value = v.value, l.u = v.u, l.limit = v.limit, l.unit = v.unit;
  l.finding.evidence = {{"limit", v.limit, v.unit}};
  l.also.assign(rest.begin() + 1, rest.end());
  return l;
}

bool is_later(const config::Acknowledgement& a, const WorkItem& l) {
  const auto before = std::find_if(l.finding.texts.begin(), l.finding.texts.end(),
                                   [](const auto& t) { return t.first == "before"; });
  return before != l.finding.texts.end() && before->second.substr(0, a.date.size()) > a.date;
}

/// Marks an acknowledged line as known until the stated date, unless a later campaign showed the
/// change or the value has changed by more than U. Values in `also` that are not acknowledged are
/// returned as a new line.
std::optional<WorkItem> acknowledge(WorkItem& l, const AssessedMachine& m,
                                    const store::StoredLogs& logs, const std::string& date) {
  if (l.state == WorkItem::State::fixed) return std::nullopt;
  for (const config::Acknowledgement& a : logs.acknowledged) {
    const auto alias = logs.aliases.find(a.machine);
    const std::string& machine = alias == logs.aliases.end() ? a.machine : alias->second;
    if (!is_of(a, l) || (!machine.empty() && machine != l.machine) ||
        (!a.axis.empty() && a.axis != l.axis) || !is_of_quantity(a, l.quantity) || a.until < date ||
        a.date > date || is_later(a, l) || has_moved(a, m, l))
      continue;
    l.state = WorkItem::State::known;
    l.by = a.by, l.until = a.until, l.why = a.why;
    const auto rest =
        std::stable_partition(l.also.begin(), l.also.end(),
                              [&](const reports::OpenValue& v) { return was_known(a, m, l, v); });
    if (rest == l.also.end()) return std::nullopt;
    WorkItem anew = line_of_rest(l, {rest, l.also.end()});
    l.also.erase(rest, l.also.end());
    return anew;
  }
  return std::nullopt;
}

constexpr const char* for_ever = "9999-12-31";

reports::MachineHistory without_series(const reports::MachineHistory& whole) {
  reports::MachineHistory out;
  out.id = whole.id, out.maker = whole.maker, out.model = whole.model, out.serial = whole.serial;
  out.customer = whole.customer, out.place = whole.place, out.control = whole.control;
  out.due = whole.due, out.why_due = whole.why_due, out.proposal = whole.proposal;
  out.file = whole.file;
  return out;
}

std::string same_until(const AssessedMachine& m, const reports::MachineHistory& described,
                       const std::vector<WorkItem>& lines, const std::string& date) {
  std::string until = for_ever;
  const auto before = [&](const std::string& day) {
    if (const auto number = day_number(day); number && day > date)
      until = std::min(until, day_text(*number - 1));
  };
  for (const config::Event& e : m.events) before(e.date);
  if (!described.due.empty() && described.due >= date) until = described.due;
  for (const reports::HistorySeries& s : described.series)
    if (s.forecast && s.forecast->date >= date) until = std::min(until, s.forecast->date);
  for (const WorkItem& l : lines)
    for (const auto& [name, text] : l.finding.texts)
      if (l.kind == WorkItem::Kind::soon && name == "leaves") before(text);
  return until;
}

}  // namespace

std::vector<const config::Acknowledgement*> acknowledgements_of(const std::string& machine,
                                                                const store::StoredLogs& logs) {
  std::vector<const config::Acknowledgement*> out;
  for (const config::Acknowledgement& a : logs.acknowledged) {
    const auto alias = logs.aliases.find(a.machine);
    const std::string& name = alias == logs.aliases.end() ? a.machine : alias->second;
    if (name.empty() || name == machine) out.push_back(&a);
  }
  return out;
}

Standing standing_of(const AssessedMachine& m, const reports::MachineHistory& described,
                     const store::StoredLogs& logs, const LastRun& last_run,
                     const std::filesystem::path& out) {
  Standing s;
  s.shown = without_series(described), s.compared = compared_of(m, described);
  s.alone = described.id.empty();
  s.name = described.id;
  if (s.alone && !m.stored.campaigns.empty()) s.name = m.stored.campaigns.back().id;
  s.lines = lines_of_machine(m, described, last_run);
  for (WorkItem& l : s.lines)
    if (l.link.empty() && !l.campaign.empty()) l.link = link_of(out, l.campaign);
  s.until = acknowledgements_of(described.id, logs).empty()
                ? same_until(m, described, s.lines, last_run.date)
                : last_run.date;
  for (std::size_t i = 0; i < s.lines.size(); ++i)
    if (auto rest = acknowledge(s.lines[i], m, logs, last_run.date)) s.lines.push_back(*rest);
  s.months = months_of(m, described, s.lines);
  s.instruments = instruments_of(m, out);
  s.has_campaigns = !m.stored.campaigns.empty();
  s.judged = !m.stored.without_value.empty();
  s.conforms = open_limits(m.stored).empty();
  for (const ShownSeries& shown : m.shown) {
    if (shown.ended) continue;
    s.judged = s.judged || !shown.judged.empty();
    s.conforms = s.conforms && open_results(m.stored, shown).empty();
  }
  if (m.stored.findings.empty()) return s;
  for (const auto& [id, severity] : m.stored.findings.back()) {
    s.attention = s.attention || severity == "attention";
    if (id == "reading.suspect") s.misread = m.stored.campaigns.back().id;
    s.reversal = s.reversal || (severity == "attention" && id.starts_with("reversal."));
  }
  return s;
}

}  // namespace nonio::assessment
