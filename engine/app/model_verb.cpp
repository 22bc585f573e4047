// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iostream>

#include "campaign_verb.h"
#include "host/storage/nearest.h"
#include "tables.h"
#include "verbs.h"

namespace nonio::app {

namespace {

struct ModelOptions {
  std::string folder, effect;
};

const char* const model_name = "nonio model";

int show_model(const ModelOptions& options, const Common& common) {
  auto opened = open_campaign("nonio model show", options.folder, common,
                              host::reading::TemplatesFor::english_words);
  if (!opened) return opened.error();
  OpenCampaign& open = *opened;
  auto parts = host::modelling::part_models(open.read, open.campaign().model);
  if (!parts) return complain(model_name, text_of(parts.error()));
  const auto history = host::modelling::read_history(open.folder);
  if (!history) return complain(model_name, text_of(history.error()), exit_failed);
  const host::modelling::ModelWords words(open.place->context.templates, "en");
  std::vector<host::modelling::Compared> all;
  std::vector<Error> errors = open.read.errors;
  for (host::modelling::PartModel& part : *parts) {
    auto comparison = host::modelling::compare_part(part);
    if (comparison) {
      all.push_back({std::move(part), std::move(*comparison)});
    } else {
      complain(model_name, text_of(comparison.error()));
      errors.push_back(comparison.error());
    }
  }
  if (common.json) {
    std::cout << host::modelling::compare_json(all, open.campaign(), words, {}, errors);
  } else {
    for (const host::modelling::Compared& one : all) print_model(std::cout, one, words);
    print_history(std::cout, *history);
  }
  return errors.empty() ? exit_done : exit_failed;
}

/// Why the effect cannot be added or dropped; "" if it can.
std::string refusal(const OpenCampaign& open, const std::string& effect, bool add) {
  const std::vector<std::string>& model = open.campaign().model;
  const bool there = std::find(model.begin(), model.end(), effect) != model.end();
  if (add && there) return "\"" + effect + "\" is in the model already";
  if (!add && !there)
    return "\"" + effect + "\" is not in the model" + host::storage::suggestion(effect, model) +
           (model.empty() ? "; it is empty" : "; there are " + host::storage::listed(model));
  if (!add) return {};
  const auto mistakes = host::modelling::model_mistakes({effect}, open.read);
  return mistakes.empty() ? std::string() : mistakes.front();
}

int change(const ModelOptions& options, const Common& common, bool add) {
  auto opened = open_campaign(add ? "nonio model add" : "nonio model drop", options.folder, common,
                              host::reading::TemplatesFor::english_words);
  if (!opened) return opened.error();
  OpenCampaign& open = *opened;
  if (const std::string why = refusal(open, options.effect, add); !why.empty())
    return complain(model_name, why + "; nothing was changed");
  const auto changed = host::modelling::change_model(open.folder, open.read, options.effect, add);
  if (!changed) return complain(model_name, text_of(changed.error()), exit_failed);
  const host::modelling::ModelWords words(open.place->context.templates, "en");
  if (common.json)
    std::cout << host::modelling::change_json(*changed, open.campaign(), words);
  else
    print_change(std::cout, *changed, words);
  return open.read.errors.empty() ? exit_done : exit_failed;
}

Verb change_verb(const std::shared_ptr<ModelOptions>& options, Common& common, bool add) {
  const std::string name = add ? "add" : "drop";
  return {.name = name,
          .summary = add ? "Puts an effect into the model; what is left before and after"
                         : "Takes an effect out of the model: the reverse of add",
          .arguments = joined(campaign_arguments(options->folder, common),
                              {required({"EFFECT", &options->effect,
                                         "kind:axis, such as backlash:X (`nonio plugins`)"})}),
          .footer =
              "campaign.toml keeps its comments and every other byte; the change is noted in\n"
              "model-history.jsonl beside it.\n\nExample: nonio model " +
              name + " samples/site/02-constant-reversal backlash:X",
          .run = [options, &common, add] { return change(*options, common, add); }};
}

}  // namespace

Verb model_verb(Common& common) {
  auto options = std::make_shared<ModelOptions>();
  return {.name = "model",
          .summary = "Shows or changes the model of a campaign, in its campaign.toml",
          .verbs = {{.name = "show",
                     .summary = "The effects with their values, and the history",
                     .arguments = campaign_arguments(options->folder, common),
                     .run = [options, &common] { return show_model(*options, common); }},
                    change_verb(options, common, true),
                    change_verb(options, common, false)}};
}

}  // namespace nonio::app
