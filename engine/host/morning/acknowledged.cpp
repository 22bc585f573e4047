// SPDX-License-Identifier: Apache-2.0
#include "host/morning/acknowledged.h"

#include <algorithm>
#include <cmath>

#include "host/morning/describe.h"

namespace nonio::host::morning {

using reports::MorningLine;

namespace {

/// A finding is named by the line's id, by the finding's, or by that without what follows a dash.
bool is_of(const config::Acknowledgement& a, const MorningLine& l) {
  const std::string& id = l.finding.id;
  return a.finding == l.id || a.finding == id || a.finding == id.substr(0, id.find('-', 8));
}

/// What somebody knew on a day, and its U.
struct Knew {
  double value = 0.0, U = 0.0;
};

std::optional<Knew> known_on(const AssessedMachine& m, const MorningLine& l,
                             const std::string& day) {
  std::optional<Knew> out;
  for (const history::StoredResult& r : m.stored.results) {
    if (r.axis != l.axis || r.quantity != l.quantity || quantity_of_unit(r.unit) != l.unit ||
        m.stored.campaigns[r.campaign].day > day)
      continue;
    const double u =
        r.followed ? r.u_repeat.value_or(0.0) : r.expanded.value_or(0.0) / r.k.value_or(2.0);
    out = Knew{r.value, 2.0 * u};
  }
  return out;
}

/// What has a forecast for its value does not move as readings do.
bool has_moved(const config::Acknowledgement& a, const AssessedMachine& m, const MorningLine& l) {
  if (!l.value || l.kind == MorningLine::Kind::soon) return false;
  const double now = *l.value * unit_of(l.unit).per_si;
  const auto then = known_on(m, l, a.date);
  if (!a.value && !then) return false;
  const double value = a.value.value_or(then ? then->value : 0.0);
  const double U = a.U.value_or(then ? then->U : 2.0 * l.u.value_or(0.0) * unit_of(l.unit).per_si);
  return std::fabs(now - value) > U;
}

/// Changes that a later campaign has shown.
bool is_later(const config::Acknowledgement& a, const MorningLine& l) {
  const auto before = std::find_if(l.finding.texts.begin(), l.finding.texts.end(),
                                   [](const auto& t) { return t.first == "before"; });
  return before != l.finding.texts.end() && before->second > a.date;
}

}  // namespace

void acknowledge(MorningLine& l, const AssessedMachine& m, const history::StoredLogs& logs,
                 const std::string& date) {
  if (l.state == MorningLine::State::fixed) return;
  for (const config::Acknowledgement& a : logs.acknowledged) {
    const auto alias = logs.aliases.find(a.machine);
    const std::string& machine = alias == logs.aliases.end() ? a.machine : alias->second;
    if (!is_of(a, l) || (!machine.empty() && machine != l.machine) ||
        (!a.axis.empty() && a.axis != l.axis) ||
        (!a.quantity.empty() && a.quantity != l.quantity) || a.until < date || a.date > date ||
        is_later(a, l) || has_moved(a, m, l))
      continue;
    l.state = MorningLine::State::known;
    l.by = a.by, l.until = a.until, l.why = a.why;
    return;
  }
}

}  // namespace nonio::host::morning
