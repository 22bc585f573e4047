// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/lines_of_machine.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "laboratory/assessment/describe.h"
#include "laboratory/assessment/lines.h"
#include "laboratory/assessment/open_values.h"
#include "laboratory/statistics/forecast.h"
#include "nonio/reports/quantity_words.h"
#include "nonio/sdk/withheld.h"

namespace nonio::assessment {

using reports::HistoryChange;
using reports::HistorySeries;
using reports::WorkItem;
using Kind = WorkItem::Kind;

namespace {

struct AxisChange {
  std::string after, before;
  struct Seen {
    const HistorySeries* series = nullptr;
    const HistoryChange* change = nullptr;
    double size() const { return std::fabs(change->size) / change->u; }
  };
  std::vector<Seen> seen;  ///< sorted by |size| / u, largest first
  bool listed = false;
};

bool is_correction(const HistoryChange& c) {
  return c.cause == "table" || c.event.starts_with("repair") || c.event.starts_with("compensation");
}

/// Whether most of the change brought an error nearer to zero. A center or a parameter has no best
/// value.
bool is_better(const AxisChange::Seen& seen) {
  constexpr double most = 0.5;  // by judgement; a change of the sign to the same size is none
  const HistoryChange& c = *seen.change;
  const std::string kind = kind_of(seen.series->quantity);
  if (kind == "scatter") return c.size < 0.0;
  if (kind == "centre" || kind == "parameter") return false;
  const auto& all = seen.series->segments;
  const auto was = std::find_if(all.begin(), all.end(), [&](const auto& g) {
    return g.to == c.after && g.to_campaign == c.after_campaign;
  });
  if (was == all.end() || std::next(was) == all.end()) return false;
  return std::fabs(was->last) - std::fabs(std::next(was)->first) > most * std::fabs(c.size);
}

class OfMachine {
 public:
  OfMachine(const AssessedMachine& m, const reports::MachineHistory& d, const LastRun& last_run)
      : m_(m), d_(d), last_run_(last_run) {}

  std::vector<WorkItem> lines() {
    causes_by_axis();
    judged();
    for (const auto& [axis, all] : causes_)
      for (const AxisChange& cause : all)
        if (!cause.listed) add(changed(axis, cause));
    loaded();
    tables();
    held_back();
    soon();
    overdue();
    later();
    instruments();
    return std::move(out_);
  }

 private:
  WorkItem line(Kind kind, const char* finding, const std::string& of) const {
    WorkItem l = line_of(kind, finding, name() + (of.empty() ? "" : ":" + of));
    l.machine = d_.id;
    l.customer = d_.customer;
    if (!d_.file.empty()) l.link = "machines/" + d_.file;
    return l;
  }

  const std::string& name() const {
    return d_.id.empty() && !m_.stored.campaigns.empty() ? m_.stored.campaigns.back().id : d_.id;
  }

  void add(WorkItem l) { out_.push_back(std::move(l)); }

  /// Collects the changes of each axis since its last repair or compensation, except those caused
  /// by the instrument or by an incorrectly loaded table.
  void causes_by_axis() {
    for (const HistorySeries& s : d_.series) {
      std::string repaired;
      for (const HistoryChange& c : s.changes)
        if (is_correction(c) && !is_fault(s.axis, c)) repaired = std::max(repaired, c.before);
      for (const HistoryChange* c : lasting(s))
        if (c->cause != "instrument" && !is_correction(*c) && !is_fault(s.axis, *c) &&
            c->before > repaired && !is_repaired(s.axis, c->before, &s, c))
          put_change(axis_of(s.axis, s.quantity), s, *c);
    }
    for (auto& [axis, all] : causes_)
      for (AxisChange& cause : all)
        std::stable_sort(cause.seen.begin(), cause.seen.end(),
                         [](const auto& a, const auto& b) { return a.size() > b.size(); });
  }

  /// The changes that last: a step that a later one undid within their uncertainty, and the step that
  /// undid it, do not explain a value of today.
  static std::vector<const HistoryChange*> lasting(const HistorySeries& s) {
    std::vector<const HistoryChange*> out;
    for (const HistoryChange& c : s.changes) {
      double sum = c.size, squares = c.u * c.u;
      auto undone = out.end();
      for (auto it = out.end(); it != out.begin() && undone == out.end();) {
        --it;
        sum += (*it)->size, squares += (*it)->u * (*it)->u;
        if (std::fabs(sum) <= 2.0 * std::sqrt(squares)) undone = it;
      }
      if (undone == out.end())
        out.push_back(&c);
      else
        out.erase(undone, out.end());
    }
    return out;
  }

