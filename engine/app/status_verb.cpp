// SPDX-License-Identifier: Apache-2.0
#include <simdjson.h>
#include <unistd.h>

#include <chrono>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <string>

#include "batch/state/run_status.h"
#include "certificates/certificate_list.h"
#include "laboratory/assessment/assess.h"
#include "nonio/sdk/error.h"
#include "nonio/sdk/format.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "site_words.h"
#include "text_layout.h"
#include "verbs.h"

namespace nonio::app {
using batch::RunStatus;
using storage::Json;

namespace {

namespace dom = simdjson::dom;

std::string label_value(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c == '\n' ? std::string("\\n") : std::string(1, c);
  }
  return out + "\"";
}

class Metrics {
 public:
  void family(const std::string& name, const std::string& help) {
    name_ = name;
    out_ += "# TYPE " + name + " gauge\n# HELP " + name + " " + help + "\n";
  }
  void value(const std::string& number, const std::string& label = "", const std::string& of = "") {
    out_ += name_ + (label.empty() ? "" : "{" + label + "=" + label_value(of) + "}") + " " +
            number + "\n";
  }
  std::string made() { return out_ + "# EOF\n"; }

 private:
  std::string out_, name_;
};

std::size_t length_of(const dom::object& json, const char* list) {
  dom::array all;
  return json[list].get(all) == simdjson::SUCCESS ? all.size() : 0;
}

std::string text_in(const dom::object& json, const char* key, std::string_view otherwise = "") {
  std::string_view text;
  return std::string(json[key].get(text) == simdjson::SUCCESS ? text : otherwise);
}

void put_lines(const dom::object& summary, Metrics& metrics) {
  std::map<std::string, std::size_t> kinds;
  for (const char* kind : {"lost", "failed", "out", "changed", "soon", "overdue", "withheld",
                           "undecided", "information"})
    kinds[kind] = 0;
  dom::array lines;
  if (summary["lines"].get(lines) == simdjson::SUCCESS)
    for (const dom::object line : lines)
      if (text_in(line, "state") == "new") ++kinds[text_in(line, "kind", "other")];
  metrics.family("nonio_worklist_lines",
                 "Lines of the worklist of the last run that are not acknowledged, by kind");
  for (const auto& [kind, count] : kinds) metrics.value(std::to_string(count), "kind", kind);
}

void put_due(const std::filesystem::path& out, Metrics& metrics) {
  using namespace std::chrono;
  const auto file = storage::read_file(out / "due.ics");
  if (!file) return;
  const std::time_t now_s = system_clock::to_time_t(system_clock::now());
  std::tm local{};  // days of a site are local
  ::localtime_r(&now_s, &local);
  const sys_days today = year(local.tm_year + 1900) / (local.tm_mon + 1) / local.tm_mday;
  const auto text_of_day = [](sys_days at) {
    const year_month_day day(at);
    return std::to_string(int(day.year()) * 10000 + unsigned(day.month()) * 100 +
                          unsigned(day.day()));
  };
  const std::string now = text_of_day(today), soon = text_of_day(today + days(30));
  std::size_t overdue = 0, near = 0;
  constexpr std::string_view key = "DTSTART;VALUE=DATE:";
  for (std::size_t at = file->find(key); at != std::string::npos; at = file->find(key, at + 1)) {
    const std::string day = file->substr(at + key.size(), now.size());
    ++(day < now ? overdue : near);
    if (day > soon) --near;
  }
  metrics.family("nonio_certificates_due",
                 "Machines whose next calibration is overdue, or due within 30 days");
  metrics.value(std::to_string(overdue), "within", "overdue");
  metrics.value(std::to_string(near), "within", "30_days");
}

/// Returns OpenMetrics text (version 1.0.0) about the last complete run of an output folder: its
/// age, the numbers of campaigns, worklist lines and drafts. An error if OUT/summary.json cannot be
/// read.
/// With `site`, drafts are those that wait now.
Expected<std::string> metrics_of(const std::filesystem::path& out, const std::string& site) {
  const auto path = out / "summary.json";
  NONIO_TRY(const auto text, storage::read_file(path));
  // simdjson is used because the summary of 100,000 campaigns can have 100 MB.
  dom::parser parser;
  dom::object summary, counts;
  if (parser.parse(text).get(summary) != simdjson::SUCCESS ||
      summary["counts"].get(counts) != simdjson::SUCCESS)
    return fail(Error{"expected the summary of a run (JSON with counts)", path.string()});
  std::error_code error;
  const auto written = std::filesystem::last_write_time(path, error);
  if (error) return fail(Error{error.message(), path.string()});
  using Seconds = std::chrono::duration<double>;
  const double age = Seconds(std::filesystem::file_time_type::clock::now() - written).count();
  const double now = Seconds(std::chrono::system_clock::now().time_since_epoch()).count();
  Metrics metrics;
  metrics.family("nonio_info", "Version of the program that made the last run");
  metrics.value("1", "version", text_in(summary, "nonio"));
  metrics.family("nonio_last_run_timestamp_seconds", "When the last complete run ended");
  metrics.value(std::to_string(static_cast<long long>(now - age)));
  metrics.family("nonio_last_run_age_seconds", "Age of the last complete run");
  metrics.value(std::to_string(static_cast<long long>(age)));
  metrics.family("nonio_last_run_number", "Number of the last complete run");
  std::int64_t number = 0;
  [[maybe_unused]] const auto stated = summary["night"].get(number);
  metrics.value(std::to_string(number));
  if (const auto status = batch::run_status(out); status && status->seconds) {
    metrics.family("nonio_last_run_seconds", "Duration of the last complete run");
    metrics.value(fixed_text(*status->seconds, 3));
  }
  metrics.family("nonio_campaigns", "Campaigns of the last run, by state");
  for (const auto& count : counts)
    if (std::int64_t n = 0; count.value.get(n) == simdjson::SUCCESS)
      metrics.value(std::to_string(n), "state", std::string(count.key));
  put_lines(summary, metrics);
  metrics.family("nonio_drafts_waiting", "Certificates that wait for an approval");
  std::size_t waiting = length_of(summary, "drafts");
  if (!site.empty()) {
    NONIO_TRY(const auto drafts, certificates::waiting_campaigns(site));
    waiting = drafts.size();
  }
  metrics.value(std::to_string(waiting));
  metrics.family("nonio_certificates_issued", "Certificates that the last run has seen issued");
  metrics.value(std::to_string(length_of(summary, "issued")));
  put_due(out, metrics);
  return metrics.made();
}

struct StatusWish {
  std::string out;
  double max_age = 36.0;  ///< limit of the age of the last complete run, h; 0 means no limit
  WorklistWish list{};
};

using config::TerminalWords;

std::string run_text(const evaluation::RunLabel& run, const TerminalWords& say) {
  const std::string number = std::to_string(run.number);
  return run.date.empty() ? say("night", {{"number", number}})
                          : say("night-of", {{"number", number}, {"date", run.date}});
}

std::string hours_text(double hours, const TerminalWords& say) {
  return localised(fixed_text(hours, 1), say.language()) + " h";
}

/// Returns the reason for exit status 1; empty for status 0.
std::string trouble(const RunStatus& s, const StatusWish& wish, const TerminalWords& say) {
  if (s.state == RunStatus::State::cut_short)
    return say("state.cut-short", {{"run", run_text(s.run, say)}});
  const bool goes_on = s.state == RunStatus::State::running || s.state == RunStatus::State::planned;
  if (!s.last) return goes_on ? "" : say("state.none");
  if (s.age < -60.0) return say("state.future");
  if (wish.max_age > 0.0 && s.age > wish.max_age * 3600.0)
    return say("state.old", {{"age", hours_text(wish.max_age, say)}});
  return {};
}

std::string line_of(const RunStatus& s, const std::string& wrong, const TerminalWords& say) {
  std::string line;
  if (s.state == RunStatus::State::running)
    line = say("state.running", {{"run", run_text(s.run, say)}, {"by", s.used_by}}) + "; ";
  if (s.state == RunStatus::State::planned)
    line = say("state.planned", {{"run", run_text(s.run, say)},
                                 {"reported", std::to_string(s.reported)},
                                 {"count", std::to_string(s.shards)}}) +
           "; ";
  if (s.last)
    line += say("state.complete", {{"run", run_text(s.last->run, say)},
                                   {"age", hours_text(s.age / 3600.0, say)},
                                   {"campaigns", say.counted("campaigns", s.last->seen)},
                                   {"failed", std::to_string(s.last->failed)}});
  else
    line += say("state.none-yet");
  return line + (wrong.empty() ? "" : "; " + say("state.wrong", {{"what", wrong}}));
}

/// Returns the language of --language, otherwise of the last run; empty before the first run.
std::string language_of(const StatusWish& wish) {
  if (!wish.list.language.empty()) return wish.list.language;
  const auto last_run = assessment::last_run_in(wish.out);
  return last_run ? last_run->language : "";
}

int print_status(const RunStatus& found, const StatusWish& wish, const Common& common) {
  // JSON is always in English.
  const SiteWords words(common, common.json ? "en" : language_of(wish));
  const std::string wrong = trouble(found, wish, words.get());
  const int exit = wrong.empty() ? exit_done : exit_failed;
  if (common.json) {
    Json json = {{"schema", "nonio-status/1"},
                 {"well", wrong.empty()},
                 {"state", to_text(found.state)},
                 {"night", found.run.number},
                 {"date", found.run.date}};
    if (found.state == RunStatus::State::planned) {
      json["shards"] = found.shards;
      json["reported"] = found.reported;
    }
    if (!found.used_by.empty()) json["used_by"] = found.used_by;
    if (found.last)
      json["last_complete"] = {{"night", found.last->run.number},
                               {"date", found.last->run.date},
                               {"age_s", found.age},
                               {"campaigns", found.last->seen},
                               {"failed", found.last->failed}};
    if (found.last && found.seconds)
      json["last_complete"]["seconds"] = rounded_to_places(*found.seconds, 1);
    if (!wrong.empty()) json["wrong"] = wrong;
    print_json(json);
  } else if (!common.quiet || !wrong.empty()) {
    std::cout << wrapped(line_of(found, wrong, words.get()), 0, sentence_width(STDOUT_FILENO), 2);
  }
  return exit;
}

}  // namespace

