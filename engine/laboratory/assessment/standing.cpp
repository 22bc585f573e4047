// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/standing.h"

#include <algorithm>

#include "laboratory/assessment/acknowledged.h"
#include "laboratory/assessment/days.h"
#include "laboratory/assessment/describe.h"
#include "laboratory/assessment/lines_of_machine.h"
#include "laboratory/assessment/open_values.h"

namespace nonio::assessment {

using reports::MorningLine;

namespace {

constexpr const char* for_ever = "9999-12-31";

reports::MachineHistory without_series(const reports::MachineHistory& whole) {
  reports::MachineHistory out;
  out.id = whole.id, out.maker = whole.maker, out.model = whole.model, out.serial = whole.serial;
  out.customer = whole.customer, out.place = whole.place, out.control = whole.control;
  out.due = whole.due, out.why_due = whole.why_due, out.proposal = whole.proposal;
  out.file = whole.file;
  return out;
}

/// Overdue begins after the due date, what an event does on its own day; a forecast is worded
/// differently once its day has passed, and so is a line of what comes soon.
std::string same_until(const AssessedMachine& m, const reports::MachineHistory& described,
                       const std::vector<MorningLine>& lines, const std::string& date) {
  std::string until = for_ever;
  const auto before = [&](const std::string& day) {
    if (const auto number = day_number(day); number && day > date)
      until = std::min(until, day_text(*number - 1));
  };
  for (const config::Event& e : m.events) before(e.date);
  if (!described.due.empty() && described.due >= date) until = described.due;
  for (const reports::HistorySeries& s : described.series)
    if (s.forecast && s.forecast->date >= date) until = std::min(until, s.forecast->date);
  for (const MorningLine& l : lines)
    for (const auto& [name, text] : l.finding.texts)
      if (l.kind == MorningLine::Kind::soon && name == "leaves") before(text);
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
                     const store::StoredLogs& logs, const Tonight& tonight,
                     const std::filesystem::path& out) {
  Standing s;
  s.shown = without_series(described), s.compared = compared_of(m, described);
  s.alone = described.id.empty();
  s.name = described.id;
  if (s.alone && !m.stored.campaigns.empty()) s.name = m.stored.campaigns.back().id;
  s.lines = lines_of_machine(m, described, tonight);
  for (MorningLine& l : s.lines)
    if (l.link.empty() && !l.campaign.empty()) l.link = link_of(out, l.campaign);
  s.until = acknowledgements_of(described.id, logs).empty()
                ? same_until(m, described, s.lines, tonight.date)
                : tonight.date;
  for (std::size_t i = 0; i < s.lines.size(); ++i)  // what is not acknowledged comes last
    if (auto rest = acknowledge(s.lines[i], m, logs, tonight.date)) s.lines.push_back(*rest);
  s.months = months_of(m, described);
  s.instruments = instruments_of(m, out);
  s.has_results = !m.stored.results.empty();
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
    s.reversal = s.reversal || (severity == "attention" && id.starts_with("reversal."));
  }
  return s;
}

}  // namespace nonio::assessment
