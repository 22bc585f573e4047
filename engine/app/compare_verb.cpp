// SPDX-License-Identifier: Apache-2.0
#include <iostream>

#include "campaign_verb.h"
#include "tables.h"

namespace nonio::app {

namespace {

int compare(const std::string& folder, const Common& common) {
  Outcome exit;
  OpenCampaign open = open_campaign("nonio compare", folder, common, exit);
  if (exit) return *exit;
  auto parts = host::part_models(open.read, open.campaign().model);
  if (!parts) {
    std::cerr << "nonio compare: " << text_of(parts.error()) << "\n";
    return exit_usage;
  }
  const host::ModelWords words(open.place->context.templates, "en");
  std::vector<std::string> warnings;
  for (const std::string& effect : host::unmeasured(open.campaign().model, *parts))
    warnings.push_back(words.unmeasured(effect));
  std::vector<Error> errors = open.read.errors;
  std::vector<host::Compared> all;
  for (host::PartModel& part : *parts) {
    auto comparison = host::compare_part(part);
    if (comparison) {
      all.push_back({std::move(part), std::move(*comparison)});
    } else {
      std::cerr << "nonio compare: " << text_of(comparison.error()) << "\n";
      errors.push_back(comparison.error());
    }
  }
  for (const std::string& warning : warnings) std::cerr << "nonio compare: " << warning << "\n";
  if (common.json)
    std::cout << host::compare_json(all, open.campaign(), words, warnings, errors);
  else
    for (const host::Compared& one : all) print_comparison(std::cout, one, open.campaign(), words);
  if (parts->empty())
    std::cerr << "nonio compare: there is no measurement of an axis with readings\n";
  return errors.empty() && !parts->empty() ? exit_done : exit_failed;
}

}  // namespace

void add_compare_verb(CLI::App& cli, Common& common, Outcome& outcome) {
  CLI::App* verb =
      cli.add_subcommand("compare", "The model in campaign.toml against the measurements");
  auto folder = std::make_shared<std::string>();
  add_campaign_arguments(*verb, *folder, common);
  verb->footer(
      "For each axis: what the model leaves (RMS, largest residual, RMS on left-out runs), the\n"
      "noise floor of repeated readings, the parameters with their uncertainty, and where\n"
      "something is left: with direction, position, run, time, temperature, screw or angle.\n\n"
      "Example: nonio compare samples/site/02-constant-reversal");
  verb->callback([folder, &common, &outcome] { outcome = compare(*folder, common); });
}

}  // namespace nonio::app
