// SPDX-License-Identifier: Apache-2.0
#include <iostream>

#include "campaign/evaluation/evaluate.h"
#include "campaign/loader/plugins.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "simulation/simulate.h"
#include "verbs.h"

namespace nonio::app {
namespace fs = std::filesystem;

namespace {

struct SimulateWish {
  std::string specification, out, truth;
};

std::string not_to_be_written(const fs::path& out, const fs::path& truth) {
  const fs::path below = truth.lexically_relative(out);
  if (!below.empty() && *below.begin() != "..")
    return "the truth would lie in the campaign's folder: " + truth.string();
  const fs::path manifest = out / config::manifest_name;
  std::error_code error;
  if (!fs::exists(manifest, error)) return {};
  const auto text = storage::read_file(manifest);
  if (text && text->starts_with(simulation::simulated_mark)) return {};
  return out.string() + " holds a campaign that was not simulated; it is left as it is";
}

int simulate(const SimulateWish& w, const Common& common) {
  if (w.out.empty()) return complain("--out is empty; expected a folder");
  fs::path out = fs::absolute(w.out).lexically_normal();
  if (!out.has_filename()) out = out.parent_path();
  const fs::path truth = w.truth.empty() ? fs::path(out.string() + ".truth.json")
                                         : fs::absolute(w.truth).lexically_normal();
  if (const std::string why = not_to_be_written(out, truth); !why.empty()) return complain(why);
  const auto text = storage::read_file(w.specification);
  if (!text) return complain(text.error().message);
  loader::Plugins plugins;
  plugins.load(common.plugin_folders());
  for (const std::string& conflict : plugins.conflicts()) return complain(conflict);
  const auto made =
      simulation::simulate(*text, w.specification, plugins.effects(), plugins.methods());
  if (!made) {
    for (const Error& e : made.error())
      complain(e.file + (e.line != 0 ? ", line " + std::to_string(e.line) : "") + ": " + e.message);
    return exit_usage;
  }
  auto written = storage::publish(truth.parent_path(), {{truth.filename().string(), made->truth}});
  if (written) written = storage::publish(out, made->campaign);
  if (!written) return complain(written.error().message, exit_failed);
  if (common.json)
    std::cout << storage::Json{{"campaign", out.string()}, {"truth", truth.string()}}.dump()
              << "\n";
  else if (!common.quiet)
    std::cout << out.string() << "\ntrue values: " << truth.string() << "\n";
  return exit_done;
}

}  // namespace

Verb simulate_verb(Common& common) {
  auto wish = std::make_shared<SimulateWish>();
  using Takes = Argument::Takes;
  return {
      .name = "simulate",
      .summary =
          "Simulates a campaign of a machine with known effects and stores the true values "
          "separately",
      .arguments = joined(
          {required(existing(
               Takes::file,
               {"SPEC", &wish->specification,
                "A campaign.toml with [simulation], [[cycle]] and [[effect]] (docs/simulate.md)"})),
           required(takes(Takes::folder,
                          {"--out", &wish->out, "Folder for campaign.toml and the readings"})),
           takes(Takes::file,
                 {"--truth", &wish->truth,
                  "File for the true values (default: OUT.truth.json, next to the folder)"})},
          common_arguments(common)),
      .footer =
          "The specification is a manifest with three additional tables:\n  [simulation]           "
          "seed = 7             the same seed gives the same bytes\n  [[cycle]]              "
          "measurement = \"X\"    targets, runs, noise of one measurement\n  [[effect]]            "
          " name = \"backlash:X\"  b_um = -6.0\nEffects are those of `nonio plugin list`, and "
          "formulas under [[model.formula]] or, if they must not appear in the campaign, "
          "[[simulation.formula]]. The name of a parameter ends with its unit.",
      .examples = {"nonio model simulate samples/simulate/worn-screw.toml --out site/worn-screw"},
      .run = [wish, &common] { return simulate(*wish, common); }};
}

}  // namespace nonio::app
