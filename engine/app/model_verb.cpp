// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <iostream>

#include "campaign/modelling/held_terms.h"
#include "campaign/modelling/model_json.h"
#include "campaign_verb.h"
#include "platform/storage/json_values.h"
#include "platform/storage/nearest.h"
#include "tables.h"
#include "verbs.h"

namespace nonio::app {

namespace {

struct ModelOptions {
  std::string folder, effect, measurement, lines, why, axis;
  double period_mm = 0.0;
};

int show_model(const ModelOptions& options, const Common& common) {
  auto opened = open_campaign(options.folder, common, reading::TemplatesFor::terminal);
  if (!opened) return opened.error();
  OpenCampaign& open = *opened;
  auto parts = modelling::part_models(open.read, open.campaign().model);
  if (!parts) return complain(text_of(parts.error()));
  const auto history = modelling::read_history(open.folder);
  if (!history) return complain(text_of(history.error()), exit_failed);
  const modelling::ModelWords words = words_for(open, common);
  std::vector<Error> errors = open.read.errors;
  const auto all = compare_parts(std::move(*parts), errors);
  auto document = modelling::compare_json(all, open.campaign(), words, {}, errors);
  document["history"] = modelling::steps_json(*history);
  if (common.json) {
    std::cout << storage::dump(document);
  } else {
    for (const auto& part : document.at("parts")) print_model(std::cout, part, words.terminal());
    print_history(std::cout, document.at("history"), words.terminal());
  }
  return errors.empty() ? exit_done : exit_failed;
}

std::string refusal(const OpenCampaign& open, const std::string& effect, const std::string* there,
                    bool add) {
  const std::vector<std::string>& model = open.campaign().model;
  if (add && there != nullptr) return "\"" + *there + "\" is in the model already";
  if (!add && there == nullptr)
    return "\"" + effect + "\" is not in the model" + storage::suggestion(effect, model) +
           (model.empty() ? "; it is empty" : "; there are " + storage::listed(model));
  if (!add) return {};
  const auto mistakes = modelling::model_mistakes({effect}, open.read);
  return mistakes.empty() ? std::string() : mistakes.front();
}

int change(const ModelOptions& options, const Common& common, bool add) {
  auto opened = open_campaign(options.folder, common, reading::TemplatesFor::terminal_with_library);
  if (!opened) return opened.error();
  OpenCampaign& open = *opened;
  std::string effect = modelling::entry_of(options.effect).text();
  const std::string* const there = modelling::find_effect(open.campaign().model, effect);
  if (const std::string why = refusal(open, effect, there, add); !why.empty())
    return complain(why + "; nothing was changed");
  if (!add) effect = *there;
  const auto changed = modelling::change_model(open.folder, open.read, effect, add);
  if (!changed) return complain(text_of(changed.error()), exit_failed);
  const modelling::ModelWords words = words_for(open, common);
  const auto document = modelling::change_json(*changed, open.campaign(), words);
  if (common.json)
    std::cout << storage::dump(document);
  else
    print_change(std::cout, document, words.terminal());
  return open.read.errors.empty() ? exit_done : exit_failed;
}

constexpr const char* keeps_the_rest =
    "campaign.toml keeps its comments and everything else; model-history.jsonl next to it records "
    "the change.";

Verb change_verb(const std::shared_ptr<ModelOptions>& options, Common& common, bool add) {
  const std::string name = add ? "add" : "drop";
  return {
      .name = name,
      .summary = add ? "Adds an effect to the model and shows the residuals before and after"
                     : "Removes an effect from the model",
      .arguments = joined(campaign_arguments(options->folder, common),
                          {required({"EFFECT", &options->effect,
                                     add ? "kind:axis, such as backlash:X (`nonio plugin "
                                           "list`); with a value, such as \"squareness:XY = "
                                           "12.3 arcsec\", it keeps that value and is not fitted"
                                         : "kind:axis, such as backlash:X"})}),
      .footer = keeps_the_rest,
      .examples = {"nonio model " + name + " samples/site/02-constant-reversal backlash:X"},
      .run = [options, &common, add] { return change(*options, common, add); }};
}

std::vector<std::uint32_t> lines_in(const std::string& text) {
  std::vector<std::uint32_t> out;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    std::uint32_t line = 0;
    const auto [rest, error] = std::from_chars(text.data() + begin, text.data() + end, line);
    if (error != std::errc{} || rest != text.data() + end || line == 0) return {};
    out.push_back(line);
    begin = end + 1;
  }
  return out;
}

int change_campaign(const ModelOptions& options, const Common& common,
                    const modelling::CampaignEdit& edit) {
  auto opened = open_campaign(options.folder, common, reading::TemplatesFor::terminal);
  if (!opened) return opened.error();
  OpenCampaign& open = *opened;
  const auto changed = modelling::change_campaign(open.folder, open.read, edit);
  if (!changed) return complain(text_of(changed.error()) + "; nothing was changed", exit_failed);
  const modelling::ModelWords words = words_for(open, common);
  const auto document = modelling::change_json(changed->front(), open.campaign(), words);
  if (common.json)
    std::cout << storage::dump(document);
  else
    print_step(std::cout, document.at("step"), words.terminal());
  return open.read.errors.empty() ? exit_done : exit_failed;
}

Verb exclude_verb(const std::shared_ptr<ModelOptions>& options, Common& common) {
  return {.name = "exclude",
          .summary = "Excludes readings of a measurement, with a reason",
          .arguments =
              joined(campaign_arguments(options->folder, common),
                     {required({"MEASUREMENT", &options->measurement, "Its id in campaign.toml"}),
                      required({"LINES", &options->lines, "Lines of its file, such as 57,103"}),
                      required({"--why", &options->why,
                                "The reason, in one line, such as \"beam interrupted\""})}),
          .footer = keeps_the_rest,
          .examples = {"nonio model exclude samples/site/02-constant-reversal "
                       "Z 9 --why \"beam interrupted\""},
          .run = [options, &common] {
            const auto lines = lines_in(options->lines);
            if (lines.empty())
              return complain(
                  "LINES: expected numbers with commas between them, such as 57,103; found \"" +
                  options->lines + "\"");
            return change_campaign(*options, common,
                                   {.excluded = {{options->measurement, lines, options->why}}});
          }};
}

Verb period_verb(const std::shared_ptr<ModelOptions>& options, Common& common) {
  return {.name = "period",
          .summary = "Sets the period of an axis: screw_pitch_mm",
          .arguments =
              joined(campaign_arguments(options->folder, common),
                     {required({"AXIS", &options->axis, "A linear axis of the machine, such as X"}),
                      required({"MM", &options->period_mm, "Its period in mm, such as 10"})}),
          .footer = keeps_the_rest,
          .examples = {"nonio model period samples/site/02-constant-reversal Z 10"},
          .run = [options, &common] {
            return change_campaign(*options, common,
                                   {.periods = {{options->axis, options->period_mm}}});
          }};
}

}  // namespace

Verb model_verb(Common& common) {
  auto options = std::make_shared<ModelOptions>();
  return {.name = "model",
          .summary = "The error model of a campaign, in its campaign.toml",
          .verbs = {compare_verb(common),
                    explain_verb(common),
                    change_verb(options, common, true),
                    change_verb(options, common, false),
                    exclude_verb(options, common),
                    period_verb(options, common),
                    simulate_verb(common),
                    {.name = "show",
                     .summary = "Shows the effects with their values, and the history",
                     .arguments = campaign_arguments(options->folder, common),
                     .examples = {"nonio model show samples/site/02-constant-reversal"},
                     .run = [options, &common] { return show_model(*options, common); }}}};
}

}  // namespace nonio::app
