// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <optional>

#include "campaign/config/site_files.h"
#include "campaign/config/site_logs.h"
#include "campaign/config/template_files.h"
#include "certificates/certificate_list.h"
#include "laboratory/assessment/assess.h"
#include "laboratory/assessment/curves.h"
#include "platform/storage/json_values.h"
#include "text_layout.h"
#include "verbs.h"

namespace nonio::app {

namespace {

/// Losses and failures remain if their customer is not known.
void keep_lines(const WorklistWish& wish, reports::SiteHistory& site) {
  std::map<std::string, std::string> customer_of;
  for (const reports::MachineHistory& m : site.machines) customer_of[m.id] = m.customer;
  const auto is_of_other = [&](const reports::WorkItem& l) {
    const auto machine = customer_of.find(l.machine);
    const std::string& customer =
        l.customer.empty() && machine != customer_of.end() ? machine->second : l.customer;
    return customer.empty() ? l.kind != reports::WorkItem::Kind::lost &&
                                  l.kind != reports::WorkItem::Kind::failed
                            : customer != wish.customer;
  };
  std::erase_if(site.lines, [&](const reports::WorkItem& l) {
    return (!wish.customer.empty() && is_of_other(l)) ||
           (!wish.since.empty() && !l.since.empty() && l.since < wish.since &&
            // Its day is that of the readings, which may be withheld since later.
            l.kind != reports::WorkItem::Kind::withheld);
  });
}

/// Omits losses that a person has since recorded as intended, and takes the drafts that wait now.
void take_entered(const std::string& site, const config::SiteLogs& entered,
                  assessment::LastRun& last_run) {
  std::erase_if(last_run.vanished, [&](const assessment::LastRun::Vanished& v) {
    return std::any_of(entered.forgotten.begin(), entered.forgotten.end(),
                       [&](const config::Forgotten& f) {
                         return f.campaign == v.campaign && f.date >= last_run.date;
                       });
  });
  if (const auto drafts = certificates::waiting_campaigns(site))  // else the drafts of the run
    last_run.waiting.assign(drafts->begin(), drafts->end());
  last_run.out_of_force = certificates::out_of_force(site).value_or(std::set<std::string>());
}

/// With --page, the JSON also contains the pages about all machines.
Expected<std::string> lines_text(const WorklistWish& wish, const Templates& templates,
                                 const std::string& language, const assessment::LastRun& last_run,
                                 const reports::SiteHistory& whole,
                                 const reports::SiteHistory& site) {
  std::string text =
      "{\n \"schema\": \"nonio-morning/1\",\n \"night\": " + std::to_string(last_run.run) +
      ",\n \"date\": \"" + last_run.date +
      "\",\n \"lines\": " + assessment::lines_json(site, templates);
  if (!wish.page.empty()) {
    NONIO_TRY(const auto pages, reports::site_lists(whole, templates, language));
    storage::Json all = storage::Json::object();
    for (const Artifact& page : pages) all[page.name] = page.bytes;
    text += ",\n \"pages\": " + storage::dump_line(all);
  }
  return text + "\n}\n";
}

/// An error if there is no page `name`.
Expected<std::string> page_text(const WorklistWish& wish, const std::string& name,
                                const Templates& templates, const std::string& language,
                                assessment::Assessment& assessment) {
  const reports::SiteHistory& site = assessment.site();
  const std::string below = std::string(reports::machines_folder) + "/";
  for (std::size_t i = 0; i < site.machines.size(); ++i) {
    if (name != below + site.machines[i].file) continue;
    NONIO_TRY(auto machine, assessment.whole(i));
    machine.curves = assessment::curves_of(wish.out, machine);
    NONIO_TRY(auto page, reports::machine_page_of(site, machine, templates, language));
    return std::move(page.bytes);
  }
  NONIO_TRY(auto pages, reports::site_lists(site, templates, language));
  for (Artifact& page : pages)
    if (page.name == name) return std::move(page.bytes);
  return fail("--page: there is no page " + name +
              "; expected index.html, due.html, due.ics, instruments.html, "
              "compare.html or machines/NAME.html");
}

/// Prints the text, or the error on stderr with exit status 2.
int print(const Expected<std::string>& text, int status = exit_done) {
  if (!text) return complain(text.error().message);
  std::cout << *text;
  return status;
}

/// Replaces the signs of the pages by those of the terminal: "um" and "-".
std::string plain_signs(std::string text) {
  for (const auto& [printed, plain] :
       {std::pair{"µ", "u"}, {"\u2212", "-"}, {" °C", " degC"}, {"°", " deg"}})
    for (std::size_t at = 0; (at = text.find(printed, at)) != std::string::npos;)
      text.replace(at, std::string_view(printed).size(), plain);
  return text;
}

int status_of(const reports::SiteHistory& site) {
  return std::any_of(site.lines.begin(), site.lines.end(), reports::asks) ? exit_failed : exit_done;
}

/// Reads names of pages from stdin and prints each page as one line of JSON, so that the site is
/// assessed only once.
int print_requested(const WorklistWish& wish, const Templates& templates,
                    const std::string& language, const assessment::LastRun& last_run,
                    assessment::Assessment& assessment) {
  const reports::SiteHistory& site = assessment.site();
  for (std::string name; std::getline(std::cin, name);) {
    const auto page = name == "all" ? lines_text(wish, templates, language, last_run, site, site)
                                    : page_text(wish, name, templates, language, assessment);
    std::cout << storage::dump_line(
                     page ? storage::Json{{"page", *page}, {"status", status_of(site)}}
                          : storage::Json{{"error", page.error().message}})
              << std::endl;
  }
  return exit_done;
}

}  // namespace

int print_worklist(const WorklistWish& wish, const Common& common) {
  auto last_run = assessment::last_run_in(wish.out);
  if (!last_run) return complain(last_run.error().message);
  std::optional<config::SiteLogs> entered;
  auto folders = common.template_folders();
  if (!wish.site.empty()) {
    auto logs = config::read_site_logs(wish.site);
    if (!logs) return complain(text_of(logs.error().front()));
    entered = std::move(*logs);
    take_entered(wish.site, *entered, *last_run);
    auto with_site = config::with_site_templates(folders, wish.site);
    if (!with_site) return complain(text_of(with_site.error()));
    folders = std::move(*with_site);
  }
  std::string language = wish.language.empty() ? last_run->language : wish.language;
  const auto below = wish.page.empty() ? config::words_in(language) : std::vector<std::string>();
  const auto templates = config::read_templates(folders, {}, below);
  if (!templates) return complain(templates.error().message);
  auto assessment = assessment::Assessment::of(
      wish.out, *last_run, [] {}, assessment::Assessment::Kept::used,
      entered ? &*entered : nullptr);
  if (!assessment) return complain(assessment.error().message);
  if (!templates->tables.contains("words/" + language + "/site")) {
    if (!wish.language.empty())
      return complain("--language: there are no words/" + language +
                      "/site.toml; expected de, en or it");
    language = "en";
  }
  if (wish.page == "-") return print_requested(wish, *templates, language, *last_run, *assessment);
  if (!wish.page.empty() && !common.json)
    return print(page_text(wish, wish.page, *templates, language, *assessment));
  reports::SiteHistory site = assessment->site();
  const std::size_t all = site.lines.size();
  keep_lines(wish, site);
  if (common.json)
    return print(lines_text(wish, *templates, language, *last_run, assessment->site(), site),
                 status_of(site));
  if (site.lines.empty()) site.hidden = all;
  const auto text = reports::worklist_text(site, *templates, language, site.lines.size());
  if (!text) return complain(text.error().message);
  std::cout << wrapped(plain_signs(*text), 0, sentence_width(STDOUT_FILENO), 4);
  return status_of(site);
}

}  // namespace nonio::app
