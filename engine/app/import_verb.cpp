// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "campaign/importing/import.h"
#include "laboratory/store/identity.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "site_words.h"
#include "text_layout.h"
#include "verbs.h"

namespace nonio::app {
using storage::Json;
namespace fs = std::filesystem;

namespace {

struct ImportArguments {
  std::string folder, rule, out, reader, campaign, asset, maker, serial;
  bool partial = false, dry_run = false;
};

/// `rule` is the name of a file in .toml, otherwise a pattern.
config::Checked<importing::ImportRule> rule_of(const ImportArguments& arguments) {
  if (!arguments.rule.ends_with(".toml")) return importing::import_rule_of_pattern(arguments.rule);
  const auto text = storage::read_file(arguments.rule);
  if (!text) return tl::unexpected(std::vector<Error>{text.error()});
  return importing::parse_import_rule(*text, arguments.rule);
}

std::string machine_name(const importing::ImportedCampaign& c) {
  return store::machine_of({c.asset, c.maker, {}, c.serial});
}

Json json_of(const std::vector<importing::ImportReport::Passed>& list) {
  Json out = Json::array();
  for (const auto& p : list) out.push_back({{"file", p.file}, {"why", p.why}});
  return out;
}

void print_import_json(const importing::ImportReport& report, bool dry_run) {
  Json campaigns = Json::array();
  for (const importing::ImportedCampaign& c : report.campaigns) {
    Json files = Json::array();
    for (const importing::ImportedFile& f : c.files)
      files.push_back({{"file", f.file},
                       {"measurement", f.measurement},
                       {"axis", f.axis},
                       {"reader", f.reader},
                       {"readings", f.readings},
                       {"missing", f.missing},
                       {"assumed", f.assumed},
                       {"lacks", f.lacks}});
    campaigns.push_back({{"id", c.id},
                         {"machine", machine_name(c)},
                         {"whole", c.whole()},
                         {"written", c.written},
                         {"there", c.there},
                         {"lacks", c.lacks},
                         {"files", std::move(files)}});
  }
  print_json(Json{{"schema", "nonio-import/1"},
                  {"dry_run", dry_run},
                  {"campaigns", std::move(campaigns)},
                  {"duplicates", json_of(report.duplicates)},
                  {"excluded", json_of(report.excluded)},
                  {"unmatched", json_of(report.unmatched)}});
}

void print_line(std::size_t indent, const std::string& text) {
  std::cout << wrapped(text, indent, sentence_width(STDOUT_FILENO), 2);
}

void print(const char* title, const std::vector<importing::ImportReport::Passed>& list,
           const config::TerminalWords& say) {
  constexpr std::size_t most = 20;
  if (!list.empty()) print_line(0, say(title));
  for (std::size_t i = 0; i < std::min(list.size(), most); ++i)
    print_line(2, list[i].file + ": " + list[i].why);
  if (list.size() > most)
    print_line(2, say("import.more", {{"count", std::to_string(list.size() - most)}}));
}

const char* state_of(const importing::ImportedCampaign& c) {
  if (c.there) return "there";
  if (c.whole()) return c.written ? "written" : "complete";
  return c.written ? "partly" : "lacking";
}

void print(const importing::ImportedFile& f, const config::TerminalWords& say) {
  if (!f.same_as.empty()) return print_line(2, f.file + ": " + f.lacks.front());
  print_line(2, say("import.file", {{"file", f.file},
                                    {"measurement", f.measurement},
                                    {"axis", f.axis.empty() ? "?" : f.axis},
                                    {"reader", f.reader.empty() ? "?" : f.reader},
                                    {"readings", std::to_string(f.readings)},
                                    {"missing", std::to_string(f.missing)}}));
  for (const std::string& what : f.assumed) print_line(4, say("import.assumed", {{"what", what}}));
  for (const std::string& lack : f.lacks) print_line(4, say("import.expected", {{"what", lack}}));
}

void print(const importing::ImportReport& report, const config::TerminalWords& say) {
  for (const importing::ImportedCampaign& c : report.campaigns) {
    print_line(0, c.id + ": " + say.of("import.state", state_of(c)));
    if (c.there) continue;
    for (const std::string& lack : c.lacks) print_line(2, say("import.expected", {{"what", lack}}));
    if (machine_name(c).empty()) print_line(2, say("import.no-machine"));
    for (const importing::ImportedFile& f : c.files) print(f, say);
  }
  print("import.duplicates", report.duplicates, say);
  print("import.excluded", report.excluded, say);
  print("import.unmatched", report.unmatched, say);
  if (!report.campaigns.empty()) print_line(0, say("import.verify"));
}

int import_files(const ImportArguments& arguments, const Common& common) {
  auto rule = rule_of(arguments);
  if (!rule) {
    for (const Error& e : rule.error()) complain(text_of(e));
    return exit_usage;
  }
  if (!arguments.reader.empty()) rule->reader = arguments.reader;
  if (!arguments.campaign.empty()) rule->campaign = arguments.campaign;
  loader::Plugins plugins;
  plugins.load(common.plugin_folders());
  for (const std::string& conflict : plugins.conflicts()) return complain(conflict);
  const SiteWords words(common, common.json ? "en" : language_at(arguments.out));
  const auto report = importing::import_folder(
      {arguments.folder, fs::absolute(arguments.out), *rule, words.get(), arguments.asset,
       arguments.maker, arguments.serial, arguments.partial, arguments.dry_run},
      plugins);
  if (!report) return complain(report.error().message);
  if (common.json)
    print_import_json(*report, arguments.dry_run);
  else if (!common.quiet)
    print(*report, words.get());
  bool whole = !report->campaigns.empty();
  for (const importing::ImportedCampaign& c : report->campaigns) whole = whole && c.whole();
  if (report->campaigns.empty()) complain("no file follows the pattern " + rule->pattern);
  return whole ? exit_done : exit_failed;
}

}  // namespace

Verb import_verb(Common& common) {
  auto arguments = std::make_shared<ImportArguments>();
  using Takes = Argument::Takes;
  return {
      .name = "import",
      .summary = "Makes campaigns from a folder of instrument files, by a rule for their names",
      .arguments = joined(
          {required(existing(Takes::folder, {"FOLDER", &arguments->folder,
                                             "Folder with the files; subfolders are included"})),
           required(takes(Takes::file,
                          {"--rule", &arguments->rule,
                           "Rule for the names: a pattern such as {machine}_{axis}_{date}.rtl, or "
                           "a file RULE.toml with pattern, campaign, kind, reader, exclude, axis, "
                           "[axes] and [manifest]"})),
           required(takes(Takes::folder,
                          {"--out", &arguments->out, "Site in which each campaign gets a folder"})),
           {"--reader", &arguments->reader, "Reader for all files (default: chosen by content)"},
           {"--campaign", &arguments->campaign, "Id of the campaigns, such as {date}-{machine}"},
           {"--asset", &arguments->asset,
            "The machine's name in the laboratory, for all campaigns"},
           {"--maker", &arguments->maker, "Its maker; with the serial number it names the machine"},
           {"--serial", &arguments->serial, "Its serial number"},
           {"--partial", &arguments->partial,
            "Write incomplete campaigns too, with comments for missing data"},
           {"--dry-run", &arguments->dry_run, "Print what would be done; write nothing"}},
          common_arguments(common)),
      .footer =
          "Placeholders of a pattern: {axis} (capital letters and digits; x or y2 is X or Y2), "
          "{date} (20240302 or 2024-03-02), {machine} (its model), {maker}, {serial}, {asset}, "
          "{id} (of the measurement), any other name in small letters, {*} for any text, also "
          "empty. A placeholder that occurs twice must match the same text. A pattern with / "
          "applies to the path below FOLDER, otherwise to the file name. A name that can be read "
          "in two ways is not imported, nor is a second file with the same content. Every file is "
          "read as in a nightly run; a campaign is written if nothing is missing. Existing files "
          "are never changed; files that were imported before are skipped without an error.",
      .examples = {"nonio import laser --rule '{machine}_{axis}_{date}.rtl' --out site --dry-run"},
      .run = [arguments, &common] { return import_files(*arguments, common); }};
}

}  // namespace nonio::app