  bool is_fault(const std::string& axis, const HistoryChange& c) const {
    return std::any_of(d_.tables_loaded.begin(), d_.tables_loaded.end(), [&](const auto& t) {
      return t.kind != "loaded" && t.kind != "removed" && is_at(t, axis, c);
    });
  }

  /// Mean of the points of the series later than `from` and not later than `to`; NaN if there are
  /// none.
  static double mean_of(const HistorySeries& s, const std::string& from, const std::string& to) {
    double sum = 0.0, n = 0.0;
    for (const reports::HistoryPoint& p : s.points)
      if (p.joined && p.date > from && p.date <= to) sum += p.value, n += 1.0;
    return sum / n;
  }

  /// Whether an event after the date `after` states a repair or compensation of the axis. Events
  /// after the run are ignored. With `change`, the campaigns after the repair must be nearer to those
  /// before the change than to those after it, if there are any.
  bool is_repaired(const std::string& axis, const std::string& after,
                   const HistorySeries* series = nullptr,
                   const HistoryChange* change = nullptr) const {
    return std::any_of(m_.events.begin(), m_.events.end(), [&](const config::Event& e) {
      if ((e.kind != "repair" && e.kind != "compensation") || e.date <= after ||
          e.date > last_run_.date || !e.concerns(axis))
        return false;
      if (change == nullptr) return true;
      const double later = mean_of(*series, e.date, last_run_.date);
      return !(std::fabs(later - mean_of(*series, change->after, e.date)) <
               std::fabs(later - mean_of(*series, "", change->after)));
    });
  }

  void put_change(const std::string& axis, const HistorySeries& s, const HistoryChange& c) {
    // Changes that overlap in time are one change, because not every campaign has all quantities.
    for (AxisChange& cause : causes_[axis])
      if ((c.after < cause.before && c.before > cause.after) ||
          (c.after == cause.after && c.before == cause.before)) {
        cause.after = std::max(cause.after, c.after);
        cause.before = std::min(cause.before, c.before);
        cause.seen.push_back({&s, &c});
        return;
      }
    causes_[axis].push_back({c.after, c.before, {{&s, &c}}});
  }

