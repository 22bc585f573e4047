// SPDX-License-Identifier: Apache-2.0
#include "host/morning/lines_of_machine.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "host/morning/describe.h"
#include "host/morning/lines.h"

namespace nonio::host::morning {

using reports::HistoryChange;
using reports::HistorySeries;
using reports::MorningLine;
using Kind = MorningLine::Kind;

namespace {

constexpr const char* conforms = "conforms";
constexpr const char* does_not_conform = "does not conform";

/// A change of one axis, with all quantities in which it is seen.
struct AxisChange {
  std::string after, before;  ///< days
  struct Seen {
    const HistorySeries* series = nullptr;
    const HistoryChange* change = nullptr;
    double size() const { return std::fabs(change->size) / change->u; }
  };
  std::vector<Seen> seen;  ///< the largest first
  bool told = false;       ///< in the line of what does not conform
};

bool is_mended(const HistoryChange& c) {
  return c.cause == "table" || c.event.starts_with("repair") || c.event.starts_with("compensation");
}

class OfMachine {
 public:
  OfMachine(const AssessedMachine& m, const reports::MachineHistory& d, const Tonight& tonight)
      : m_(m), d_(d), tonight_(tonight) {}

  std::vector<MorningLine> lines() {
    causes_by_axis();
    judged();
    for (const auto& [axis, all] : causes_)
      for (const AxisChange& cause : all)
        if (!cause.told) add(changed(axis, cause));
    tables();
    soon();
    overdue();
    later();
    instruments();
    return std::move(out_);
  }

 private:
  MorningLine line(Kind kind, const char* finding, const std::string& of) const {
    MorningLine l = line_of(kind, finding, d_.id + (of.empty() ? "" : ":" + of));
    l.machine = d_.id;
    l.customer = d_.customer;
    l.link = "machines/" + d_.file;
    return l;
  }

  void add(MorningLine l) { out_.push_back(std::move(l)); }

  // ---- what changed

  /// The changes of each axis that nobody has mended since.
  void causes_by_axis() {
    for (const HistorySeries& s : d_.series) {
      std::string mended;
      for (const HistoryChange& c : s.changes)
        if (is_mended(c)) mended = std::max(mended, c.before);
      for (const HistoryChange& c : s.changes)
        if (c.cause != "instrument" && !is_mended(c) && c.before > mended &&
            !is_repaired(s.axis, c.before))
          put_change(axis_of(s.axis, s.quantity), s, c);
    }
    for (auto& [axis, all] : causes_)
      for (AxisChange& cause : all)
        std::stable_sort(cause.seen.begin(), cause.seen.end(),
                         [](const auto& a, const auto& b) { return a.size() > b.size(); });
  }

  /// Somebody has said that this axis was repaired or compensated after that campaign. What is
  /// planned has mended nothing yet.
  bool is_repaired(const std::string& axis, const std::string& after) const {
    return std::any_of(m_.events.begin(), m_.events.end(), [&](const config::Event& e) {
      return (e.kind == "repair" || e.kind == "compensation") && e.date > after &&
             e.date <= tonight_.date && (e.axis.empty() || axis.empty() || e.axis == axis);
    });
  }

  void put_change(const std::string& axis, const HistorySeries& s, const HistoryChange& c) {
    // Not all quantities are in all campaigns: what overlaps is one cause.
    for (AxisChange& cause : causes_[axis])
      if (c.after < cause.before && c.before > cause.after) {
        cause.after = std::max(cause.after, c.after);
        cause.before = std::min(cause.before, c.before);
        cause.seen.push_back({&s, &c});
        return;
      }
    causes_[axis].push_back({c.after, c.before, {{&s, &c}}});
  }

  /// Size, days, what it is and where to look.
  void describe(MorningLine& l, const AxisChange& cause) const {
    const AxisChange::Seen& first = cause.seen.front();
    const Quantity q = first.series->unit;
    l.finding.evidence.push_back({"size", first.change->size, q});
    l.finding.evidence.push_back({"U", 2.0 * first.change->u, q});
    l.finding.evidence.push_back({"p", first.change->p, Quantity::probability});
    put_text(l, "after", cause.after);
    put_text(l, "before", cause.before);
    put_text(l, "what", kind_of(first.series->quantity));
    put_text(l, "look", kind_of(first.series->quantity));
    std::string event;
    for (const AxisChange::Seen& s : cause.seen)
      if (event.empty()) event = s.change->event;
    if (!event.empty()) put_text(l, "event", event);
    std::string also;
    for (std::size_t i = 1; i < cause.seen.size(); ++i)
      also += (also.empty() ? "" : ", ") + cause.seen[i].series->quantity;
    if (!also.empty()) put_text(l, "also", also);
  }

  static bool has_event(const AxisChange& cause) {
    return std::any_of(cause.seen.begin(), cause.seen.end(),
                       [](const AxisChange::Seen& s) { return !s.change->event.empty(); });
  }

