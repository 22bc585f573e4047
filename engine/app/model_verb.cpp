// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iostream>

#include "campaign_verb.h"
#include "nonio/host/nearest.h"
#include "tables.h"

namespace nonio::app {

namespace {

struct ModelOptions {
  std::string folder, effect;
};

void tell(const std::string& text) { std::cerr << "nonio model: " << text << "\n"; }

int show(const ModelOptions& options, const Common& common) {
  Outcome exit;
  OpenCampaign open = open_campaign("nonio model show", options.folder, common, exit);
  if (exit) return *exit;
  auto parts = host::part_models(open.read, open.campaign().model);
  if (!parts) {
    tell(text_of(parts.error()));
    return exit_usage;
  }
  const auto history = host::read_history(open.folder);
  if (!history) {
    tell(text_of(history.error()));
    return exit_failed;
  }
  const host::ModelWords words(open.place->context.templates, "en");
  std::vector<host::Compared> all;
  std::vector<Error> errors = open.read.errors;
  for (host::PartModel& part : *parts) {
    auto comparison = host::compare_part(part);
    if (comparison) {
      all.push_back({std::move(part), std::move(*comparison)});
    } else {
      tell(text_of(comparison.error()));
      errors.push_back(comparison.error());
    }
  }
  if (common.json) {
    std::cout << host::compare_json(all, open.campaign(), words, {}, errors);
  } else {
    for (const host::Compared& one : all) print_model(std::cout, one, words);
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
    return "\"" + effect + "\" is not in the model" + host::suggestion(effect, model) +
           (model.empty() ? "; it is empty" : "; there are " + host::listed(model));
  if (!add) return {};
  const auto mistakes = host::model_mistakes({effect}, open.read);
  return mistakes.empty() ? std::string() : mistakes.front();
}

int change(const ModelOptions& options, const Common& common, bool add) {
  Outcome exit;
  OpenCampaign open =
      open_campaign(add ? "nonio model add" : "nonio model drop", options.folder, common, exit);
  if (exit) return *exit;
  if (const std::string why = refusal(open, options.effect, add); !why.empty()) {
    tell(why + "; nothing was changed");
    return exit_usage;
  }
  const auto changed = host::change_model(open.folder, open.read, options.effect, add);
  if (!changed) {
    tell(text_of(changed.error()));
    return exit_failed;
  }
  const host::ModelWords words(open.place->context.templates, "en");
  if (common.json)
    std::cout << host::change_json(*changed, open.campaign(), words);
  else
    print_change(std::cout, *changed, words);
  return open.read.errors.empty() ? exit_done : exit_failed;
}

}  // namespace

void add_model_verb(CLI::App& cli, Common& common, Outcome& outcome) {
  CLI::App* verb =
      cli.add_subcommand("model", "Shows or changes the model of a campaign, in its campaign.toml");
  verb->require_subcommand(1);
  auto options = std::make_shared<ModelOptions>();
  CLI::App* shows = verb->add_subcommand("show", "The effects with their values, and the history");
  add_campaign_arguments(*shows, options->folder, common);
  shows->callback([options, &common, &outcome] { outcome = show(*options, common); });
  for (const bool add : {true, false}) {
    CLI::App* one = verb->add_subcommand(
        add ? "add" : "drop", add ? "Puts an effect into the model; what is left before and after"
                                  : "Takes an effect out of the model: the reverse of add");
    add_campaign_arguments(*one, options->folder, common);
    one->add_option("EFFECT", options->effect, "kind:axis, such as backlash:X (`nonio plugins`)")
        ->required();
    one->footer(
        "campaign.toml keeps its comments and every other byte; the change is noted in\n"
        "model-history.jsonl beside it.\n\nExample: nonio model " +
        std::string(add ? "add" : "drop") + " samples/site/02-constant-reversal backlash:X");
    one->callback([options, &common, &outcome, add] { outcome = change(*options, common, add); });
  }
}

}  // namespace nonio::app
