// SPDX-License-Identifier: Apache-2.0
// machines/<asset>.html: one machine over its campaigns.
#include <set>

#include "chart.h"
#include "html.h"
#include "nonio/reports/number.h"
#include "nonio/reports/quantity_words.h"
#include "nonio/sdk/format.h"
#include "pages.h"

namespace nonio::reports::site {

namespace {

std::string entry(const Page& page, const char* key, const std::string& value) {
  if (value.empty()) return {};
  return element("dt", html(page.words.get("site." + std::string(key)))) +
         element("dd", html(value));
}

std::string identity(const Page& page, const MachineHistory& m) {
  std::string made = m.maker;
  if (!m.model.empty()) made += (made.empty() ? "" : " ") + m.model;
  const std::string due =
      m.due.empty() ? "" : m.due + (m.why_due.empty() ? "" : " (" + m.why_due + ")");
  return element("dl", entry(page, "machine", made) + entry(page, "serial", m.serial) +
                           entry(page, "customer", m.customer) + entry(page, "place", m.place) +
                           entry(page, "control", m.control) + entry(page, "next_due", due) +
                           entry(page, "proposal", proposal_text(page, m.proposal)));
}

std::string open_lines(const Page& page, const MachineHistory& m) {
  std::string items;
  for (const MorningLine& l : page.site.lines) {
    if (l.machine != m.id) continue;
    std::string text = html(page.words.get("site.kind." + std::string(name_of(l.kind)))) + ": ";
    if (!l.axis.empty()) text += html(l.axis) + " ";
    if (!l.quantity.empty()) text += html(quantity_text(page, l.quantity)) + " ";
    if (l.value) text += html(value_text(page, *l.value, l.u, l.unit)) + ". ";
    for (const char* part : {"says", "advice"})
      text += typeset_html(line_text(page, l, part)) + " ";
    text += html(also_text(page, l));
    items += element("li", text);
  }
  return items.empty() ? items : element("ul", items);
}

std::string events(const Page& page, const MachineHistory& m) {
  if (m.events.empty()) return {};
  std::string items;
  for (const MachineEvent& e : m.events)
    items +=
        element("li", with_whole_days(html(e.date + " " + e.axis + (e.axis.empty() ? "" : " ") +
                                           page.words.get_or("site.event." + e.kind, e.kind) +
                                           (e.text.empty() ? "" : ": ") + e.text)));
  return element("h2", html(page.words.get("site.events"))) + element("ol", items);
}

std::string tables(const Page& page, const MachineHistory& m) {
  std::string items;
  for (const TableKept& t : m.tables) {
    const auto value = [&](double x) { return value_text(page, x, std::nullopt, t.unit); };
    items += element("li", html(page.words.get(t.good ? "site.table_good" : "site.table_wrong",
                                               {{"axis", t.axis},
                                                {"date", t.date},
                                                {"name", t.quantity},
                                                {"left", value(t.left)},
                                                {"promised", value(t.promised)},
                                                {"found", value(t.found)}})));
  }
  if (items.empty()) return items;
  return element("h2", html(page.words.get("site.last_tables"))) + element("ul", items);
}

/// As found and as left on one day has words of its own.
std::string change_text(const Page& page, const HistorySeries& s, const HistoryChange& c) {
  const std::string size = value_text(page, c.size, c.u, s.unit);
  if (c.cause == "table" && c.after == c.before)
    return page.words.get("site.change.adjusted", {{"size", size}, {"date", c.before}});
  return page.words.get(
      "site.change." + c.cause,
      {{"size", size},
       {"after", c.after},
       {"before", c.before},
       {"event", event_text(page.words, c.event)},
       {"p", localised(evidence_text({"p", c.p, Quantity::probability}), page.words.language())}});
}

std::string changes(const Page& page, const HistorySeries& s) {
  std::string out;
  if (s.compared_over)
    out += element(
        "p",
        html(page.words.get("site.compared_over",
                            {{"from", short_number(page, s.compared_over->from, Quantity::length)},
                             {"to", short_number(page, s.compared_over->to, Quantity::length)}})),
        "class=\"muted\"");
  for (const HistoryChange& c : s.changes)
    out += element("p", with_whole_days(html(change_text(page, s, c))));
  if (s.changes.empty() && s.smallest_change)
    out +=
        element("p",
                html(page.words.get("site.no_change",
                                    {{"smallest", short_number(page, *s.smallest_change, s.unit)},
                                     {"unit", unit_text(s.unit)}})),
                "class=\"muted\"");
  return out;
}

std::string forecast(const Page& page, const HistorySeries& s) {
  if (!s.forecast) return {};
  const HistoryForecast& f = *s.forecast;
  constexpr double least_printed = 1e-4;
  const std::string p = f.p_out < least_printed
                            ? "< " + localised("0.01", page.words.language())
                            : short_number(page, 100 * f.p_out, Quantity::number);
  if (!std::isfinite(f.value))
    return element("p", html(page.words.get("site.forecast.out_now", {{"date", f.date}})));
  const bool asked = s.limit || f.answer == "cannot-say";
  std::string text = page.words.get(
      "site.forecast." + (asked ? f.answer : "expected"),
      {{"date", f.date}, {"value", value_text(page, f.value, f.u, s.unit)}, {"p", p}});
  if (!asked && f.answer == "act")
    text += " " + page.words.get("site.forecast.out_now", {{"date", f.date}});
  if (!f.leaves.empty()) text += " " + page.words.get("site.leaves", {{"date", f.leaves}});
  return element("p", html(text));
}

/// U of comparison, rounded as the value with it is.
std::string comparison_text(const Page& page, const HistoryPoint& p, Quantity q) {
  return printed_result(p.value, 2.0 * p.u, q, page.words.language()).U;
}

/// The numbers of the chart; where it is drawn from.
std::string numbers(const Page& page, const HistorySeries& s) {
  std::string head;
  for (const char* key : {"date", "state", "value", "comparison", "campaign"})
    if (!s.model.empty() || key != std::string_view("comparison"))
      head +=
          element("th", html(page.words.get("site.column." + std::string(key))), "scope=\"col\"");
  std::string rows;
  constexpr const char* states[] = {"as_found", "as_left", "check"};
  for (const HistoryPoint& p : s.points) {
    std::string state =
        page.words.get("site.state." + std::string(states[static_cast<int>(p.state)]));
    if (!p.joined)
      state += " (" + page.words.get_or("site.not_joined." + p.why_not, p.why_not) + ")";
    rows += element(
        "tr",
        element("td", with_whole_days(html(p.date))) + element("td", html(state)) +
            element("td", html(value_text(page, p.value, u_of_value(p), s.unit)),
                    "class=\"number\"") +
            (s.model.empty()
                 ? ""
                 : element("td", html(comparison_text(page, p, s.unit)), "class=\"number\"")) +
            element("td", link(p.link.empty() ? "" : page.to_root + p.link, html(p.campaign))));
  }
  return element("details", element("summary", html(page.words.get("site.numbers"))) +
                                scrolled(s.axis + " " + quantity_text(page, s.quantity),
                                         element("table", element("thead", element("tr", head)) +
                                                              element("tbody", rows))));
}

/// Of two series of one quantity the one that has ended says so.
std::string title_of(const Page& page, const HistorySeries& s) {
  const std::string title = s.axis + " · " + quantity_text(page, s.quantity);
  if (!s.ended || s.points.empty()) return title;
  return title + ", " + page.words.get("site.until", {{"date", s.points.back().date}});
}

std::string one_series(const Page& page, const MachineHistory& m, const HistorySeries& s) {
  return element("section", element("h3", html(title_of(page, s))) + history_chart(page, m, s) +
                                changes(page, s) + forecast(page, s) + numbers(page, s));
}

std::string curves(const Page& page, const MachineHistory& m) {
  std::set<std::string> axes;
  for (const ErrorCurve& c : m.curves) axes.insert(c.axis);
  std::string out;
  for (const std::string& axis : axes) {
    const std::string all = curves_chart(page, m, axis), last = difference_chart(page, m, axis);
    if (all.empty()) continue;
    out += element("section",
                   element("h3", html(page.words.get("site.curves", {{"axis", axis}}))) + all);
    if (!last.empty())
      out +=
          element("section",
                  element("h3", html(page.words.get("site.difference", {{"axis", axis}}))) + last);
  }
  if (out.empty()) return out;
  return element("h2", html(page.words.get("site.all_curves"))) +
         element("div", out, "class=\"charts\"");
}

}  // namespace

std::string machine_page(const Page& page, const MachineHistory& m) {
  std::string charts;
  for (const HistorySeries& s : m.series)
    if (!s.points.empty()) charts += one_series(page, m, s);
  return whole_page(page, m.id,
                    identity(page, m) + open_lines(page, m) + events(page, m) + tables(page, m) +
                        element("h2", html(page.words.get("site.trends"))) +
                        element("p", html(page.words.get("site.legend")), "class=\"muted\"") +
                        element("div", charts, "class=\"charts\"") + curves(page, m));
}

}  // namespace nonio::reports::site
