// SPDX-License-Identifier: Apache-2.0
#include <iostream>

#include "campaign_verb.h"
#include "tables.h"
#include "verbs.h"

namespace nonio::app {

namespace {

int compare(const std::string& folder, const Common& common) {
  auto opened = open_campaign(folder, common, reading::TemplatesFor::terminal);
  if (!opened) return opened.error();
  OpenCampaign& open = *opened;
  auto parts = modelling::part_models(open.read, open.campaign().model);
  if (!parts) return complain(text_of(parts.error()));
  const modelling::ModelWords words = words_for(open, common);
  std::vector<std::string> warnings;
  for (const std::string& effect : modelling::unmeasured(open.campaign().model, *parts))
    warnings.push_back(words.unmeasured(effect));
  std::vector<Error> errors = open.read.errors;
  std::vector<modelling::Compared> all;
  for (modelling::PartModel& part : *parts) {
    auto comparison = modelling::compare_part(part);
    if (comparison) {
      all.push_back({std::move(part), std::move(*comparison)});
    } else {
      complain(text_of(comparison.error()));
      errors.push_back(comparison.error());
    }
  }
  if (parts->empty())
    complain(text_of(errors.emplace_back(modelling::nothing_to_compare(open.read))));
  for (const std::string& warning : warnings) complain(warning);
  if (common.json)
    std::cout << modelling::compare_json(all, open.campaign(), words, warnings, errors);
  else
    for (const modelling::Compared& one : all)
      print_comparison(std::cout, one, open.campaign(), words);
  return errors.empty() ? exit_done : exit_failed;
}

}  // namespace

Verb compare_verb(Common& common) {
  auto folder = std::make_shared<std::string>();
  return {.name = "compare",
          .summary = "Compares the model in campaign.toml with the measurements",
          .arguments = campaign_arguments(*folder, common),
          .footer =
              "Shows for each axis the residuals (RMS, largest residual, cross-validated RMS), "
              "the noise floor of repeated readings, the parameters with their uncertainty, and "
              "the factors that the residuals depend on: direction, position, run, time, "
              "temperature, screw or angle.",
          .examples = {"nonio model compare samples/site/02-constant-reversal"},
          .run = [folder, &common] { return compare(*folder, common); }};
}

}  // namespace nonio::app