  void describe(WorkItem& l, const AxisChange& cause) const {
    const AxisChange::Seen& first = cause.seen.front();
    const Quantity q = first.series->unit;
    const double size = first.change->size, U = 2.0 * first.change->u;
    if (reports::is_log_of_scatter(first.series->quantity)) {
      l.finding.evidence.push_back({"factor", std::exp(size), Quantity::ratio});
      l.finding.evidence.push_back({"low", std::exp(size - U), Quantity::ratio});
      l.finding.evidence.push_back({"high", std::exp(size + U), Quantity::ratio});
    } else {
      l.finding.evidence.push_back({"size", size, q});
      l.finding.evidence.push_back({"U", U, q});
    }
    l.finding.evidence.push_back({"p", first.change->p, Quantity::probability});
    const bool same_day = cause.after == cause.before;
    put_text(l, "after", same_day ? first.change->after_text() : cause.after);
    put_text(l, "before", same_day ? first.change->before_text() : cause.before);
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

  const reports::TableLoaded* unstated(const std::string& axis, const AxisChange& cause) const {
    for (const reports::TableLoaded& t : d_.tables_unstated)
      if (t.axis == axis && !has_event(cause) && cause.after <= t.before && cause.before >= t.after)
        return &t;
    return nullptr;
  }

  static void put_table(WorkItem& l, const reports::TableLoaded& t) {
    put_text(l, "table", t.table);
    put_text(l, "campaign", t.before_campaign);
    put_text(l, "axis", t.axis);
    if (!(t.rms > 0.0)) return;
    l.finding.evidence.push_back({"rms", t.rms, t.unit});
    l.finding.evidence.push_back({"left", t.left, t.unit});
  }

  WorkItem changed(const std::string& axis, const AxisChange& cause) const {
    const AxisChange::Seen& first = cause.seen.front();
    const reports::TableLoaded* const table = unstated(axis, cause);
    WorkItem l = line(Kind::changed,
                      table != nullptr   ? (table->rms > 0.0 ? "worklist.changed-table-likely"
                                                             : "worklist.changed-table-unknown")
                      : has_event(cause) ? "worklist.changed-event"
                      : is_better(first) ? "worklist.changed-better"
                                         : "worklist.changed",
                      "");
    if (table != nullptr) put_table(l, *table);
    l.id = "worklist.changed:" + d_.id + ":" + axis + ":" + cause.before;
    l.axis = axis;
    l.quantity = first.series->quantity;
    l.unit = first.series->unit;
    l.campaign = first.change->before_campaign;
    l.since = cause.before;
    if (!first.series->points.empty()) {
      l.value = first.series->points.back().value;
      l.u = reports::u_of_value(first.series->points.back());
      l.limit = first.series->limit;
    }
    l.sure = std::any_of(cause.seen.begin(), cause.seen.end(),
                         [](const AxisChange::Seen& s) { return s.change->mailed; });
    describe(l, cause);
    return l;
  }

  const std::string& place_of(const store::StoredResult& r) const {
    return r.axis.empty() ? r.source : r.axis;
  }

  void judged() {
    std::map<std::string, std::vector<Judged>> out, open, good, anew;
    std::map<std::string, std::vector<reports::OpenValue>> missing;
    for (const ShownSeries& s : m_.shown) {
      if (s.ended) continue;
      const std::vector<Judged> all = open_results(m_.stored, s);
      for (const Judged& j : all) {
        const store::StoredResult& r = m_.stored.results[j.result];
        (r.decision == does_not_conform ? out : open)[place_of(r)].push_back(j);
        open_.emplace(s.axis, s.quantity);
      }
      if (!all.empty() || !is_fixed(s)) continue;
      const store::StoredResult& last = m_.stored.results[s.judged.back()];
      (is_judged_alike(s) ? good : anew)[place_of(last)].push_back({&s, s.judged.back()});
    }
    for (const auto* limit : open_limits(m_.stored))
      missing[limit->axis.empty() ? limit->measurement : limit->axis].push_back(
          open_value(m_.stored, *limit));
    for (auto& [place, all] : out) {
      add(beyond(place, all));
      also(out_.back(), open[place], missing[place]);
    }
    for (auto& [place, all] : open) {
      if (out.contains(place) || all.empty()) continue;
      worst_first(all);
      const bool has_u = m_.stored.results[all.front().result].expanded.value_or(0.0) > 0.0;
      add(limit_line(Kind::undecided, has_u ? "worklist.undecided" : "worklist.no-uncertainty",
                     all));
      also(out_.back(), {}, missing[place]);
    }
    for (auto& [place, all] : missing)
      if (!out.contains(place) && !open.contains(place) && !all.empty()) add(no_value(place, all));
    for (auto& [axis, all] : good)
      if (!out.contains(axis)) add_fixed("worklist.fixed", all);
    for (auto& [axis, all] : anew)
      if (!out.contains(axis) && !good.contains(axis)) add_fixed("worklist.judged-anew", all);
  }

  void also(WorkItem& l, std::vector<Judged> open,
            const std::vector<reports::OpenValue>& missing) const {
    worst_first(open);
    for (const Judged& j : open) l.also.push_back(open_value(m_.stored, j.result));
    l.also.insert(l.also.end(), missing.begin(), missing.end());
  }

  WorkItem no_value(const std::string& place, const std::vector<reports::OpenValue>& all) const {
    WorkItem l = line(Kind::undecided, "worklist.no-value", place);
    const reports::OpenValue& first = all.front();
    l.axis = first.axis, l.quantity = first.quantity, l.campaign = first.campaign;
    l.measurement = first.measurement, l.unit = first.unit, l.limit = first.limit;
    for (const store::StoredCampaign& c : m_.stored.campaigns)
      if (c.id == first.campaign) l.since = c.day;
    l.finding.evidence.push_back({"limit", first.limit, first.unit});
    l.also.assign(all.begin() + 1, all.end());
    return l;
  }

  void add_fixed(const char* finding, std::vector<Judged>& all) {
    add(limit_line(Kind::out, finding, all));
    out_.back().state = WorkItem::State::fixed;
    out_.back().also.clear();
  }

  /// Whether the last two decisions have the same source and conditions and the last limit is not
  /// wider. Only then does a value that conforms again prove that the machine has improved.
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
           m_.stored.campaigns[last.campaign].run == last_run_.run &&
           m_.stored.campaigns[before.campaign].run < last_run_.run;
  }

