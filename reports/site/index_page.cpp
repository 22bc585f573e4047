// SPDX-License-Identifier: Apache-2.0
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

using Kind = WorkItem::Kind;

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
  return machine == nullptr ? "" : page.to_root + "machines/" + machine->file;
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
  return out;
}

constexpr std::size_t most_lines = 200;  // limit of the page size
constexpr std::size_t most_machines = 60;
constexpr std::size_t most_months = 36;

std::span<const WorkItem> shown_lines(const Page& page) {
  const auto& all = page.site.lines;
  return std::span(all).first(std::min(all.size(), most_lines));
}

void add_filter(View& view, const Page& page, const char* name,
                const std::map<std::string, std::string>& values) {
  if (values.size() < 2) return;
  View& filter = view.add("filter");
  filter.set("name", name).set("label", page.words.get("site.filter." + std::string(name)));
  for (const auto& [value, text] : values)
    filter.add("option").set("value", value).set("text", text);
}

void add_filters(View& view, const Page& page) {
  std::map<std::string, std::string> kinds, customers, machines, axes;
  for (const WorkItem& l : shown_lines(page)) {
    kinds[name_of(l.kind)] = page.words.get("site.kind." + std::string(name_of(l.kind)));
    if (!l.customer.empty()) customers[l.customer] = l.customer;
    if (!l.machine.empty()) machines[l.machine] = l.machine;
    if (!l.axis.empty()) axes[l.axis] = l.axis;
  }
  const auto many = [](const auto& values) { return values.size() > 1; };
  view.flag("filters", many(kinds) || many(customers) || many(machines) || many(axes));
  add_filter(view, page, "kind", kinds);
  add_filter(view, page, "customer", customers);
  add_filter(view, page, "machine", machines);
  add_filter(view, page, "axis", axes);
}

Html says(const Page& page, const WorkItem& l, const char* part) {
  return {typeset_html(line_text(page, l, part))};
}

Html all_it_says(const Page& page, const WorkItem& l) {
  std::string more;
  for (const std::string& text : {also_text(page, l), since_text(page, l)})
    if (!text.empty()) more += " " + text;
  return {whole_days(says(page, l, "says").text) + with_whole_days(more).text};
}

void add_line(View& view, const Page& page, const WorkItem& l) {
  using State = WorkItem::State;
  const char* kind = name_of(l.kind);
  const std::string what = l.state == State::fixed ? "fixed" : kind;
  View& line = view.add("line");
  line.set("state", l.state == State::known   ? "known"
                    : l.state == State::fixed ? "fixed"
                                              : "fresh");
  line.set("id", l.id).set("kind", kind).set("customer", l.customer).set("machine", l.machine);
  line.set("axis", l.axis).set("what", what);
  line.set("what_text", page.words.get("site.kind." + what));
  line.set("where", l.machine.empty() ? l.campaign : l.machine);
  line.set("where_link",
           l.machine.empty() ? from_root(page, l.link) : machine_link(page, l.machine));
  line.set("quantity", quantity_text(page, l));
  line.set("value", shows_value(l) ? value_text(page, *l.value, l.u, l.unit, l.limit) : "");
  line.set("value_link", l.value ? from_root(page, l.link) : "");
  line.set("limit", l.value ? limit_text(page, l) : "");
  line.set("says", all_it_says(page, l));
  if (l.state == State::known)
    line.set("advice", page.words.get("site.acknowledged",
                                      {{"by", l.by}, {"until", l.until}, {"why", l.why}}));
  else
    line.set("advice", says(page, l, "advice"));
}

