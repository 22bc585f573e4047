// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <iostream>
#include <memory>

#include "campaign/config/site_logs.h"
#include "laboratory/assessment/last_run.h"
#include "laboratory/store/query.h"
#include "nonio/sdk/format.h"
#include "platform/storage/json_values.h"
#include "platform/storage/nearest.h"
#include "site_words.h"
#include "text_layout.h"
#include "verbs.h"

namespace nonio::app {
using storage::Json;
namespace config = config;

namespace {

struct EventWish {
  std::string site, out;
  config::Event event;
};

struct AckWish {
  std::string site, value, U;
  config::Acknowledgement known;
  bool withdraw = false;
};

struct ForgetWish {
  std::string site, out, by, why, date;
  std::vector<std::string> campaigns;
};

int refuse_all(const std::vector<Error>& errors) {
  for (const Error& e : errors) complain(text_of(e));
  return exit_usage;
}

void say(const Common& common, const std::string& site, const char* file, const Json& entry) {
  if (common.json)
    print_json(entry);
  else if (!common.quiet)
    std::cout << SiteWords(common, language_at(site))
                     .get()("entered", {{"file", printable(site) + "/" + file}})
              << "\n";
}

int list_events(const EventWish& wish, const Common& common) {
  const auto logs = config::read_site_logs(wish.site);
  if (!logs) return refuse_all(logs.error());
  const SiteWords words(common, language_at(wish.site));
  const config::TerminalWords& say = words.get();
  Json all = Json::array();
  for (const config::Event& e : logs->events) {
    if (!wish.event.machine.empty() && e.machine != wish.event.machine) continue;
    all.push_back({{"date", e.date},
                   {"machine", e.machine},
                   {"axis", e.axis},
                   {"kind", e.kind},
                   {"text", e.text},
                   {"by", e.by},
                   {"line", e.line}});
    if (common.json) continue;
    std::cout << e.date << "  " << printable(e.machine) << "  "
              << (e.axis.empty() ? "" : printable(e.axis) + "  ")
              << nonio::words(say.templates(), say.language(), "site.event." + e.kind) << "  "
              << printable(e.text) << (e.by.empty() ? "" : "  (" + printable(e.by) + ")") << "\n";
  }
  if (common.json)
    print_json(Json{{"schema", "nonio-events/1"}, {"events", std::move(all)}});
  else if (all.empty() && !common.quiet)
    std::cout << say("events.none") << "\n";
  return exit_done;
}

int event(EventWish& wish, const Common& common) {
  config::Event& e = wish.event;
  if (e.kind.empty() && e.text.empty()) return list_events(wish, common);
  if (e.kind.empty() || e.text.empty() || e.machine.empty())
    return complain("expected --machine, --kind and --text together");
  if (e.date.empty()) e.date = today();
  if (e.date > today())
    return complain("--date: expected a day not after " + today() + ", found \"" + e.date + "\"");
  if (!wish.out.empty()) {
    store::Query known;
    known.machine = e.machine;
    known.axis = e.axis;
    if (const auto found = store::query(wish.out, known); !found)
      return complain(found.error().message);
  }
  if (const auto added = config::add_event(wish.site, e); !added) return refuse_all(added.error());
  say(common, wish.site, config::events_name,
      {{"schema", "nonio-event/1"}, {"date", e.date}, {"machine", e.machine}, {"kind", e.kind}});
  return exit_done;
}

bool take_number(const std::string& text, std::optional<double>& into) {
  if (text.empty()) return true;
  double x = 0.0;
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, x);
  if (error != std::errc() || at != end) return false;
  into = x;
  return true;
}

void put_number(Json& json, const char* name, const std::optional<double>& value) {
  if (value) json[name] = *value;
}

int list_acknowledged(const AckWish& wish, const Common& common) {
  const auto logs = config::read_site_logs(wish.site);
  if (!logs) return refuse_all(logs.error());
  const SiteWords words(common, language_at(wish.site));
  const config::TerminalWords& say = words.get();
  Json all = Json::array();
  for (const config::Acknowledgement& a : logs->acknowledged) {
    if (!wish.known.machine.empty() && a.machine != wish.known.machine) continue;
    Json one = {{"date", a.date}, {"finding", a.finding},   {"machine", a.machine},
                {"axis", a.axis}, {"quantity", a.quantity}, {"until", a.until},
                {"by", a.by},     {"why", a.why},           {"line", a.line}};
    put_number(one, "value", a.value);
    put_number(one, "U", a.U);
    all.push_back(std::move(one));
    if (common.json) continue;
    std::cout << say("run.range", {{"least", a.date}, {"most", a.until}}) << "  "
              << printable(a.machine) << "  " << (a.axis.empty() ? "" : printable(a.axis) + "  ")
              << printable(a.finding) << "  " << printable(a.why) << "  (" << printable(a.by)
              << ")\n";
  }
  if (common.json)
    print_json(Json{{"schema", "nonio-acknowledged/1"}, {"acknowledged", std::move(all)}});
  else if (all.empty() && !common.quiet)
    std::cout << say("acknowledged.none") << "\n";
  return exit_done;
}

int withdraw(const AckWish& wish, const Common& common) {
  const config::Acknowledgement& a = wish.known;
  if (a.finding.empty() || a.machine.empty() || a.by.empty())
    return complain("--withdraw: expected --finding, --machine and --by");
  if (!a.until.empty() || !wish.value.empty() || !wish.U.empty())
    return complain("--withdraw takes no --until, --value and --U");
  if (const auto added = config::add_withdrawal(
          wish.site, {a.date, a.finding, a.machine, a.axis, a.quantity, a.by, a.why});
      !added)
    return refuse_all(added.error());
  say(common, wish.site, config::acknowledged_name,
      {{"schema", "nonio-ack/1"},
       {"finding", a.finding},
       {"machine", a.machine},
       {"withdrawn", true}});
  return exit_done;
}

/// Whether `finding`, the id of a finding or of a line of the worklist, is one that a run can give.
bool is_known(const Templates& templates, const std::string& finding) {
  const std::string id = finding.substr(0, finding.find(':'));
  return id.starts_with("morning.") ||  // the former name
         (id.starts_with("worklist.") &&
          !nonio::words(templates, "en", "finding." + id + ".says").empty());
}

int acknowledge(AckWish& wish, const Common& common) {
  config::Acknowledgement& a = wish.known;
  if (!wish.withdraw && a.finding.empty() && a.until.empty() && a.why.empty())
    return list_acknowledged(wish, common);
  if (a.date.empty()) a.date = today();
  if (wish.withdraw) return withdraw(wish, common);
  for (const auto& [name, text] : {std::pair("--finding", &a.finding),
                                   {"--machine", &a.machine},
                                   {"--until", &a.until},
                                   {"--by", &a.by},
                                   {"--why", &a.why}})
    if (text->empty()) return complain(std::string(name) + " is missing");
  if (a.until < a.date)
    return complain("--until: expected a day not before " + a.date + ", found \"" + a.until + "\"");
  if (!take_number(wish.value, a.value) || !take_number(wish.U, a.U))
    return complain("--value and --U: expected a number with a decimal point");
  for (const char* kind : {"worklist.failed", "worklist.lost", "worklist.history"})
    if (a.finding.starts_with(kind))
      return complain("--finding " + a.finding +
                      ": a failure or loss cannot be acknowledged; correct its cause, or record "
                      "what was removed on purpose (nonio machine remove)");
  if (const auto added = config::add_acknowledgement(wish.site, a); !added)
    return refuse_all(added.error());
  const SiteWords words(common, language_at(wish.site));
  if (!is_known(words.get().templates(), a.finding))
    complain(words.get()("acknowledged.unknown", {{"finding", printable(a.finding)}}));
  say(common, wish.site, config::acknowledged_name,
      {{"schema", "nonio-ack/1"},
       {"finding", a.finding},
       {"machine", a.machine},
       {"until", a.until}});
  return exit_done;
}

int forget(ForgetWish& wish, const Common& common) {
  if (wish.date.empty()) wish.date = today();
  if (!wish.out.empty()) {
    const auto last_run = assessment::last_run_in(wish.out);
    if (!last_run) return complain(last_run.error().message);
    std::vector<std::string> missing;
    for (const auto& one : last_run->vanished) missing.push_back(one.campaign);
    for (const std::string& campaign : wish.campaigns)
      if (std::find(missing.begin(), missing.end(), campaign) == missing.end())
        return complain("the last run in " + wish.out + " does not miss \"" + campaign + "\"" +
                        storage::suggestion(campaign, missing));
  }
  for (const std::string& campaign : wish.campaigns) {
    if (const auto added =
            config::add_forgotten(wish.site, {wish.date, campaign, wish.by, wish.why});
        !added)
      return refuse_all(added.error());
  }
  say(common, wish.site, config::forgotten_name,
      {{"schema", "nonio-forget/1"}, {"campaigns", wish.campaigns}});
  return exit_done;
}

Argument site_argument(std::string& site) {
  return required(existing(Argument::Takes::folder, {"SITE", &site, "The site"}));
}

}  // namespace