Verb status_verb(Common& common) {
  struct Wish : StatusWish {
    bool only_actions = false, metrics = false;
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
      .summary = "State of the last run, and what requires action",
      .arguments = joined(
          {required(existing(Takes::folder, {"OUT", &wish->out, "Output folder of `nonio run`"})),
           age,
           {"--actions", &wish->only_actions,
            "Only the actions, in --json too. Exit status: 0 no action required, 1 action "
            "required, 2 error"},
           {"--metrics", &wish->metrics,
            "OpenMetrics text for a monitoring system: age of the run, campaigns by state, actions "
            "by kind, drafts"},
           day({"--since", &list.since, "Only actions since this day (YYYY-MM-DD)"}),
           {"--customer", &list.customer, "Only the machines of this customer"},
           {"--language", &list.language, "de, en or it; else that of the run's summary.txt"},
           existing(Takes::folder,
                    {"--site", &list.site,
                     "The site: acknowledgements, withdrawals, events, removals and approvals that "
                     "were entered after the run are applied already"}),
           {"--page", &list.page,
            "Print one of the pages instead: index.html, due.html, due.ics, instruments.html, "
            "compare.html, machines/NAME.html; with --json, add the first five to the actions. -: "
            "read the names from stdin, and print each page as one line of JSON"}},
          common_arguments(common)),
      .footer =
          "The first line states number, date and age of the last run and its campaigns; with "
          "--quiet it is printed only if something is wrong. The actions follow, most urgent "
          "first: lost, failed, out of tolerance, changed, soon out of tolerance, overdue, "
          "withheld, indeterminate, info. "
          "Each names the machine and axis, the value with U (k = 2), the limit, since when, what "
          "to do, and the page that shows it. Known: acknowledged (`nonio machine ack`) and not "
          "changed since.\n\nExit status: 0 the last run is complete and recent enough, also while "
          "another one is running or planned; 1 a run began and did not end, or the last one is "
          "too old; 2 there was none, or it cannot be read. The age is that of OUT/summary.json.",
      .examples = {"nonio status out --max-age 26", "nonio status out --metrics",
                   "nonio status out --actions --since 2026-11-01 --customer \"Sample Works\""},
      .run = [wish, &common] {
        wish->list.out = wish->out;
        if (wish->metrics) {
          const auto text = metrics_of(wish->out, wish->list.site);
          if (!text) return complain(text_of(text.error()));
          std::cout << *text;
          return exit_done;
        }
        if (wish->only_actions || !wish->list.page.empty())
          return print_worklist(wish->list, common);
        const auto found = batch::run_status(wish->out);
        if (!found) return complain(found.error().message);
        const int exit = print_status(*found, *wish, common);
        if (found->last && !common.json && !common.quiet) {
          print_worklist(wish->list, common);
          if (wish->list.site.empty())
            std::cout << wrapped(SiteWords(common, language_of(*wish)).get()("entered-since"), 0,
                                 sentence_width(STDOUT_FILENO));
        }
        return exit;
      }};
}

}  // namespace nonio::app
