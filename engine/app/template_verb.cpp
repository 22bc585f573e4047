// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common.h"
#include "nonio/host/template_check.h"

namespace nonio::app {
using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

namespace {

int check(const std::string& site, const Common& common) {
  std::vector<fs::path> folders = common.template_folders();
  if (!site.empty() && fs::is_directory(fs::path(site) / "templates"))
    folders.push_back(fs::path(site) / "templates");
  const auto found = host::check_templates(folders, common.plugin_folders());
  if (!found) {
    const Error& e = found.error();
    std::cerr << "nonio template check: " << e.file
              << (e.line != 0 ? ":" + std::to_string(e.line) : "") << (e.file.empty() ? "" : ": ")
              << e.message << "\n";
    return exit_usage;
  }
  if (common.json) {
    Json errors = Json::array();
    for (const Error& e : found->errors)
      errors.push_back({{"file", e.file}, {"message", e.message}});
    std::cout << Json{{"schema", "nonio-template-check/1"},
                      {"outputs", found->outputs},
                      {"errors", std::move(errors)}}
                     .dump(1, ' ', false, Json::error_handler_t::replace)
              << "\n";
  } else {
    for (const Error& e : found->errors)
      std::cout << e.file << (e.file.empty() ? "" : ": ") << e.message << "\n";
    std::string outputs;
    for (const std::string& name : found->outputs) outputs += (outputs.empty() ? "" : ", ") + name;
    if (!common.quiet)
      std::cout << found->errors.size() << (found->errors.size() == 1 ? " error" : " errors")
                << " in the templates of " << outputs << "\n";
  }
  return found->errors.empty() ? exit_done : exit_failed;
}

}  // namespace

void add_template_verb(CLI::App& cli, Common& common, Outcome& outcome) {
  CLI::App* verb =
      cli.add_subcommand("template", "Templates of reports and certificates: are they whole?");
  verb->require_subcommand(1);
  auto site = std::make_shared<std::string>();
  CLI::App* one = verb->add_subcommand(
      "check", "Layouts, words of every language, places in braces, letters that the fonts lack");
  one->add_option("SITE", *site, "Site whose own templates/ folder is laid over the installed one")
      ->check(CLI::ExistingDirectory);
  add_templates(*one, common);
  add_common(*one, common);
  one->footer(
      "To change the look or the words for one site, copy the file from the installed templates "
      "to\n"
      "SITE/templates, edit it, and check it here before the night does.\n\n"
      "Example: nonio template check site");
  one->callback([site, &common, &outcome] { outcome = check(*site, common); });
}

}  // namespace nonio::app
