// SPDX-License-Identifier: Apache-2.0
#include "simulate_verb.h"

#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "nonio/host/evaluate.h"
#include "nonio/host/files.h"
#include "nonio/host/plugins.h"
#include "nonio/host/simulate.h"

namespace fs = std::filesystem;

namespace nonio::app {
namespace {

constexpr int done = 0, failed = 1, usage = 2;

int complain(const std::string& message, int status) {
  std::cerr << "nonio simulate: " << message << "\n";
  return status;
}

/// Why the folder must not be written to; empty if it may.
std::string refusal(const fs::path& out, const fs::path& truth) {
  const fs::path below = truth.lexically_relative(out);
  if (!below.empty() && *below.begin() != "..")
    return "the truth would lie in the campaign's folder: " + truth.string();
  const fs::path manifest = out / host::manifest_name;
  std::error_code error;
  if (!fs::exists(manifest, error)) return {};
  const auto text = host::read_file(manifest);
  if (text && text->starts_with(host::simulated_mark)) return {};
  return out.string() + " holds a campaign that was not simulated; it is left as it is";
}

}  // namespace

CLI::App* SimulateVerb::add_to(CLI::App& cli) {
  CLI::App* verb = cli.add_subcommand(
      "simulate", "Makes a campaign from a machine with known effects, and keeps the truth apart");
  verb->add_option("SPEC", specification_,
                   "A campaign.toml with [simulation], [[cycle]] and [[effect]] (docs/simulate.md)")
      ->required()
      ->check(CLI::ExistingFile);
  verb->add_option("--out", out_, "Folder for campaign.toml and the readings")->required();
  verb->add_option("--truth", truth_,
                   "File for what was put in (default: OUT.truth.json, beside the folder)");
  verb->footer(
      "The specification is a manifest with three things more:\n"
      "  [simulation]           seed = 7             the same seed gives the same bytes\n"
      "  [[cycle]]              measurement = \"X\"    targets, runs, noise of one measurement\n"
      "  [[effect]]             name = \"backlash:X\"  b_um = -6.0\n"
      "Effects are those of `nonio plugins`, and formulas under [[model.formula]] or, to stay\n"
      "hidden, [[simulation.formula]]; each parameter has its unit in its name.\n\n"
      "Example: nonio simulate samples/simulate/worn-screw.toml --out site/worn-screw");
  return verb;
}

int SimulateVerb::run(const std::vector<fs::path>& plugin_folders, bool json, bool quiet) const {
  if (out_.empty()) return complain("--out is empty; wanted a folder", usage);
  fs::path out = fs::absolute(out_).lexically_normal();
  if (!out.has_filename()) out = out.parent_path();
  const fs::path truth = truth_.empty() ? fs::path(out.string() + ".truth.json")
                                        : fs::absolute(truth_).lexically_normal();
  if (const std::string why = refusal(out, truth); !why.empty()) return complain(why, usage);
  const auto text = host::read_file(specification_);
  if (!text) return complain(text.error().message, usage);
  host::Plugins plugins;
  plugins.load(plugin_folders);
  for (const std::string& conflict : plugins.conflicts()) return complain(conflict, usage);
  const auto made = host::simulate(*text, specification_, plugins.effects());
  if (!made) {
    for (const Error& e : made.error())
      complain(e.file + (e.line != 0 ? ", line " + std::to_string(e.line) : "") + ": " + e.message,
               usage);
    return usage;
  }
  auto written = host::publish(truth.parent_path(), {{truth.filename().string(), made->truth}});
  if (written) written = host::publish(out, made->campaign);
  if (!written) return complain(written.error().message, failed);
  if (json)
    std::cout
        << nlohmann::ordered_json{{"campaign", out.string()}, {"truth", truth.string()}}.dump()
        << "\n";
  else if (!quiet)
    std::cout << out.string() << "\nwhat is in it: " << truth.string() << "\n";
  return done;
}

}  // namespace nonio::app
