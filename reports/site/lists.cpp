// SPDX-License-Identifier: Apache-2.0
// due.html, instruments.html, compare.html: lists over all machines.
#include <algorithm>

#include "chart.h"
#include "html.h"
#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"
#include "pages.h"

namespace nonio::reports::site {

namespace {

std::vector<const MachineHistory*> by_due(const SiteHistory& site) {
  std::vector<const MachineHistory*> out;
  for (const MachineHistory& m : site.machines)
    if (!m.due.empty()) out.push_back(&m);
  std::stable_sort(out.begin(), out.end(),
                   [](const auto* a, const auto* b) { return a->due < b->due; });
  return out;
}

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

Expected<std::string> due_page(const Page& page) {
  View view = page_view(page, page.words.get("site.due"));
  View* open = nullptr;
  std::string month;
  for (const MachineHistory* m : by_due(page.site)) {
    if (const std::string now = bucket(page, m->due); open == nullptr || now != month) {
      const bool first = open == nullptr;
      open = &view.add("bucket");
      open->set("month", month = now).flag("first", first);
    }
    View& machine = open->add("machine");
    machine.set("due", with_whole_days(m->due)).set("link", "machines/" + m->file);
    machine.set("id", m->id).set("customer", m->customer).set("place", m->place);
    machine.set("why", interval_text(page, m->why_due))
        .set("proposal", proposal_text(page, m->proposal));
  }
  return written(page, "due", view);
}

std::string due_calendar(const Page& page) {
  std::string out = "BEGIN:VCALENDAR\r\nVERSION:2.0\r\nPRODID:-//Nonio//due//EN\r\n";
  for (const MachineHistory* m : by_due(page.site)) {
    if (!day_of(m->due) || !day_of(page.site.date)) continue;
    const std::string what = page.words.get("site.calibrate", {{"machine", m->id}});
    // The date of the run is the time stamp, because output must not depend on the clock.
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

Expected<std::string> instruments_page(const Page& page) {
  View view = page_view(page, page.words.get("site.instruments"));
  for (const InstrumentUse& i : page.site.instruments) {
    View& instrument = view.add("instrument");
    instrument.set("name", i.certificate.empty() ? i.name : i.name + " · " + i.certificate);
    instrument.set("note", i.valid_until.empty()
                               ? ""
                               : page.words.get(i.valid_until < page.site.date ? "site.expired"
                                                                               : "site.valid_until",
                                                {{"date", i.valid_until}}));
    instrument.set(
        "count", page.words.get("site.results_on", {{"count", std::to_string(i.results.size())}}));
    for (const auto& on : i.results) {
      View& result = instrument.add("result");
      result.set("date", with_whole_days(on.date)).set("machine", on.machine);
      result.set("campaign", on.campaign).set("link", on.link);
      result.set("number", page.site.out_of_force.contains(on.number)
                               ? page.words.get("site.out_of_force", {{"number", on.number}})
                               : on.number);
    }
  }
  return written(page, "instruments", view);
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

Expected<std::string> compare_page(const Page& page) {
  View view = page_view(page, page.words.get("site.compare"));
  view.flag("any", !page.site.comparisons.empty());
  for (const ModelComparison& c : page.site.comparisons) {
    const FollowedNumbers numbers = numbers_of(page, c);
    View& model = view.add("model");
    const std::string title = c.model + " · " + c.axis + " · " + quantity_text(page, c.quantity);
    model.set("model", c.travel ? title + " · " + travel_text(page, *c.travel) : title);
    model.set("chart", comparison_chart(page, c));
    if (c.count > c.machines.size())
      model.set("note",
                page.words.get("site.compare_some", {{"shown", std::to_string(c.machines.size())},
                                                     {"count", std::to_string(c.count)},
                                                     {"median", numbers.value(c.median, 0.0)},
                                                     {"spread", numbers.size(c.spread)}}));
    for (const auto& m : c.machines)
      model.add("machine")
          .set("id", m.machine)
          .set("value", numbers.value(m.value, m.u))
          .set("distance", short_number(page, m.z, Quantity::number));
  }
  return written(page, "compare", view);
}

}  // namespace nonio::reports::site