  double share(const Judged& j) const {
    const auto& r = m_.stored.results[j.result];
    return r.tolerance && *r.tolerance > 0.0 ? std::fabs(r.value) / *r.tolerance : 0.0;
  }
  void worst_first(std::vector<Judged>& all) const {
    std::stable_sort(all.begin(), all.end(),
                     [&](const Judged& a, const Judged& b) { return share(a) > share(b); });
  }

  std::string since(const ShownSeries& s, const store::StoredResult& r) const {
    std::size_t first = s.judged.size() - 1;
    while (first > 0 && m_.stored.results[s.judged[first]].campaign > r.campaign) --first;
    while (first > 0 && m_.stored.results[s.judged[first - 1]].decision == r.decision) --first;
    return m_.stored.campaigns[m_.stored.results[s.judged[first]].campaign].day;
  }

  WorkItem limit_line(Kind kind, const char* finding, std::vector<Judged>& all) const {
    worst_first(all);
    const Judged& worst = all.front();
    const store::StoredResult& last = m_.stored.results[worst.result];
    const reports::OpenValue first = open_value(m_.stored, worst.result);
    WorkItem l = line(kind, finding, place_of(last));
    l.axis = first.axis, l.quantity = first.quantity, l.measurement = first.measurement;
    l.unit = first.unit, l.value = first.value, l.u = first.u, l.limit = first.limit;
    l.campaign = first.campaign, l.of_state = first.state;
    l.since = since(*worst.series, last);
    l.finding.evidence.push_back({"value", *l.value, l.unit});
    l.finding.evidence.push_back({"limit", *l.limit, l.unit});
    for (std::size_t i = 1; i < all.size(); ++i)
      l.also.push_back(open_value(m_.stored, all[i].result));
    return l;
  }

  WorkItem beyond(const std::string& axis, std::vector<Judged>& all) {
    WorkItem l = limit_line(Kind::out, "worklist.out", all);
    l.id = "worklist.out:" + name() + ":" + axis;
    told_[axis] = true;
    std::string first = l.since;
    for (const Judged& j : all)
      first = std::min(first, since(*j.series, m_.stored.results[j.result]));
    AxisChange* explains = nullptr;
    for (AxisChange& cause : causes_[axis]) {
      if (cause.before < first || (!has_event(cause) && is_better(cause.seen.front()))) continue;
      cause.listed = true;
      if (explains == nullptr || cause.seen.front().size() > explains->seen.front().size())
        explains = &cause;
    }
    if (explains != nullptr) {
      const reports::TableLoaded* const table = unstated(axis, *explains);
      l.finding.id = table != nullptr ? (table->rms > 0.0 ? "worklist.out-changed-table-likely"
                                                          : "worklist.out-changed-table-unknown")
                     : has_event(*explains) ? "worklist.out-changed-event"
                                            : "worklist.out-changed";
      if (table != nullptr) put_table(l, *table);
      describe(l, *explains);
    } else {
      put_newer(l, all.front());
    }
    return l;
  }

  /// States the limit of the campaign before, if the value would conform to it.
  void put_wider(WorkItem& l, const Judged& j) const {
    const std::vector<std::size_t>& judged = j.series->judged;
    if (judged.size() < 2 || judged.back() != j.result) return;
    const store::StoredResult &now = m_.stored.results[j.result],
                              &before = m_.stored.results[judged[judged.size() - 2]];
    const double reach = std::fabs(now.value) + now.expanded.value_or(0.0);
    if (before.decision != conforms || before.source != now.source ||
        before.conditions != now.conditions || !(reach <= *before.tolerance))
      return;
    l.finding.id = "worklist.out-limit";
    l.finding.evidence.push_back({"wider", si(*before.tolerance, l.unit), l.unit});
    put_text(l, "campaign", m_.stored.campaigns[before.campaign].id);
  }

