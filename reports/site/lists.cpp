// SPDX-License-Identifier: Apache-2.0
// due.html, instruments.html, compare.html: lists over all machines.
#include <algorithm>
#include <map>

#include "chart.h"
#include "html.h"
#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"
#include "pages.h"

namespace nonio::reports::site {

namespace {

std::string head(const Page& page, std::initializer_list<const char*> keys) {
  std::string out;
  for (const char* key : keys)
    out += element("th", html(page.words.get("site.column." + std::string(key))), "scope=\"col\"");
  return element("thead", element("tr", out));
}

std::vector<const MachineHistory*> by_due(const SiteHistory& site) {
  std::vector<const MachineHistory*> out;
  for (const MachineHistory& m : site.machines)
    if (!m.due.empty()) out.push_back(&m);
  std::stable_sort(out.begin(), out.end(),
                   [](const auto* a, const auto* b) { return a->due < b->due; });
  return out;
}

/// Work is planned by months, not by thirty days.
std::string bucket(const Page& page, const std::string& due) {
  const std::string& today = page.site.date;
  if (due < today) return page.words.get("site.overdue");
  return month_text(page, due.substr(0, 7));
}

std::string folded(std::string line) {  // RFC 5545, 3.1: at most 75 octets
  std::string out;
  while (line.size() > 73) {
    std::size_t cut = 73;
    while (cut > 0 && (static_cast<unsigned char>(line[cut]) & 0xC0U) == 0x80U) --cut;
    out += line.substr(0, cut) + "\r\n ";
    line.erase(0, cut);
  }
  return out + line + "\r\n";
}

std::string calendar_text(std::string_view text) {  // RFC 5545, 3.3.11
  std::string out;
  for (const char c : text) {
    if (c == '\\' || c == ';' || c == ',') out += '\\';
    if (c == '\n')
      out += "\\n";
    else if (static_cast<unsigned char>(c) >= 0x20)
      out += c;
  }
  return out;
}

std::string without_dashes(std::string date) {
  std::erase(date, '-');
  return date;
}

}  // namespace

std::string due_page(const Page& page) {
  std::string out, rows, open;
  const auto close = [&] {
    if (!rows.empty())
      out +=
          element("h2", html(open)) +
          scrolled(open,
                   element("table",
                           head(page, {"due", "machine", "customer", "place", "rule", "proposal"}) +
                               element("tbody", rows),
                           "class=\"due\""));
    rows.clear();
  };
  for (const MachineHistory* m : by_due(page.site)) {
    if (const std::string now = bucket(page, m->due); now != open) close(), open = now;
    rows += element("tr", element("td", with_whole_days(html(m->due))) +
                              element("td", link("machines/" + m->file, html(m->id))) +
                              element("td", html(m->customer)) + element("td", html(m->place)) +
                              element("td", html(m->why_due)) +
                              element("td", html(proposal_text(page, m->proposal))));
  }
  close();
  if (out.empty())
    out = element("p", html(page.words.get("site.no_due")));
  else
    out = element("p", link("due.ics", html(page.words.get("site.calendar")))) + out;
  return whole_page(page, page.words.get("site.due"), out);
}

std::string due_calendar(const Page& page) {
  std::string out = "BEGIN:VCALENDAR\r\nVERSION:2.0\r\nPRODID:-//Nonio//due//EN\r\n";
  for (const MachineHistory* m : by_due(page.site)) {
    if (!day_of(m->due) || !day_of(page.site.date)) continue;
    const std::string what = page.words.get("site.calibrate", {{"machine", m->id}});
    // The night's date stands for the moment: these files have no clock.
    out += "BEGIN:VEVENT\r\n" + folded("UID:" + calendar_text(m->id) + "-due@nonio") +
           folded("DTSTAMP:" + without_dashes(page.site.date) + "T000000Z") +
           folded("DTSTART;VALUE=DATE:" + without_dashes(m->due)) +
           folded("SUMMARY:" + calendar_text(what)) +
           (m->proposal.why.id == "interval.out-now"
                ? folded("DESCRIPTION:" + calendar_text(proposal_text(page, m->proposal)))
                : "") +
           folded("LOCATION:" +
                  calendar_text(m->customer + (m->place.empty() ? "" : ", " + m->place))) +
           "END:VEVENT\r\n";
  }
  return out + "END:VCALENDAR\r\n";
}

std::string instruments_page(const Page& page) {
  std::string out = element("p", html(page.words.get("site.instruments_says")));
  for (const InstrumentUse& i : page.site.instruments) {
    std::string title = i.name;
    if (!i.certificate.empty()) title += " · " + i.certificate;
    std::string note;
    if (!i.valid_until.empty())
      note = page.words.get(i.valid_until < page.site.date ? "site.expired" : "site.valid_until",
                            {{"date", i.valid_until}});
    std::string rows;
    const auto cell = [&](std::string_view inner) { ((rows += "<td>") += inner) += "</td>\n"; };
    for (const auto& on : i.results) {  // of a large site a hundred thousand
      rows += "<tr>";
      cell(with_whole_days(html(on.date)));
      cell(html(on.machine));
      cell(link(on.link, html(on.campaign)));
      cell(html(on.number));
      rows += "</tr>\n";
    }
    out += element(
        "section",
        element("h2", html(title)) + element("p", html(note)) +
            element("details",
                    element("summary",
                            html(page.words.get("site.results_on",
                                                {{"count", std::to_string(i.results.size())}}))) +
                        scrolled(title, element("table", head(page, {"date", "machine", "campaign",
                                                                     "certificate"}) +
                                                             element("tbody", rows)))));
  }
  return whole_page(page, page.words.get("site.instruments"), out);
}

namespace {

std::string travel_text(const Page& page, const ModelComparison::Travel& travel) {
  const Quantity q = travel.rotary ? Quantity::angle : Quantity::length;
  const auto text = [&](double v) {
    return fixed_text(v * unit_of(q).per_si, 0) + " " + unit_text(q);
  };
  const std::string shortest = text(travel.shortest), longest = text(travel.longest);
  return shortest == longest
             ? page.words.get("site.travel", {{"length", shortest}})
             : page.words.get("site.travels", {{"shortest", shortest}, {"longest", longest}});
}

}  // namespace

std::string compare_page(const Page& page) {
  std::string out;
  for (const ModelComparison& c : page.site.comparisons) {
    std::string rows;
    for (const auto& m : c.machines)
      rows += element(
          "tr",
          element("td", html(m.machine)) +
              element("td", html(value_text(page, m.value, m.u, c.unit)), "class=\"number\"") +
              element("td", html(short_number(page, m.z, Quantity::number)), "class=\"number\""));
    std::string title = c.model + " · " + c.axis + " · " + quantity_text(page, c.quantity);
    if (c.travel) title += " · " + travel_text(page, *c.travel);
    std::string note;
    if (c.count > c.machines.size())
      note = element(
          "p",
          html(page.words.get("site.compare_some",
                              {{"shown", std::to_string(c.machines.size())},
                               {"count", std::to_string(c.count)},
                               {"median", value_text(page, c.median, std::nullopt, c.unit)},
                               {"spread", value_text(page, c.spread, std::nullopt, c.unit)}})),
          "class=\"muted\"");
    out += element(
        "section",
        element("h2", html(title)) + note + comparison_chart(page, c) +
            element(
                "details",
                element("summary", html(page.words.get("site.numbers"))) +
                    scrolled(title, element("table", head(page, {"machine", "value", "distance"}) +
                                                         element("tbody", rows)))));
  }
  if (out.empty())
    out = element("p", html(page.words.get("site.no_compare")));
  else
    out = element("p", html(page.words.get("site.compare_says")), "class=\"muted\"") +
          element("div", out, "class=\"charts\"");
  return whole_page(page, page.words.get("site.compare"), out);
}

}  // namespace nonio::reports::site
