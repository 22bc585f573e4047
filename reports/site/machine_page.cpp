// SPDX-License-Identifier: Apache-2.0
#include <set>

#include "chart.h"
#include "html.h"
#include "nonio/reports/number.h"
#include "nonio/reports/quantity_words.h"
#include "nonio/sdk/format.h"
#include "pages.h"

namespace nonio::reports::site {

namespace {

void add_identity(View& view, const Page& page, const MachineHistory& m) {
  const auto add = [&](const char* key, const std::string& value) {
    if (value.empty()) return;
    view.add("entry").set("name", page.words.get("site." + std::string(key))).set("value", value);
  };
  add("machine", m.maker + (m.maker.empty() || m.model.empty() ? "" : " ") + m.model);
  add("serial", m.serial);
  add("customer", m.customer);
  add("place", m.place);
  add("control", m.control);
  add("next_due", m.due.empty() || m.why_due.empty()
                      ? m.due
                      : m.due + " (" + interval_text(page, m.why_due) + ")");
  add("proposal", proposal_text(page, m.proposal));
}

void add_open_lines(View& view, const Page& page, const MachineHistory& m) {
  bool any = false;
  for (const WorkItem& l : page.site.lines) {
    if (l.machine != m.id) continue;
    any = true;
    std::string text = page.words.get("site.kind." + std::string(name_of(l.kind))) + ": ";
    if (!l.axis.empty()) text += l.axis + " ";
    if (!l.quantity.empty()) text += quantity_text(page, l) + " ";
    if (shows_value(l)) text += value_text(page, *l.value, l.u, l.unit, l.limit) + ". ";
    text = html_of(text).text;
    for (const char* part : {"says", "advice"})
      text += typeset_html(line_text(page, l, part)) + " ";
    view.add("line").set("line", Html{text + html_of(also_text(page, l)).text});
  }
  view.flag("open", any);
}

void add_events(View& view, const Page& page, const MachineHistory& m) {
  view.flag("events", !m.events.empty());
  for (const MachineEvent& e : m.events)
    view.add("event").set("event",
                          with_whole_days(e.date + " " + e.axis + (e.axis.empty() ? "" : " ") +
                                          page.words.get_or("site.event." + e.kind, e.kind) +
                                          (e.text.empty() ? "" : ": ") + e.text));
}

void add_tables(View& view, const Page& page, const MachineHistory& m) {
  view.flag("tables", !m.tables.empty());
  for (const TableKept& t : m.tables) {
    const auto value = [&](double x) { return value_text(page, x, std::nullopt, t.unit); };
    view.add("table").set("table", page.words.get(t.good ? "site.table_good" : "site.table_wrong",
                                                  {{"axis", t.axis},
                                                   {"date", t.date},
                                                   {"name", t.quantity},
                                                   {"left", value(t.left)},
                                                   {"promised", value(t.promised)},
                                                   {"found", value(t.found)}}));
  }
}

std::string change_text(const Page& page, const FollowedNumbers& numbers, const HistoryChange& c) {
  const std::string size = numbers.difference(c.size, c.u);
  if (c.cause == "table" && c.after == c.before)
    return page.words.get("site.change.adjusted", {{"size", size}, {"date", c.before}});
  return page.words.get(
      "site.change." + c.cause,
      {{"size", size},
       {"after", c.after_text()},
       {"before", c.before_text()},
       {"event", event_text(page.words, c.event)},
       {"p", localised(evidence_text({"p", c.p, Quantity::probability}), page.words.language())}});
}

void add_changes(View& view, const Page& page, const HistorySeries& s,
                 const FollowedNumbers& numbers) {
  if (const auto& over = s.compared_over)
    view.set("compared_over",
             page.words.get("site.compared_over",
                            {{"from", short_number(page, over->from, s.position())},
                             {"to", short_number(page, over->to, s.position())},
                             {"unit", std::string(unit_of(s.position()).symbol)}}));
  for (const HistoryChange& c : s.changes)
    view.add("change").set("change", with_whole_days(change_text(page, numbers, c)));
  const bool drifts = s.model == "drift" && !s.segments.empty();
  if (drifts)
    view.add("change").set(
        "change",
        page.words.get(
            "site.change.drift",
            {{"slope", numbers.difference(s.segments.back().slope, s.segments.back().u_slope)}}));
  if (s.changes.empty() && s.smallest_change && !drifts)
    view.set("no_change",
             page.words.get("site.no_change", {{"smallest", numbers.size(*s.smallest_change)}}));
}

std::string forecast(const Page& page, const HistorySeries& s, const FollowedNumbers& numbers) {
  if (!s.forecast) return {};
  const HistoryForecast& f = *s.forecast;
  constexpr double least_printed = 1e-4;
  const std::string p = f.p_out < least_printed
                            ? "< " + localised("0.01", page.words.language())
                            : short_number(page, 100 * f.p_out, Quantity::number);
  if (!std::isfinite(f.value)) return page.words.get("site.forecast.out_now", {{"date", f.date}});
  const bool asked = s.limit || f.answer == "cannot-say";
  std::string text =
      page.words.get("site.forecast." + (asked ? f.answer : "expected"),
                     {{"date", f.date}, {"value", numbers.value(f.value, f.u)}, {"p", p}});
  if (!asked && f.answer == "act")
    text += " " + page.words.get("site.forecast.out_now", {{"date", f.date}});
  if (!f.leaves.empty()) text += " " + page.words.get("site.leaves", {{"date", f.leaves}});
  return text;
}

/// U (k = 2) for comparison with other campaigns, rounded with the value; an interval for a
/// scatter.
std::string comparison_text(const Page& page, const HistoryPoint& p,
                            const FollowedNumbers& numbers) {
  return numbers.is_scatter()
             ? numbers.number(p.value, p.u)
             : printed_result(p.value, 2.0 * p.u, numbers.quantity(), page.words.language()).U;
}

void add_numbers(View& view, const Page& page, const HistorySeries& s,
                 const FollowedNumbers& numbers) {
  view.flag("followed", !s.model.empty());
  constexpr const char* states[] = {"as_found", "as_left", "check"};
  for (const HistoryPoint& p : s.points) {
    std::string state =
        page.words.get("site.state." + std::string(states[static_cast<int>(p.state)]));
    if (!p.joined)
      state += " (" + page.words.get_or("site.not_joined." + p.why_not, p.why_not) + ")";
    View& point = view.add("point");
    point.set("date", with_whole_days(p.date)).set("state", std::move(state));
    point.set("value", numbers.value(p.value, u_of_value(p)));
    point.set("comparison", comparison_text(page, p, numbers));
    point.set("campaign", p.campaign).set("link", from_root(page, p.link));
  }
}

std::string title_of(const Page& page, const HistorySeries& s) {
  std::string title = (s.axis.empty() ? "" : s.axis + " · ") + quantity_text(page, s.quantity);
  if (!s.line.empty()) title += ", " + s.line;
  if (!s.ended || s.points.empty()) return title;
  return title + ", " + page.words.get("site.until", {{"date", s.points.back().date}});
}

/// Whether an open line of the worklist is of this series.
bool requires_action(const Page& page, const MachineHistory& m, const HistorySeries& s) {
  return std::any_of(page.site.lines.begin(), page.site.lines.end(), [&](const WorkItem& l) {
    const auto is_of = [&](const std::string& axis, const std::string& quantity) {
      return axis == s.axis && quantity == s.quantity;
    };
    return l.machine == m.id && l.kind != WorkItem::Kind::information &&
           (is_of(l.axis, l.quantity) ||
            std::any_of(l.also.begin(), l.also.end(),
                        [&](const OpenValue& v) { return is_of(v.axis, v.quantity); }));
  });
}

void add_series(View& view, const Page& page, const MachineHistory& m, const HistorySeries& s) {
  const FollowedNumbers numbers(s, m.series, page.words);
  View& series = view.flag("trends", true).add("series");
  series.set("series", title_of(page, s)).set("chart", history_chart(page, m, s));
  add_changes(series, page, s, numbers);
  series.set("forecast", forecast(page, s, numbers));
  add_numbers(series, page, s, numbers);
}

void add_curves(View& view, const Page& page, const MachineHistory& m) {
  std::set<std::string> axes;
  for (const ErrorCurve& c : m.curves) axes.insert(c.axis);
  bool any = false;
  for (const std::string& axis : axes) {
    const auto add = [&](const char* heading, Html chart) {
      if (chart.text.empty()) return false;
      view.add("curve")
          .set("heading", page.words.get(heading, {{"axis", axis}}))
          .set("chart", std::move(chart));
      return true;
    };
    if (!add("site.curves", curves_chart(page, m, axis))) continue;
    add("site.difference", difference_chart(page, m, axis));
    any = true;
  }
  view.flag("curves", any);
}

}  // namespace

Expected<std::string> machine_page(const Page& page, const MachineHistory& m) {
  View view = page_view(page, m.id);
  add_identity(view, page, m);
  add_open_lines(view, page, m);
  add_events(view, page, m);
  add_tables(view, page, m);
  for (const bool first : {true, false})
    for (const HistorySeries& s : m.series)
      if (!s.points.empty() && requires_action(page, m, s) == first) add_series(view, page, m, s);
  add_curves(view, page, m);
  return written(page, "machine", view);
}

}  // namespace nonio::reports::site