Verb event_verb(Common& common) {
  auto wish = std::make_shared<EventWish>();
  config::Event& e = wish->event;
  return {
      .name = "event",
      .summary = "Records an event of a machine: a crash, a repair, a new table",
      .arguments = joined(
          {site_argument(wish->site),
           {"--machine", &e.machine,
            "Its asset, or maker and serial, as `nonio machine list` names it"},
           {"--axis", &e.axis, "The axis concerned; default: the whole machine"},
           one_of({"crash", "repair", "compensation", "moved", "instrument", "software", "other"},
                  {"--kind", &e.kind, "Kind of event"}),
           {"--text", &e.text, "Description, one line"},
           day({"--date", &e.date, "The day, YYYY-MM-DD; default: today"}),
           {"--by", &e.by, "Name of the author of the entry"},
           existing(Argument::Takes::folder,
                    {"--out", &wish->out,
                     "Output folder of `nonio run`: a machine or axis that is not in its history "
                     "is rejected, with the nearest name"})},
          common_arguments(common)),
      .footer =
          "Without --kind and --text: lists the events, of one machine or all. Appends to "
          "SITE/events.toml. You can also edit this file; comments stay. Correct a wrong entry "
          "there. The machine's history contains the event from the next run on: a step of its "
          "values on that day is then attributed to it.",
      .examples =
          {"nonio machine event site --machine S-0042 --axis X --kind crash --date 2026-03-04 "
           "--text \"tool hit the vice\""},
      .run = [wish, &common] { return event(*wish, common); }};
}

