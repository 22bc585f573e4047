// SPDX-License-Identifier: Apache-2.0
// index.html: what a person decides this morning.
#include <algorithm>
#include <map>
#include <set>
#include <span>

#include "chart.h"
#include "html.h"
#include "nonio/sdk/format.h"
#include "pages.h"

namespace nonio::reports::site {

namespace {

using Kind = MorningLine::Kind;

const MachineHistory* machine_in(const SiteHistory& site, const std::string& id) {
  const auto& all = site.machines;
  const auto at =
      std::lower_bound(all.begin(), all.end(), id,
                       [](const MachineHistory& m, const std::string& x) { return m.id < x; });
  return at != all.end() && at->id == id ? &*at : nullptr;
}

const MachineHistory* machine_of(const Page& page, const std::string& id) {
  return machine_in(page.site, id);
}

std::string machine_link(const Page& page, const std::string& id) {
  const MachineHistory* machine = machine_of(page, id);
  return link(machine == nullptr ? "" : page.to_root + "machines/" + machine->file, html(id));
}

std::string counts(const Page& page) {
  const SiteHistory& site = page.site;
  std::string out =
      page.words.get("site.counts", {{"machines", std::to_string(site.machines.size())},
                                     {"campaigns", std::to_string(site.campaigns)},
                                     {"new", std::to_string(site.done)},
                                     {"unchanged", std::to_string(site.unchanged)}});
  if (site.certificates > 0)
    out +=
        ' ' + page.words.get("site.certificates", {{"count", std::to_string(site.certificates)}});
  if (site.waiting > 0)
    out += ' ' + page.words.get("site.waiting", {{"count", std::to_string(site.waiting)}});
  return element("p", html(out), "class=\"counts\"");
}

constexpr std::size_t most_lines = 200;    // one page, not a download
constexpr std::size_t most_machines = 60;  // of the strip
constexpr std::size_t most_months = 36;

std::span<const MorningLine> shown_lines(const Page& page) {
  const auto& all = page.site.lines;
  return std::span(all).first(std::min(all.size(), most_lines));
}

std::string select(const Page& page, const char* name,
                   const std::map<std::string, std::string>& values) {
  if (values.size() < 2) return {};
  std::string options = element("option", html(page.words.get("site.all")), "value=\"\"");
  for (const auto& [value, text] : values)
    options += element("option", html(text), "value=\"" + html(value) + "\"");
  return element("label", html(page.words.get("site.filter." + std::string(name))) + " " +
                              element("select", options, "name=\"" + std::string(name) + "\""));
}

std::string filters(const Page& page) {
  std::map<std::string, std::string> kinds, customers, machines, axes;
  for (const MorningLine& l : shown_lines(page)) {
    kinds[name_of(l.kind)] = page.words.get("site.kind." + std::string(name_of(l.kind)));
    if (!l.customer.empty()) customers[l.customer] = l.customer;
    if (!l.machine.empty()) machines[l.machine] = l.machine;
    if (!l.axis.empty()) axes[l.axis] = l.axis;
  }
  const std::string all = select(page, "kind", kinds) + select(page, "customer", customers) +
                          select(page, "machine", machines) + select(page, "axis", axes);
  if (all.empty()) return {};
  return element("div", all + "<span id=\"shown\" class=\"muted\" role=\"status\"></span>",
                 "class=\"filters\" hidden");
}

std::string limit_text(const Page& page, const MorningLine& l) {
  if (!l.limit) return {};
  return ", " + page.words.get("site.limit", {{"limit", short_number(page, *l.limit, l.unit)}});
}

/// "S-0042 X", linked; the campaign's where there is no machine.
std::string where(const Page& page, const MorningLine& l) {
  if (l.machine.empty())
    return link(l.link.empty() ? "" : page.to_root + l.link, html(l.campaign)) +
           (l.axis.empty() ? "" : " " + html(l.axis));
  return machine_link(page, l.machine) + (l.axis.empty() ? "" : " " + html(l.axis));
}

/// HTML.
std::string says(const Page& page, const MorningLine& l, const char* part) {
  return typeset_html(line_text(page, l, part));
}

std::string row_of(const Page& page, const MorningLine& l) {
  const char* kind = name_of(l.kind);
  std::string value;
  if (!l.quantity.empty()) value = html(quantity_text(page, l.quantity));
  if (l.value)
    value += (value.empty() ? "" : " ") +
             link(l.link.empty() ? "" : page.to_root + l.link,
                  html(value_text(page, *l.value, l.u, l.unit))) +
             html(limit_text(page, l));
  std::string text = says(page, l, "says");
  if (const std::string also = also_text(page, l); !also.empty()) text += " " + html(also);
  if (const std::string since = since_text(page, l); !since.empty()) text += " " + html(since);
  std::string advice = says(page, l, "advice");
  if (l.state == MorningLine::State::known)
    advice = html(
        page.words.get("site.acknowledged", {{"by", l.by}, {"until", l.until}, {"why", l.why}}));
  const char* state = l.state == MorningLine::State::known   ? "known"
                      : l.state == MorningLine::State::fixed ? "fixed"
                                                             : "fresh";
  const std::string what = l.state == MorningLine::State::fixed ? "fixed" : kind;
  return "<tr tabindex=\"0\" class=\"" + std::string(state) + "\" data-line=\"" + html(l.id) +
         "\" data-kind=\"" + kind + "\" data-customer=\"" + html(l.customer) +
         "\" data-machine=\"" + html(l.machine) + "\" data-axis=\"" + html(l.axis) + "\">" +
         element("td",
                 element("span", html(page.words.get("site.kind." + what)),
                         "class=\"kind " + what + "\""),
                 "class=\"what\"") +
         element("td", where(page, l)) + element("td", value, "class=\"value\"") +
         element("td", with_whole_days(text)) + element("td", advice, "class=\"do\"") + "</tr>\n";
}

std::string lines(const Page& page) {
  if (page.site.lines.empty())
    return element("p", html(page.words.get(page.site.judged ? "site.nothing" : "site.not_judged")),
                   "class=\"counts\"");
  std::string head;
  for (const char* key : {"what", "where", "value", "says", "do"})
    head += element("th", html(page.words.get("site.column." + std::string(key))), "scope=\"col\"");
  std::string rows;
  const auto shown = shown_lines(page);
  for (const MorningLine& l : shown) rows += row_of(page, l);
  const std::size_t more = page.site.lines.size() - shown.size();
  return scrolled(page.words.get("site.morning"),
                  element("table", element("thead", element("tr", head)) + element("tbody", rows),
                          "class=\"lines\"")) +
         (more == 0 ? ""
                    : element("p", html(page.words.get("site.and_more",
                                                       {{"count", std::to_string(more)}}))));
}

const char* style_of(Kind kind) {
  switch (kind) {
    case Kind::lost:
    case Kind::failed:
    case Kind::out:
      return "grave";
    case Kind::changed:
    case Kind::soon:
    case Kind::overdue:
    case Kind::withheld:
    case Kind::undecided:
      return "heed";
    case Kind::information:
      break;
  }
  return "fine";
}

/// A row a machine, a cell a month: a letter beside the colour, so that no one needs the colour.
std::string strip(const Page& page) {
  std::set<std::string> months;
  std::map<std::string, std::map<std::string, const MonthOfMachine*>> cells;
  for (const MonthOfMachine& m : page.site.months) {
    months.insert(m.month);
    cells[m.machine][m.month] = &m;
  }
  if (months.empty()) return {};
  while (months.size() > most_months) months.erase(months.begin());
  std::set<std::string> first;  // those that the lines name come first
  for (const MorningLine& l : page.site.lines)
    if (first.size() < most_machines && cells.contains(l.machine)) first.insert(l.machine);
  for (const auto& [machine, of] : cells)
    if (first.size() < most_machines) first.insert(machine);
  const std::size_t more = cells.size() - first.size();
  std::erase_if(cells, [&](const auto& one) { return !first.contains(one.first); });
  std::string head = "<td></td>";
  std::string year;
  for (const std::string& month : months) {
    const std::string text = month.substr(0, 4) == year ? "" : month.substr(2, 2);
    year = month.substr(0, 4);
    const std::string whole = html(month_text(page, month));  // who does not see hears every month
    head += element("th",
                    element("span", whole, "class=\"unseen\"") +
                        (text.empty() ? "" : element("span", "’" + text, "aria-hidden=\"true\"")),
                    "scope=\"col\" title=\"" + whole + "\"");
  }
  std::string rows;
  for (const auto& [machine, of] : cells) {
    std::string row = element("th", machine_link(page, machine), "scope=\"row\"");
    for (const std::string& month : months) {
      const auto at = of.find(month);
      if (at == of.end()) {
        row += "<td></td>";
        continue;
      }
      const MonthOfMachine& m = *at->second;
      const std::string word = m.gravest
                                   ? page.words.get("site.kind." + std::string(name_of(*m.gravest)))
                                   : page.words.get(m.measured ? "site.measured" : "site.happened");
      row += element("td",
                     m.event     ? "●"
                     : m.gravest ? html(word.substr(0, 1))
                                 : "",
                     "class=\"" +
                         std::string(m.gravest    ? style_of(*m.gravest)
                                     : m.measured ? "fine"
                                                  : "") +
                         "\" title=\"" +
                         html(machine + ", " + month_text(page, month) + ": " + word) + "\"");
    }
    rows += element("tr", row);
  }
  return element("h2", html(page.words.get("site.months"))) +
         element("p", html(page.words.get("site.months_key")), "class=\"muted\"") +
         scrolled(page.words.get("site.months"),
                  element("table", element("thead", element("tr", head)) + element("tbody", rows),
                          "class=\"strip\"")) +
         (more == 0 ? ""
                    : element("p",
                              html(page.words.get("site.more_machines",
                                                  {{"count", std::to_string(more)}})),
                              "class=\"muted\""));
}

constexpr std::size_t most_sparks = 10;

/// The first lines that a machine has, one of each axis.
std::vector<const MorningLine*> drawn_lines(const SiteHistory& site) {
  std::vector<const MorningLine*> out;
  std::set<std::string> seen;
  for (const MorningLine& l : site.lines)
    if (out.size() < most_sparks && machine_in(site, l.machine) != nullptr &&
        seen.insert(l.machine + ' ' + l.axis).second)
      out.push_back(&l);
  return out;
}

/// Largest deviations of machines whose lines come first.
std::string sparks(const Page& page) {
  std::string rows;
  for (const MorningLine* line : drawn_lines(page.site)) {
    const MorningLine& l = *line;
    const MachineHistory* machine = machine_of(page, l.machine);
    std::string row;
    for (const char* quantity : {"A", "B", "R"}) {
      const auto series = std::find_if(
          machine->series.begin(), machine->series.end(),
          [&](const HistorySeries& s) { return s.axis == l.axis && s.quantity == quantity; });
      if (series == machine->series.end() || series->points.empty()) continue;
      const HistoryPoint& last = series->points.back();
      row += element("td", spark_line(page, *series)) +
             element("td",
                     html(std::string(quantity) + " " +
                          value_text(page, last.value, last.u, series->unit)),
                     "class=\"number\"");
    }
    if (!row.empty())
      rows += element(
          "tr",
          element("th", machine_link(page, l.machine) + " " + html(l.axis), "scope=\"row\"") + row);
  }
  if (rows.empty()) return {};
  return element("h2", html(page.words.get("site.worst"))) +
         scrolled(page.words.get("site.worst"), element("table", rows, "class=\"sparks\""));
}

}  // namespace

std::string index_page(const Page& page) {
  return whole_page(page, page.words.get("site.morning"),
                    counts(page) + filters(page) + lines(page) + sparks(page) + strip(page),
                    page.words.get("site.night", {{"night", std::to_string(page.site.night)},
                                                  {"date", page.site.date}}));
}

}  // namespace nonio::reports::site

namespace nonio::reports {

std::vector<std::string> drawn_first(const SiteHistory& site) {
  std::vector<std::string> out;
  for (const MorningLine* l : site::drawn_lines(site))
    if (std::find(out.begin(), out.end(), l->machine) == out.end()) out.push_back(l->machine);
  return out;
}

}  // namespace nonio::reports
