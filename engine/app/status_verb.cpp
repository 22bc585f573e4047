// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "batch/state/night_status.h"
#include "verbs.h"

namespace nonio::app {
using Json = nlohmann::ordered_json;
using batch::NightStatus;

namespace {

struct StatusWish {
  std::string out;
  double max_age = 36.0;  ///< h; 0: any
};

std::string night_text(const evaluation::NightOf& night) {
  return "run " + std::to_string(night.number) + (night.date.empty() ? "" : " of " + night.date);
}

std::string hours_text(double hours) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f h", hours);
  return text.data();
}

/// What is wrong; empty if all is well.
std::string trouble(const NightStatus& s, const StatusWish& wish) {
  if (s.state == NightStatus::State::cut_short)
    return night_text(s.night) + " began and did not end";
  const bool goes_on =
      s.state == NightStatus::State::running || s.state == NightStatus::State::planned;
  if (!s.last) return goes_on ? "" : "no run is complete";
  if (s.age < -60.0) return "summary.json is from the future; expected a clock that is right";
  if (wish.max_age > 0.0 && s.age > wish.max_age * 3600.0)
    return "older than " + hours_text(wish.max_age);
  return {};
}

std::string line_of(const NightStatus& s, const std::string& wrong) {
  std::string line;
  if (s.state == NightStatus::State::running)
    line = night_text(s.night) + " is running (" + s.used_by + "); ";
  if (s.state == NightStatus::State::planned)
    line = night_text(s.night) + " is planned, " + std::to_string(s.reported) + " of " +
           std::to_string(s.shards) + " shards have reported; ";
  if (s.last)
    line += night_text(s.last->night) + " is complete, " + hours_text(s.age / 3600.0) +
            " ago: " + std::to_string(s.last->seen) +
            (s.last->seen == 1 ? " campaign, " : " campaigns, ") + std::to_string(s.last->failed) +
            " failed";
  else
    line += "no run is complete yet";
  return line + (wrong.empty() ? "" : "; WRONG: " + wrong);
}

int status(const StatusWish& wish, const Common& common) {
  const auto found = batch::night_status(wish.out);
  if (!found) return complain(found.error().message);
  const std::string wrong = trouble(*found, wish);
  const int exit = wrong.empty() ? exit_done : exit_failed;
  if (common.json) {
    Json json = {{"schema", "nonio-status/1"},
                 {"well", wrong.empty()},
                 {"state", to_text(found->state)},
                 {"night", found->night.number},
                 {"date", found->night.date}};
    if (found->state == NightStatus::State::planned) {
      json["shards"] = found->shards;
      json["reported"] = found->reported;
    }
    if (!found->used_by.empty()) json["used_by"] = found->used_by;
    if (found->last)
      json["last_complete"] = {{"night", found->last->night.number},
                               {"date", found->last->night.date},
                               {"age_s", found->age},
                               {"campaigns", found->last->seen},
                               {"failed", found->last->failed}};
    if (!wrong.empty()) json["wrong"] = wrong;
    print_json(json);
  } else if (!common.quiet || !wrong.empty()) {
    std::cout << line_of(*found, wrong) << "\n";
  }
  return exit;
}

}  // namespace

Verb status_verb(Common& common) {
  struct Wish : StatusWish {
    WorklistWish list{};
    bool only_actions = false;
  };
  auto wish = std::make_shared<Wish>();
  using Takes = Argument::Takes;
  Argument age = within(
      0, 1e6,
      {"--max-age", &wish->max_age, "Largest age of the last complete run, in hours; 0: any"});
  age.shows_default = true;
  WorklistWish& list = wish->list;
  return {
      .name = "status",
      .summary = "Was the last run done, and what requires action?",
      .arguments = joined(
          {required(existing(Takes::folder, {"OUT", &wish->out, "Output folder of `nonio run`"})),
           age,
           {"--actions", &wish->only_actions,
            "Only the actions, in --json too. Exit status: 0 no action required, 1 action "
            "required, 2 error"},
           {"--since", &list.since, "Only actions since this day (YYYY-MM-DD)"},
           {"--customer", &list.customer, "Only the machines of this customer"},
           {"--language", &list.language, "de, en or it; else that of the run's summary.txt"},
           existing(Takes::folder,
                    {"--site", &list.site,
                     "The site: acknowledgements, withdrawals and events that were entered after "
                     "the run are applied already"}),
           {"--page", &list.page,
            "Print one of the pages instead: index.html, due.html, due.ics, instruments.html, "
            "compare.html, machines/NAME.html"}},
          common_arguments(common)),
      .footer =
          "The first line states number, date and age of the last run and its campaigns; with "
          "--quiet it is printed only if something is wrong. The actions follow, most urgent "
          "first: lost, failed, out of its limit, changed, soon out, overdue, indeterminate, note. "
          "Each names the machine and axis, the value with U (k = 2), the limit, since when, what "
          "to do, and the page that shows it. Known: acknowledged (`nonio machine ack`) and not "
          "changed since.\n\nExit status: 0 the last run is complete and recent enough, also while "
          "another one is running or planned; 1 a run began and did not end, or the last one is "
          "too old; 2 there was none, or it cannot be read. The age is that of OUT/summary.json.",
      .examples = {"nonio status out --max-age 26",
                   "nonio status out --actions --since 2026-11-01 --customer \"Sample Works\""},
      .run = [wish, &common] {
        wish->list.out = wish->out;
        if (wish->only_actions || !wish->list.page.empty())
          return print_worklist(wish->list, common);
        const int exit = status(*wish, common);
        if (exit != exit_usage && !common.json && !common.quiet) print_worklist(wish->list, common);
        return exit;
      }};
}

}  // namespace nonio::app
