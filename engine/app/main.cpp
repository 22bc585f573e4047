// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common.h"
#include "nonio/host/plugins.h"
#include "nonio/host/run.h"
#include "progress.h"
#include "simulate_verb.h"

namespace fs = std::filesystem;
using namespace nonio;
using namespace nonio::app;
using Json = nlohmann::ordered_json;

namespace {

const char* to_text(host::CampaignState::Action action) {
  switch (action) {
    case host::CampaignState::Action::todo:
      return "to do";
    case host::CampaignState::Action::done:
      return "done";
    case host::CampaignState::Action::unchanged:
      break;
  }
  return "unchanged";
}

void print_plan(const host::Night& night, bool json) {
  for (const host::CampaignState& c : night.campaigns) {
    const bool collides = c.action == host::CampaignState::Action::todo && c.status == "failed";
    const std::string reason = collides ? c.errors.front().message : c.reason;
    if (json)
      std::cout << Json{{"id", c.id},
                        {"folder", c.folder},
                        {"action", collides ? "refused" : to_text(c.action)},
                        {"reason", reason}}
                       .dump()
                << "\n";
    else
      std::cout << (collides ? "refused" : to_text(c.action)) << "  " << c.id << ": " << reason
                << "\n";
  }
}

void print_summary(const host::Night& night, const fs::path& out, bool json) {
  std::size_t done = 0, unchanged = 0, attention = 0, failed = 0;
  for (const host::CampaignState& c : night.campaigns) {
    if (c.status == "failed")
      ++failed;
    else if (c.action == host::CampaignState::Action::done)
      ++done;
    else
      ++unchanged;
    if (c.status == "attention") ++attention;
  }
  if (json)
    std::cout << Json{{"event", "end"},         {"done", done},
                      {"unchanged", unchanged}, {"attention", attention},
                      {"failed", failed},       {"summary", (out / "summary.json").string()}}
                     .dump()
              << "\n";
  else
    std::cout << done << " done, " << unchanged << " unchanged, " << failed << " failed; "
              << attention << (attention == 1 ? " asks" : " ask")
              << " for attention: " << (out / "summary.txt").string() << "\n";
}

int run(host::RunOptions options, const Common& common) {
  options.plugin_folders = common.plugin_folders();
  options.own_plugins = Common::own_plugins();
  options.template_folders = common.template_folders();
  options.version = NONIO_VERSION;
  struct sigaction action {};
  action.sa_handler = [](int) { host::request_stop(); };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  app::Progress progress(common.quiet, common.json);
  const host::Night night = host::run_site(options, progress.events());
  progress.end();
  if (night.end == host::Night::End::refused) {
    std::cerr << "nonio run: " << night.error << "\n";
    return exit_usage;
  }
  if (night.end == host::Night::End::interrupted) {
    std::cerr << "nonio run: interrupted; the same command goes on where it stopped\n";
    return exit_interrupted;
  }
  if (!night.error.empty()) {
    std::cerr << "nonio run: " << night.error << "\n";
    return exit_failed;
  }
  // What a night before has already said is said again: a failed campaign is never silent.
  if (!common.json && !options.dry_run) progress.still_failed(night);
  if (options.dry_run)
    print_plan(night, common.json);
  else if (!common.quiet || common.json)
    print_summary(night, options.out, common.json);
  return night.any_failed() ? exit_failed : exit_done;
}

Json option_json(const Option& o) {
  Json json = {{"name", o.name}};
  std::visit([&](const auto& v) { json["default"] = v; }, o.otherwise);
  if (!o.unit.empty()) json["unit"] = o.unit;
  if (!o.choices.empty()) json["choices"] = o.choices;
  json["help"] = o.help;
  return json;
}

struct Listed {
  const char* kind;
  const Info* info;
};

std::vector<Listed> listed(const host::Plugins& plugins) {
  std::vector<Listed> all;
  for (const auto& p : plugins.readers()) all.push_back({"reader", &p.info});
  for (const auto& p : plugins.effects()) all.push_back({"effect", &p.info});
  for (const auto& p : plugins.analyses()) all.push_back({"analysis", &p.info});
  for (const auto& p : plugins.outputs()) all.push_back({"output", &p.info});
  return all;
}

void print_plugins_json(const host::Plugins& plugins) {
  Json files = Json::array(), all = Json::array();
  for (const host::PluginFile& f : plugins.files()) {
    Json file = {{"path", f.path.string()}, {"plugins", f.brought}};
    if (!f.refused.empty()) file["refused"] = f.refused;
    files.push_back(std::move(file));
  }
  for (const Listed& p : listed(plugins)) {
    Json options = Json::array();
    for (const Option& o : p.info->options) options.push_back(option_json(o));
    all.push_back({{"kind", p.kind},
                   {"name", p.info->name},
                   {"version", p.info->version},
                   {"summary", p.info->summary},
                   {"on_request", p.info->on_request},
                   {"options", std::move(options)}});
  }
  std::cout << Json{{"abi", NONIO_ABI_TAG},
                    {"files", std::move(files)},
                    {"plugins", std::move(all)}}
                   .dump(1)
            << "\n";
}

void print_plugins(const host::Plugins& plugins, bool with_options) {
  for (const Listed& p : listed(plugins)) {
    std::cout << p.kind << " " << p.info->name << " " << p.info->version
              << (p.info->on_request ? " (on request)" : "") << "\n    " << p.info->summary << "\n";
    if (with_options)
      for (const Option& o : p.info->options)
        std::cout << "    [options." << p.info->name << "] " << o.name << " = "
                  << option_json(o)["default"].dump() << (o.unit.empty() ? "" : " " + o.unit)
                  << "\n        " << o.help << "\n";
  }
  std::cout << "\nfiles (ABI " << NONIO_ABI_TAG << ")\n";
  for (const host::PluginFile& f : plugins.files())
    std::cout << "  " << f.path.string() << (f.refused.empty() ? "" : "\n    refused: " + f.refused)
              << "\n";
}

int list_plugins(const Common& common) {
  host::Plugins plugins;
  plugins.load(common.plugin_folders());
  if (common.json)
    print_plugins_json(plugins);
  else
    print_plugins(plugins, !common.quiet);
  for (const std::string& conflict : plugins.conflicts())
    std::cerr << "nonio plugins: " << conflict << "\n";
  if (!plugins.conflicts().empty()) return exit_usage;
  const auto refused = [](const host::PluginFile& f) { return !f.refused.empty(); };
  return std::any_of(plugins.files().begin(), plugins.files().end(), refused) ? exit_failed
                                                                              : exit_done;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App cli{
      "Nonio evaluates machine-tool calibration campaigns: by the standards, with findings,\n"
      "reports and the tables that go into the machine's controller."};
  cli.set_version_flag("--version", "nonio " NONIO_VERSION);
  cli.require_subcommand(1);
  cli.footer(
      "Exit status: 0 done; 1 done, but some campaign failed; 2 usage or configuration error;\n"
      "130 interrupted.");
  Common common;

  host::RunOptions options;
  std::string site, out;
  CLI::App* run_verb = cli.add_subcommand(
      "run", "The nightly job: every campaign below SITE through its analyses and outputs");
  run_verb
      ->add_option("SITE", site, "Folder in which every folder with a campaign.toml is a campaign")
      ->required()
      ->check(CLI::ExistingDirectory);
  run_verb
      ->add_option("--out", out, "Folder for the results: one folder a campaign, and the summary")
      ->required();
  run_verb->add_option("--jobs", options.jobs, "Campaigns at a time (default: one for each core)")
      ->check(CLI::Range(1, 1024));
  run_verb->add_flag("--force", options.force, "Do every campaign again, changed or not");
  run_verb->add_flag("--dry-run", options.dry_run, "Say what would be done and why; do nothing");
  add_templates(*run_verb, common);
  add_common(*run_verb, common);
  run_verb->footer(
      "A campaign is done again only if something it depends on has changed: its files, "
      "site.toml,\n"
      "a plugin, a template, the program. A run that was killed goes on where it stopped.\n\n"
      "Example: nonio run samples/site --out out");

  CLI::App* plugins_verb =
      cli.add_subcommand("plugins", "What is loaded, with its options, and what was refused");
  add_common(*plugins_verb, common);

  Outcome outcome;
  add_certificates_verb(cli, common, outcome);
  add_compare_verb(cli, common, outcome);
  add_controllers_verb(cli, common, outcome);
  add_diff_verb(cli, common, outcome);
  add_apply_verb(cli, common, outcome);
  add_explain_verb(cli, common, outcome);
  add_import_verb(cli, common, outcome);
  add_model_verb(cli, common, outcome);
  add_plan_verb(cli, common, outcome);
  add_plugin_verb(cli, common, outcome);
  add_template_verb(cli, common, outcome);
  add_verify_verb(cli, common, outcome);

  app::SimulateVerb simulate;
  CLI::App* simulate_verb = simulate.add_to(cli);
  add_common(*simulate_verb, common);

  try {
    cli.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return cli.exit(e) == 0 ? exit_done : exit_usage;
  }
  if (outcome) return *outcome;
  if (plugins_verb->parsed()) return list_plugins(common);
  if (simulate_verb->parsed())
    return simulate.run(common.plugin_folders(), common.json, common.quiet);
  options.site = site;
  if (out.empty()) {
    std::cerr << "nonio run: --out is empty; wanted a folder\n";
    return exit_usage;
  }
  options.out = fs::absolute(out);
  return run(options, common);
}