void add_lines(View& view, const Page& page) {
  const auto shown = shown_lines(page);
  view.flag("lines", !shown.empty());
  if (shown.empty())
    view.set("nothing", page.words.get(page.site.judged ? "site.nothing" : "site.not_judged"));
  for (const WorkItem& l : shown) add_line(view, page, l);
  if (const std::size_t more = page.site.lines.size() - shown.size(); more > 0)
    view.set("more_lines", page.words.get("site.and_more", {{"count", std::to_string(more)}}));
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

/// A letter in addition to the color, for color blindness.
void add_cell(View& row, const Page& page, const std::string& month, const MonthOfMachine* m) {
  View& cell = row.add("cell");
  if (m == nullptr) {
    cell.set("about", "").set("sign", "");
    return;
  }
  const std::string word = m->gravest
                               ? page.words.get("site.kind." + std::string(name_of(*m->gravest)))
                               : page.words.get(m->measured ? "site.measured" : "site.happened");
  cell.set("sign", m->event ? "●" : m->gravest ? word.substr(0, 1) : "");
  cell.set("look", m->gravest ? style_of(*m->gravest) : m->measured ? "fine" : "");
  cell.set("about", m->machine + ", " + month_text(page, month) + ": " + word);
}

void add_strip(View& view, const Page& page) {
  std::set<std::string> months;
  std::map<std::string, std::map<std::string, const MonthOfMachine*>> cells;
  for (const MonthOfMachine& m : page.site.months) {
    months.insert(m.month);
    cells[m.machine][m.month] = &m;
  }
  view.flag("strip", !months.empty());
  while (months.size() > most_months) months.erase(months.begin());
  std::set<std::string> first;
  for (const WorkItem& l : page.site.lines)
    if (first.size() < most_machines && cells.contains(l.machine)) first.insert(l.machine);
  for (const auto& [machine, of] : cells)
    if (first.size() < most_machines) first.insert(machine);
  std::string year;
  for (const std::string& month : months) {
    const bool same = month.substr(0, 4) == year;
    year = month.substr(0, 4);
    view.add("month")
        .set("month", month_text(page, month))
        .set("year", same ? "" : month.substr(2, 2));
  }
  for (const std::string& machine : first) {
    View& row = view.add("row");
    row.set("machine", machine).set("link", machine_link(page, machine));
    const auto& of = cells.at(machine);
    for (const std::string& month : months) {
      const auto at = of.find(month);
      add_cell(row, page, month, at == of.end() ? nullptr : at->second);
    }
  }
  if (const std::size_t more = cells.size() - first.size(); more > 0)
    view.set("more_machines",
             page.words.get("site.more_machines", {{"count", std::to_string(more)}}));
}

constexpr std::size_t most_sparks = 10;

std::vector<const WorkItem*> drawn_lines(const SiteHistory& site) {
  std::vector<const WorkItem*> out;
  std::set<std::string> seen;
  for (const WorkItem& l : site.lines)
    if (out.size() < most_sparks && machine_in(site, l.machine) != nullptr &&
        seen.insert(l.machine + ' ' + l.axis).second)
      out.push_back(&l);
  return out;
}

void add_sparks(View& view, const Page& page) {
  bool any = false;
  for (const WorkItem* l : drawn_lines(page.site)) {
    View* row = nullptr;
    for (const char* quantity : {"A", "B", "R"}) {
      const auto& all = machine_of(page, l->machine)->series;
      const auto series = std::find_if(all.begin(), all.end(), [&](const HistorySeries& s) {
        return s.axis == l->axis && s.quantity == quantity;
      });
      if (series == all.end() || series->points.empty()) continue;
      if (row == nullptr) row = &view.add("spark");
      const HistoryPoint& last = series->points.back();
      row->add("series")
          .set("drawing", spark_line(page, *series))
          .set("value", quantity + (" " + value_text(page, last.value, last.u, series->unit)));
    }
    if (row == nullptr) continue;
    any = true;
    row->set("machine", l->machine).set("axis", l->axis);
    row->set("link", machine_link(page, l->machine));
  }
  view.flag("sparks", any);
}

}  // namespace

Expected<std::string> index_page(const Page& page) {
  View view = page_view(page, page.words.get("site.worklist"),
                        page.words.get("site.night", {{"night", std::to_string(page.site.run)},
                                                      {"date", page.site.date}}));
  view.set("counts", counts(page));
  add_filters(view, page);
  add_lines(view, page);
  add_sparks(view, page);
  add_strip(view, page);
  return written(page, "index", view);
}

}  // namespace nonio::reports::site

namespace nonio::reports {

std::vector<std::string> drawn_first(const SiteHistory& site) {
  std::vector<std::string> out;
  for (const WorkItem* l : site::drawn_lines(site))
    if (std::find(out.begin(), out.end(), l->machine) == out.end()) out.push_back(l->machine);
  return out;
}

}  // namespace nonio::reports
