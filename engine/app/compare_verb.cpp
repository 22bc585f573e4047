// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>

#include "campaign/modelling/model_json.h"
#include "campaign/modelling/model_prediction.h"
#include "campaign/modelling/readings_csv.h"
#include "campaign_verb.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "tables.h"
#include "verbs.h"

namespace nonio::app {
namespace fs = std::filesystem;

namespace {

struct CompareOptions {
  std::string csv;
  std::string model_of, zero = "free";
};

std::string write_csv(const std::string& file, const std::vector<modelling::Compared>& all) {
  const fs::path path = fs::path(file);
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const auto written =
      storage::publish(folder, {{path.filename().string(), modelling::readings_csv(all)}});
  return written ? "" : file + ": " + written.error().message;
}

int compare(const std::string& folder, const std::string& csv, const Common& common) {
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
  const bool is_empty = parts->empty();
  const auto all = compare_parts(std::move(*parts), errors);
  if (is_empty) complain(text_of(errors.emplace_back(modelling::nothing_to_compare(open.read))));
  for (const std::string& warning : warnings) complain(warning);
  if (!csv.empty() && !all.empty())
    if (const std::string why = write_csv(csv, all); !why.empty())
      return complain(why, exit_failed);
  const auto document = modelling::compare_json(all, open.campaign(), words, warnings, errors);
  if (common.json)
    std::cout << storage::dump(document);
  else
    for (const auto& part : document.at("parts"))
      print_comparison(std::cout, part, words.terminal());
  return errors.empty() ? exit_done : exit_failed;
}

int predict(const std::string& folder, const CompareOptions& options, const Common& common) {
  auto unseen = open_campaign(folder, common, reading::TemplatesFor::terminal);
  if (!unseen) return unseen.error();
  auto seen = open_campaign(options.model_of, common, reading::TemplatesFor::terminal);
  if (!seen) return seen.error();
  const bool kept = options.zero == "kept";
  const auto all = modelling::predictions(seen->read, unseen->read, kept);
  if (!all) return complain(text_of(all.error()));
  const auto document = modelling::predict_json(*all, seen->campaign(), unseen->campaign(),
                                                words_for(*unseen, common), kept);
  if (common.json)
    std::cout << storage::dump(document);
  else
    for (const auto& part : document.at("parts"))
      std::cout << part.at("says").get<std::string>() << '\n';
  return exit_done;
}

}  // namespace

Verb compare_verb(Common& common) {
  auto folder = std::make_shared<std::string>();
  auto options = std::make_shared<CompareOptions>();
  return {
      .name = "compare",
      .summary = "Compares the model in campaign.toml with the measurements",
      .arguments = joined(
          campaign_arguments(*folder, common),
          {takes(Argument::Takes::file,
                 {"--csv", &options->csv,
                  "Also write every reading with the model to this file: target, run, direction, "
                  "time, reading, model, residual, weight"}),
           {.name = "--model-of",
            .target = &options->model_of,
            .help = "Predict this campaign with the model of another one, fitted there",
            .takes = Argument::Takes::folder,
            .exists = true},
           one_of({"free", "kept"},
                  {.name = "--zero",
                   .target = &options->zero,
                   .help = "With --model-of: the zero is a new unknown, or that of the model",
                   .shows_default = true})}),
      .footer =
          "Shows for each axis the residuals (RMS, largest residual, cross-validated RMS), "
          "the noise floor of repeated readings, the parameters with their uncertainty, and "
          "the factors that the residuals depend on: direction, position, run, time, "
          "temperature, screw or angle.",
      .examples = {"nonio model compare samples/site/02-constant-reversal",
                   "nonio model compare samples/site/02-constant-reversal --csv residuals.csv"},
      .run = [folder, options, &common] {
        if (!options->model_of.empty() && !options->csv.empty())
          return complain(
              "--csv writes the readings of a fitted model; expected no --model-of with it");
        return options->model_of.empty() ? compare(*folder, options->csv, common)
                                         : predict(*folder, *options, common);
      }};
}

}  // namespace nonio::app