Verb ack_verb(Common& common) {
  auto wish = std::make_shared<AckWish>();
  config::Acknowledgement& a = wish->known;
  return {
      .name = "ack",
      .summary = "Acknowledges a finding of a machine until a given day",
      .arguments = joined(
          {site_argument(wish->site),
           {"--finding", &a.finding, "Id of the line of the worklist, or of its finding"},
           {"--machine", &a.machine, "As `nonio machine list` names it"},
           {"--axis", &a.axis, "The axis; default: all"},
           {"--quantity", &a.quantity, "The quantity, such as B_mean; default: all"},
           day({"--until", &a.until, "Last day of the acknowledgement, YYYY-MM-DD"}),
           number({"--value", &wish->value,
                   "Present value of the quantity, in its unit: the finding returns if the value "
                   "changes by more than --U"}),
           number({"--U", &wish->U, "Expanded uncertainty (k = 2) of that value"}),
           {"--by", &a.by, "Name of the author of the entry"},
           {"--why", &a.why, "Reason why it is accepted until then"},
           day({"--date", &a.date, "Day of the entry, YYYY-MM-DD; default: today"}),
           {"--withdraw", &wish->withdraw,
            "Withdraw the acknowledgement with exactly this --finding, --machine, --axis "
            "and --quantity"}},
          common_arguments(common)),
      .footer =
          "Without options: lists the active acknowledgements, of one machine or of all. "
          "Appends to SITE/acknowledged.toml; comments stay. It hides nothing: the finding stays "
          "in the results and in the history. Withdrawn entries stay in the file.",
      .examples =
          {"nonio machine ack site --finding worklist.changed --machine S-0042 --axis X --until "
           "2026-06-30 --by \"B. Sample\" --why \"nut is ordered\""},
      .run = [wish, &common] { return acknowledge(*wish, common); }};
}

Verb remove_verb(Common& common) {
  auto wish = std::make_shared<ForgetWish>();
  return {
      .name = "remove",
      .summary = "Records that campaigns or files were removed from the site on purpose",
      .arguments =
          joined({site_argument(wish->site),
                  required({"CAMPAIGN", &wish->campaigns,
                            "Their ids; or paths of other files or folders of the site, "
                            "such as machines/S-0042.toml or templates"}),
                  required({"--by", &wish->by, "Name of the author of the entry"}),
                  required({"--why", &wish->why, "Reason for the removal"}),
                  existing(Argument::Takes::folder,
                           {"--out", &wish->out,
                            "Output folder of `nonio run`: a name that its last run does not miss "
                            "is rejected, with the nearest name"}),
                  day({"--date", &wish->date, "Day of the entry, YYYY-MM-DD; default: today"})},
                 common_arguments(common)),
      .footer =
          "The nightly run reports a missing campaign in every run, with exit status 1, "
          "until it is back or its removal is recorded. Appends to SITE/forgotten.toml. The "
          "results of the "
          "campaign stay in the output folder and in the history.",
      .examples = {"nonio machine remove site 2021-03-02-rossi --by \"B. Sample\" --why \"machine "
                   "was sold\""},
      .run = [wish, &common] { return forget(*wish, common); }};
}

}  // namespace nonio::app