  /// States a later value for which its campaign states no limit.
  void put_newer(WorkItem& l, const Judged& j) const {
    const store::StoredResult& newest = m_.stored.results[j.series->results.back()];
    if (newest.campaign <= m_.stored.results[j.result].campaign) return put_wider(l, j);
    l.finding.id = "worklist.out-not-judged-since";
    const reports::OpenValue last = open_value(m_.stored, j.series->results.back());
    l.finding.evidence.push_back({"last", *last.value, l.unit});
    put_text(l, "day", m_.stored.campaigns[newest.campaign].day);
  }

  /// Adds a line for the last table of an axis if it was loaded incorrectly or without a record,
  /// unless the axis was repaired or compensated later.
  void loaded() {
    std::map<std::string, const reports::TableLoaded*> last;
    for (const reports::TableLoaded& t : d_.tables_loaded) last[t.axis] = &t;
    for (const auto& [axis, t] : last) {
      const bool is_right = t->kind == "loaded" || t->kind == "removed";
      if ((is_right && (t->is_stated || is_declared(*t))) || is_repaired(axis, t->before)) continue;
      WorkItem l = line(Kind::changed, ("worklist.table-" + t->kind).c_str(), "");
      l.id = l.finding.id + ":" + d_.id + ":" + axis + ":" + t->before;
      l.axis = axis, l.unit = t->unit;
      l.campaign = t->before_campaign, l.since = t->before;
      l.finding.evidence = {{"rms", t->rms, t->unit}, {"left", t->left, t->unit}};
      put_text(l, "axis", axis);
      put_text(l, "table", t->table);
      put_text(l, "after", t->after);
      put_text(l, "before", t->before);
      put_text(l, "points", (t->points > 0 ? "+" : "") + std::to_string(t->points));
      add(std::move(l));
    }
  }

  /// Whether an event between both campaigns, or readings as left in the later campaign, document
  /// the compensation.
  bool is_declared(const reports::TableLoaded& t) const {
    return std::any_of(m_.events.begin(), m_.events.end(),
                       [&](const config::Event& e) {
                         return e.kind == "compensation" && e.date >= t.after &&
                                e.date <= t.before && e.concerns(t.axis);
                       }) ||
           std::any_of(m_.stored.results.begin(), m_.stored.results.end(), [&](const auto& r) {
             return r.axis == t.axis && r.state == "as-left" &&
                    m_.stored.campaigns[r.campaign].id == t.before_campaign;
           });
  }

  bool has_loading_line(const std::string& axis) const {
    return std::any_of(out_.begin(), out_.end(), [&](const WorkItem& l) {
      return l.axis == axis && l.finding.id.starts_with("worklist.table-");
    });
  }