  MorningLine changed(const std::string& axis, const AxisChange& cause) const {
    const AxisChange::Seen& first = cause.seen.front();
    MorningLine l =
        line(Kind::changed, has_event(cause) ? "morning.changed-event" : "morning.changed", "");
    l.id = "morning.changed:" + d_.id + ":" + axis + ":" + cause.before;
    l.axis = axis;
    l.quantity = first.series->quantity;
    l.unit = first.series->unit;
    l.campaign = first.change->before_campaign;
    l.since = cause.before;
    if (!first.series->points.empty()) {
      l.value = first.series->points.back().value;
      l.u = first.series->points.back().u;
      l.limit = first.series->limit;
    }
    l.sure = std::any_of(cause.seen.begin(), cause.seen.end(),
                         [](const AxisChange::Seen& s) { return s.change->mailed; });
    describe(l, cause);
    return l;
  }

  // ---- limits

  /// What was not measured along one axis is one matter for each analysis: a circle, a spindle.
  const std::string& place_of(const ShownSeries& s) const {
    return s.axis.empty() ? m_.stored.results[s.judged.back()].source : s.axis;
  }

  /// Of each axis: the worst of what does not conform, or what cannot be decided.
  void judged() {
    std::map<std::string, std::vector<const ShownSeries*>> out, open, good, anew;
    for (const ShownSeries& s : m_.shown) {
      const history::StoredResult& last = m_.stored.results[s.judged.back()];
      if (!last.tolerance || s.ended) continue;
      const std::string& of = place_of(s);
      if (last.decision == does_not_conform)
        out[of].push_back(&s);
      else if (!last.decision.empty() && last.decision != conforms)
        open[of].push_back(&s);
      else if (is_fixed(s))
        (is_judged_alike(s) ? good : anew)[of].push_back(&s);
    }
    for (auto& [axis, all] : out) add(beyond(axis, all));
    for (auto& [axis, all] : open)
      if (!out.contains(axis)) add(limit_line(Kind::undecided, "morning.undecided", all));
    for (auto& [axis, all] : good)
      if (!out.contains(axis)) add_fixed("morning.fixed", all);
    for (auto& [axis, all] : anew)
      if (!out.contains(axis) && !good.contains(axis)) add_fixed("morning.judged-anew", all);
  }

  void add_fixed(const char* finding, std::vector<const ShownSeries*>& all) {
    add(limit_line(Kind::out, finding, all));
    out_.back().state = MorningLine::State::fixed;
  }

  /// By the same definition, against no wider limit: then it is the machine that is better.
  bool is_judged_alike(const ShownSeries& s) const {
    const auto& last = m_.stored.results[s.judged.back()];
    const auto& before = m_.stored.results[s.judged[s.judged.size() - 2]];
    return last.source == before.source && last.conditions == before.conditions &&
           last.tolerance <= before.tolerance;
  }

  bool is_fixed(const ShownSeries& s) const {
    if (s.judged.size() < 2) return false;
    const auto& last = m_.stored.results[s.judged.back()];
    const auto& before = m_.stored.results[s.judged[s.judged.size() - 2]];
    return last.decision == conforms && before.decision == does_not_conform &&
           m_.stored.campaigns[last.campaign].night == tonight_.night &&
           m_.stored.campaigns[before.campaign].night < tonight_.night;
  }

  double share(const ShownSeries& s) const {
    const auto& last = m_.stored.results[s.judged.back()];
    return *last.tolerance > 0.0 ? std::fabs(last.value) / *last.tolerance : 0.0;
  }

  /// The day from which on it was judged as it is.
  std::string since(const ShownSeries& s) const {
    const std::string& decision = m_.stored.results[s.judged.back()].decision;
    std::size_t first = s.judged.size() - 1;
    while (first > 0 && m_.stored.results[s.judged[first - 1]].decision == decision) --first;
    return m_.stored.campaigns[m_.stored.results[s.judged[first]].campaign].day;
  }

  MorningLine limit_line(Kind kind, const char* finding,
                         std::vector<const ShownSeries*>& all) const {
    std::stable_sort(all.begin(), all.end(),
                     [&](const auto* a, const auto* b) { return share(*a) > share(*b); });
    const ShownSeries& worst = *all.front();
    const auto& last = m_.stored.results[worst.judged.back()];
    MorningLine l = line(kind, finding, place_of(worst));
    l.axis = worst.axis;
    l.quantity = worst.quantity;
    l.unit = quantity_of_unit(worst.unit);
    l.value = si(last.value, l.unit);
    if (last.expanded) l.u = si(*last.expanded / last.k.value_or(2.0), l.unit);
    l.limit = si(*last.tolerance, l.unit);
    l.campaign = m_.stored.campaigns[last.campaign].id;
    l.since = since(worst);
    l.finding.evidence.push_back({"value", *l.value, l.unit});
    l.finding.evidence.push_back({"limit", *l.limit, l.unit});
    std::string also;
    for (std::size_t i = 1; i < all.size(); ++i)
      also += (also.empty() ? "" : ", ") + all[i]->quantity;
    if (!also.empty()) put_text(l, "also", also);
    return l;
  }

