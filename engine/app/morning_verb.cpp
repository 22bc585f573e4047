// SPDX-License-Identifier: Apache-2.0
// `nonio morning`: what the last night asks of people, one line a decision.
#include <algorithm>
#include <iostream>
#include <memory>

#include "host/config/template_files.h"
#include "host/morning/assess.h"
#include "verbs.h"

namespace nonio::app {

namespace {

constexpr const char* morning_name = "nonio morning";

struct MorningWish {
  std::string out, since, customer, language;
};

/// Leaves out what was known before that day, and other customers' machines.
void keep_lines(const MorningWish& wish, reports::SiteHistory& site) {
  std::erase_if(site.lines, [&](const reports::MorningLine& l) {
    return (!wish.customer.empty() && l.customer != wish.customer) ||
           (!wish.since.empty() && !l.since.empty() && l.since < wish.since);
  });
}

int say_morning(const MorningWish& wish, const Common& common) {
  if (!wish.since.empty() && !is_day(wish.since))
    return complain(morning_name,
                    "--since: expected a day as YYYY-MM-DD, found \"" + wish.since + "\"");
  const auto tonight = host::morning::tonight_in(wish.out);
  if (!tonight) return complain(morning_name, tonight.error().message);
  std::string digest;
  const auto templates = host::config::read_templates(common.template_folders(), digest);
  if (!templates) return complain(morning_name, templates.error().message);
  const auto assessment = host::morning::Assessment::of(
      wish.out, *tonight, [] {}, host::morning::Assessment::Kept::used);
  if (!assessment) return complain(morning_name, assessment.error().message);
  reports::SiteHistory site = assessment->site();
  keep_lines(wish, site);
  const bool asks = std::any_of(site.lines.begin(), site.lines.end(), reports::asks);
  if (common.json) {
    std::cout << "{\n \"schema\": \"nonio-morning/1\",\n \"night\": " << tonight->night
              << ",\n \"date\": \"" << tonight->date
              << "\",\n \"lines\": " << host::morning::lines_json(site, *templates) << "\n}\n";
    return asks ? exit_failed : exit_done;
  }
  std::string language = wish.language.empty() ? tonight->language : wish.language;
  if (!templates->tables.contains("words/" + language + "/site")) {
    if (!wish.language.empty())
      return complain(morning_name, "--language: there are no words/" + language +
                                        "/site.toml; expected de, en or it");
    language = "en";
  }
  const auto text = reports::morning_text(site, *templates, language, site.lines.size());
  if (!text) return complain(morning_name, text.error().message);
  std::cout << *text;
  return asks ? exit_failed : exit_done;
}

}  // namespace

Verb morning_verb(Common& common) {
  auto wish = std::make_shared<MorningWish>();
  return {
      .name = "morning",
      .summary = "What the last night asks of people: one line a decision",
      .arguments =
          joined({required(existing(Argument::Takes::folder,
                                    {"OUT", &wish->out, "Output folder of `nonio run`"})),
                  {"--since", &wish->since, "Only what began on this day (YYYY-MM-DD) or later"},
                  {"--customer", &wish->customer, "Only the machines of this customer"},
                  {"--language", &wish->language, "de, en or it; else as the night's summary.txt"}},
                 common_arguments(common)),
      .footer =
          "In the order of what it costs to overlook a line: lost, failed, out of its limit, "
          "changed,\n"
          "soon out, overdue, undecided, note. Known: acknowledged (nonio ack) and not moved "
          "since.\n"
          "A line names the machine and axis, the value with U (k = 2), the limit, since when it "
          "is\n"
          "so, what to look at, and the page that shows it. The pages of the site say the same:\n"
          "OUT/index.html.\n\n"
          "Exit status: 0 nothing asks for a decision; 1 some line does; 2 "
          "error.\n\n"
          "Examples: nonio morning out\n"
          "          nonio morning out --since 2026-11-01 --customer \"Sample Works\"",
      .run = [wish, &common] { return say_morning(*wish, common); }};
}

}  // namespace nonio::app