  void tables() {
    for (const reports::TableKept& t : d_.tables) {
      if (t.good || is_measured_since(t.axis, t.date) || has_loading_line(t.axis)) continue;
      WorkItem l = line(Kind::changed, "worklist.table", t.axis + ":" + t.campaign);
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

  void held_back() {
    std::map<std::string, WorkItem> all;
    for (const Withheld& w : withheld(m_.stored)) {
      const store::StoredCampaign& c = m_.stored.campaigns[w.campaign];
      const bool table = w.finding.starts_with("table.");
      WorkItem l = line(Kind::withheld,
                        table                               ? "worklist.no-table"
                        : is_failed_compensation(w.finding) ? "worklist.compensation"
                        : is_calibration(w.finding)         ? "worklist.calibration"
                        : is_refusal(w.finding)             ? "worklist.no-result"
                                                            : "worklist.certificate",
                        c.id + (w.axis.empty() ? "" : ":" + w.axis));
      l.axis = w.axis, l.campaign = c.id, l.since = c.evaluated;
      put_text(l, "campaign", c.id);
      auto& to = all.emplace(l.id, std::move(l)).first->second;
      add_to_list(to, "withheld", {w.finding});
      if (table || is_refusal(w.finding)) add_to_list(to, "outputs", w.outputs);
    }
    for (auto& [id, l] : all) add(std::move(l));
  }

  static void add_to_list(WorkItem& l, const char* name, const std::vector<std::string>& more) {
    auto at = std::find_if(l.finding.texts.begin(), l.finding.texts.end(),
                           [&](const auto& t) { return t.first == name; });
    if (at == l.finding.texts.end()) at = l.finding.texts.insert(at, {name, ""});
    for (const std::string& one : more)
      if ((", " + at->second + ", ").find(", " + one + ", ") == std::string::npos)
        at->second += (at->second.empty() ? "" : ", ") + one;
  }

  /// The last point; of several measurements of its campaign the one that was judged.
  const reports::HistoryPoint* judged_last(const HistorySeries& s) const {
    const reports::HistoryPoint& last = s.points.back();
    const auto k = static_cast<std::size_t>(&s - d_.series.data());
    if (k >= m_.followed.size() && !m_.shown[k - m_.followed.size()].judged.empty()) {
      const auto& judged = m_.stored.results[m_.shown[k - m_.followed.size()].judged.back()];
      if (m_.stored.campaigns[judged.campaign].id == last.campaign)
        for (const reports::HistoryPoint& p : s.points)
          if (p.campaign == last.campaign && p.value == si(judged.value, s.unit)) return &p;
    }
    return &last;
  }

  void soon() {
    for (const HistorySeries& s : d_.series) {
      const std::string axis = axis_of(s.axis, s.quantity);
      if (!s.forecast || !s.limit || told_.contains(axis) || s.points.empty()) continue;
      if (open_.contains({s.axis, s.quantity}) || s.forecast->answer == "cannot-say" ||
          !(s.forecast->p_out >= nonio::statistics::keep_below))
        continue;
      const std::string leaves = s.forecast->leaves.empty() ? s.forecast->date : s.forecast->leaves;
      const bool may_be_now = leaves <= last_run_.date || s.forecast->date < last_run_.date;
      WorkItem l = line(Kind::soon, may_be_now ? "worklist.soon-now" : "worklist.soon",
                        axis + ":" + s.quantity);
      l.id = "worklist.soon:" + d_.id + ":" + axis + ":" + s.quantity;
      l.axis = axis;
      l.quantity = s.quantity;
      l.unit = s.unit;
      const reports::HistoryPoint* last = judged_last(s);
      l.value = last->value;
      l.u = reports::u_of_value(*last);
      l.limit = s.limit;
      l.campaign = last->campaign;
      l.since = last->date;
      l.finding.evidence.push_back({"expected", s.forecast->value, s.unit});
      l.finding.evidence.push_back({"U", 2.0 * s.forecast->u, s.unit});
      l.finding.evidence.push_back({"percent", 100.0 * s.forecast->p_out, Quantity::number});
      put_text(l, "date", s.forecast->date);
      if (!may_be_now) put_text(l, "leaves", leaves);
      told_[axis] = true;
      add(std::move(l));
    }
  }

  void overdue() {
    if (d_.due.empty() || d_.due >= last_run_.date) return;
    WorkItem l = line(Kind::overdue, "worklist.overdue", "");
    l.since = d_.due;
    put_text(l, "due", d_.due);
    put_text(l, "rule", d_.why_due);
    add(std::move(l));
  }

  void later() {
    for (const store::StoredMachine::Later& c : m_.stored.later) {
      WorkItem l = line(Kind::undecided, "worklist.later", c.campaign);
      l.campaign = c.campaign;
      l.since = c.day;
      put_text(l, "campaign", c.campaign);
      put_text(l, "day", c.day);
      add(std::move(l));
    }
  }

  void instruments() {
    for (std::size_t i = 0; i < m_.followed.size(); ++i) {
      if (m_.followed[i].run != last_run_.run) continue;
      const HistorySeries& s = d_.series[i];
      for (const HistoryChange& c : s.changes) {
        if (c.cause != "instrument") continue;
        WorkItem l = line(Kind::information, "worklist.instrument",
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
  const LastRun& last_run_;
  std::map<std::string, std::vector<AxisChange>> causes_;
  std::map<std::string, bool> told_;
  std::set<std::pair<std::string, std::string>> open_;
  std::vector<WorkItem> out_;
};

}  // namespace

WorkItem line_of(Kind kind, const char* finding, const std::string& of) {
  WorkItem line;
  line.kind = kind;
  line.id = std::string(finding) + ":" + of;
  line.finding.id = finding;
  line.finding.attention = kind != Kind::information;
  return line;
}

void put_text(WorkItem& line, const char* name, std::string text) {
  line.finding.texts.emplace_back(name, std::move(text));
}

std::vector<WorkItem> lines_of_machine(const AssessedMachine& machine,
                                       const reports::MachineHistory& described,
                                       const LastRun& last_run) {
  return OfMachine(machine, described, last_run).lines();
}

}  // namespace nonio::assessment