  /// Beyond its limit; with the change that made it so, if there is one.
  MorningLine beyond(const std::string& axis, std::vector<const ShownSeries*>& all) {
    MorningLine l = limit_line(Kind::out, "morning.out", all);
    l.id = "morning.out:" + d_.id + ":" + axis;
    told_[axis] = true;
    std::string first = l.since;
    for (const ShownSeries* s : all) first = std::min(first, since(*s));
    AxisChange* explains = nullptr;  // it came with it, or since
    for (AxisChange& cause : causes_[axis]) {
      if (cause.before < first) continue;
      cause.told = true;
      if (explains == nullptr || cause.seen.front().size() > explains->seen.front().size())
        explains = &cause;
    }
    if (explains != nullptr) {
      l.finding.id = has_event(*explains) ? "morning.out-changed-event" : "morning.out-changed";
      describe(l, *explains);
    }
    return l;
  }

  // ---- what a table promised

  void tables() {
    for (const reports::TableKept& t : d_.tables) {
      if (t.good || is_measured_since(t.axis, t.date)) continue;
      MorningLine l = line(Kind::changed, "morning.table", t.axis + ":" + t.campaign);
      l.axis = t.axis;
      l.quantity = t.quantity;
      l.unit = t.unit;
      l.value = t.left;
      l.campaign = t.campaign;
      l.since = t.date;
      l.finding.evidence = {
          {"left", t.left, t.unit}, {"promised", t.promised, t.unit}, {"found", t.found, t.unit}};
      put_text(l, "what", t.quantity);
      add(std::move(l));
    }
  }

  bool is_measured_since(const std::string& axis, const std::string& day) const {
    return std::any_of(m_.stored.results.begin(), m_.stored.results.end(), [&](const auto& r) {
      return r.axis == axis && m_.stored.campaigns[r.campaign].day > day;
    });
  }

  // ---- what comes

  void soon() {
    for (const HistorySeries& s : d_.series) {
      const std::string axis = axis_of(s.axis, s.quantity);
      if (!s.forecast || !s.limit || told_.contains(axis)) continue;
      if (s.forecast->answer != "watch" && s.forecast->answer != "act") continue;
      MorningLine l = line(Kind::soon, "morning.soon", axis + ":" + s.quantity);
      l.axis = axis;
      l.quantity = s.quantity;
      l.unit = s.unit;
      l.value = s.forecast->value;
      l.u = s.forecast->u;
      l.limit = s.limit;
      l.campaign = s.points.back().campaign;
      l.since = s.points.back().date;
      l.finding.evidence.push_back({"percent", 100.0 * s.forecast->p_out, Quantity::number});
      put_text(l, "date", s.forecast->date);
      put_text(l, "leaves", std::max(s.forecast->leaves, tonight_.date));
      told_[axis] = true;
      add(std::move(l));
    }
  }

  void overdue() {
    if (d_.due.empty() || d_.due >= tonight_.date) return;
    MorningLine l = line(Kind::overdue, "morning.overdue", "");
    l.since = d_.due;
    put_text(l, "due", d_.due);
    put_text(l, "rule", d_.why_due);
    add(std::move(l));
  }

  /// Nobody has measured yet what is dated after the night.
  void later() {
    for (const history::StoredMachine::Later& c : m_.stored.later) {
      MorningLine l = line(Kind::undecided, "morning.later", c.campaign);
      l.campaign = c.campaign;
      l.since = c.day;
      put_text(l, "campaign", c.campaign);
      put_text(l, "day", c.day);
      add(std::move(l));
    }
  }

  /// What moved with another instrument and came tonight.
  void instruments() {
    for (std::size_t i = 0; i < m_.followed.size(); ++i) {
      if (m_.followed[i].night != tonight_.night) continue;
      const HistorySeries& s = d_.series[i];
      for (const HistoryChange& c : s.changes) {
        if (c.cause != "instrument") continue;
        MorningLine l = line(Kind::information, "morning.instrument",
                             s.axis + ":" + s.quantity + ":" + c.before);
        l.axis = s.axis;
        l.quantity = s.quantity;
        l.unit = s.unit;
        l.campaign = c.before_campaign;
        l.since = c.before;
        describe(l, {c.after, c.before, {{&s, &c}}});
        add(std::move(l));
      }
    }
  }

  const AssessedMachine& m_;
  const reports::MachineHistory& d_;
  const Tonight& tonight_;
  std::map<std::string, std::vector<AxisChange>> causes_;
  std::map<std::string, bool> told_;  ///< axes with a line that says all of a change
  std::vector<MorningLine> out_;
};

}  // namespace

MorningLine line_of(Kind kind, const char* finding, const std::string& of) {
  MorningLine line;
  line.kind = kind;
  line.id = std::string(finding) + ":" + of;
  line.finding.id = finding;
  line.finding.attention = kind != Kind::information;
  return line;
}

void put_text(MorningLine& line, const char* name, std::string text) {
  line.finding.texts.emplace_back(name, std::move(text));
}

std::vector<MorningLine> lines_of_machine(const AssessedMachine& machine,
                                          const reports::MachineHistory& described,
                                          const Tonight& tonight) {
  return OfMachine(machine, described, tonight).lines();
}

}  // namespace nonio::host::morning
