// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "campaign/config/manifest.h"
#include "campaign/config/site_files.h"
#include "campaign/modelling/joint_model.h"
#include "campaign/modelling/model_json.h"
#include "campaign/reading/names.h"
#include "campaign/reading/plausibility/plausibility.h"
#include "campaign_verb.h"
#include "common.h"
#include "laboratory/assessment/residuals.h"
#include "nonio/sdk/format.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "platform/storage/nearest.h"
#include "tables.h"
#include "verbs.h"

namespace nonio::app {

namespace {

struct TogetherOptions {
  std::vector<std::string> folders;  ///< campaigns, or folders that contain campaigns
  std::string machine;               ///< asset, serial number or model; empty for every machine
  std::string page;                  ///< file for a page with the residuals; empty: none
  std::string since, until;          ///< closed interval of dates, YYYY-MM-DD; empty if unlimited
};

namespace fs = std::filesystem;

/// Links to folders and hidden folders are not searched.
std::vector<fs::path> campaigns_in(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder / config::manifest_name, error)) return {folder};
  std::vector<fs::path> out;
  fs::recursive_directory_iterator it(folder, fs::directory_options::skip_permission_denied, error);
  for (; !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name.starts_with('.') && it->is_directory(error)) it.disable_recursion_pending();
    if (name == config::manifest_name && it->is_regular_file(error))
      out.push_back(it->path().parent_path());
  }
  std::sort(out.begin(), out.end());
  return out;
}

class ExplainTogether {
 public:
  ExplainTogether(const TogetherOptions& options, const Common& common, std::uint64_t seed)
      : options_(options), common_(common), seed_(seed) {}

  int run() {
    for (const std::string& folder : options_.folders) {
      const auto found = campaigns_in(folder);
      if (found.empty()) return complain(folder + ": there is no campaign.toml in it or below it");
      for (const fs::path& campaign : found)
        if (const int status = open(campaign); status != exit_done) return status;
    }
    if (read_.size() < 2)
      return complain("expected two campaigns or more; found " + std::to_string(read_.size()) +
                      (passed_over_ > 0 ? " (" + std::to_string(passed_over_) +
                                              " are not of this machine or period)"
                                        : ""));
    std::vector<const reading::ReadCampaign*> all;
    for (const auto& one : read_) all.push_back(one.get());
    progress("explaining " + std::to_string(all.size()) + " campaigns together");
    const auto fleet =
        config::read_fleet(config::site_of(options_.folders.front()), place_->context.site);
    if (!fleet) return complain(text_of(fleet.error().front()));
    const auto found = modelling::explain_together(all, *fleet, seed_);
    if (!found) {
      complain(text_of(found.error()));
      return exit_failed;
    }
    const reading::Context& context = place_->context;
    const modelling::ModelWords words(context.templates,
                                      common_.json ? "en" : context.site.language);
    const auto document = modelling::together_json(*found, words, seed_, errors_);
    if (!options_.page.empty())
      if (const auto put = write_page(*found, words); !put) return complain(text_of(put.error()));
    if (common_.json)
      std::cout << storage::dump(document);
    else
      print_together(std::cout, document, words.terminal());
    if (!common_.json && !found->left_out.empty() && !common_.quiet)
      complain("not explained together: " + storage::listed(found->left_out));
    return errors_.empty() ? exit_done : exit_failed;
  }

 private:
  Expected<void> write_page(const modelling::FleetExplanation& found,
                            const modelling::ModelWords& words) const {
    NONIO_TRY(auto text, assessment::residuals_page(found, place_->context.templates,
                                                    words.terminal().language()));
    const fs::path path = fs::absolute(options_.page);
    return storage::publish(path.parent_path(), {{path.filename().string(), std::move(text)}});
  }

  void progress(const std::string& text) const {
    if (!common_.quiet) complain(text);
  }

  /// Campaigns of the same parent folder share plugins and templates. Returns an exit status other
  /// than 0 if the command cannot continue.
  int open(const fs::path& folder) {
    const fs::path whole = fs::weakly_canonical(folder);
    if (!seen_.insert(whole.string()).second) return exit_done;
    const fs::path parent = whole.parent_path();
    if (!place_ || parent != parent_) {
      auto place =
          reading::open_workplace(folder, common_.plugin_folders(), common_.template_folders(),
                                  NONIO_VERSION, reading::TemplatesFor::terminal);
      if (!place) return complain(text_of(place.error()));
      if (place_) earlier_.push_back(std::move(place_));
      place_ = std::move(*place);
      parent_ = parent;
    }
    auto read = std::make_unique<reading::ReadCampaign>(
        reading::read_campaign(folder, place_->context, [](const std::string&) {}));
    for (Error error : read->errors) {
      error.message = folder.string() + ": " + error.message;
      complain(text_of(errors_.emplace_back(std::move(error))));
    }
    if (!read->manifest) return exit_done;  // a campaign with an error does not stop the others
    const std::string& id = read->manifest->campaign.id;
    const auto [known, is_new] = folder_of_.emplace(id, folder.string());
    if (!is_new)
      return complain("campaign " + id + " is in " + known->second + " and in " + folder.string() +
                      ": its readings would count twice");
    if (!wanted(read->manifest->campaign))
      ++passed_over_;
    else
      read_.push_back(std::move(read));
    return exit_done;
  }

  bool wanted(const Campaign& c) const {
    const Machine& m = c.machine;
    const std::string& name = options_.machine;
    return (name.empty() || name == m.asset || name == m.serial || name == m.model) &&
           (options_.since.empty() || c.date >= options_.since) &&
           (options_.until.empty() || (!c.date.empty() && c.date <= options_.until));
  }

  const TogetherOptions& options_;
  const Common& common_;
  std::uint64_t seed_;
  std::unique_ptr<reading::Workplace> place_;
  std::vector<std::unique_ptr<reading::Workplace>> earlier_;
  fs::path parent_;
  std::set<std::string> seen_;
  std::map<std::string, std::string> folder_of_;
  std::vector<std::unique_ptr<reading::ReadCampaign>> read_;
  std::vector<Error> errors_;
  std::size_t passed_over_ = 0;
};

/// Whether the options denote one campaign: a single folder without campaigns below it, and no
/// machine or dates.
bool is_single(const TogetherOptions& options) {
  std::error_code error;
  return options.folders.size() == 1 && options.machine.empty() && options.since.empty() &&
         options.until.empty() &&
         (fs::exists(fs::path(options.folders.front()) / config::manifest_name, error) ||
          campaigns_in(options.folders.front()).empty());
}

/// Fits the model to all campaigns together and prints the result. Returns the exit status.
int explain_together(const TogetherOptions& options, const Common& common, std::uint64_t seed) {
  return ExplainTogether(options, common, seed).run();
}

constexpr std::size_t most_steps = 24;  // limit of --auto per part

struct ExplainOptions {
  TogetherOptions together;
  std::string folder;
  bool automatic = false;
  bool what_if = false, all = false, library = false;
  std::uint64_t seed = 1;
};

class Explain {
 public:
  Explain(const ExplainOptions& options, const Common& common)
      : options_(options), common_(common) {}

  int run() {
    auto opened = open_campaign(options_.folder, common_,
                                options_.automatic ? reading::TemplatesFor::terminal_with_library
                                                   : reading::TemplatesFor::terminal);
    if (!opened) return opened.error();
    open_ = std::move(*opened);
    words_.emplace(words_for(open_, common_));
    auto fleet = config::read_fleet(config::site_of(options_.folder), open_.place->context.site);
    if (!fleet) return complain(text_of(fleet.error().front()));
    fleet_ = std::move(*fleet);
    if (const int status = explain(); status != exit_done && all_.empty()) {
      if (common_.json && status == exit_failed) show();
      return status;
    }
    if (options_.automatic) add_missing();
    if (!steps_.empty()) warn_of_run();
    warn_of_readings();
    show();
    return failed_ ? exit_failed : exit_done;
  }

 private:
  void add_missing() {
    std::set<std::string> settled;
    for (;;) {
      const modelling::NextEffects next = modelling::next_effects(all_, settled);
      if (next.of == nullptr) return drop_unproven();
      const std::string part = next.of->part.part.name;
      const bool is_course = next.of->part.part.kind == model::Part::Kind::course;
      const std::size_t before = steps_.size();
      const auto added = static_cast<std::size_t>(
          std::count_if(steps_.begin(), steps_.end(), [](const auto& step) { return step.added; }));
      if (added + next.effects.size() > most_steps * all_.size()) {
        tell(std::to_string(added) + " effects were added and one is still missing; stopped");
        failed_ = true;
        return;
      }
      for (const std::string& effect : next.effects)
        if (!change(effect, true, part)) return explain_after_failure();
      if (is_course) {
        const std::size_t kept = best_step(before);
        for (std::size_t s = next.effects.size() + before; s > kept; --s)
          if (!change(next.effects[s - 1 - before], false, part)) return explain_after_failure();
        if (kept == before) settled.insert(part);
      }
      explain();
    }
  }

  /// What is shown is the model as far as it was changed.
  void explain_after_failure() {
    explain();
    failed_ = true;
  }

  /// Number of steps after which left-out blocks are predicted best: readings over time are
  /// correlated, and what describes them can predict others worse, or leave more.
  std::size_t best_step(std::size_t from) const {
    std::size_t best = from;
    auto left_out = steps_[from].cv_before;
    for (std::size_t s = from; s < steps_.size(); ++s) {
      const modelling::ModelStep& step = steps_[s];
      if (!step.cv_after || !step.rms_after || (left_out && *step.cv_after >= *left_out) ||
          (steps_[from].rms_before && *step.rms_after >= *steps_[from].rms_before))
        continue;
      best = s + 1;
      left_out = step.cv_after;
    }
    return best;
  }

  /// Removes effects that others added after them have made superfluous: those below their
  /// uncertainties, which effects that replace each other are, too, without which nothing notable
  /// changes.
  void drop_unproven() {
    std::set<std::string> needed;
    for (;;) {
      const auto weak = modelling::unproven_effects(all_);
      const auto effect = std::find_if(weak.begin(), weak.end(), [&](const std::string& name) {
        return !needed.contains(name) &&
               std::any_of(steps_.begin(), steps_.end(),
                           [&](const auto& step) { return step.added && step.effect == name; });
      });
      if (effect == weak.end()) return;
      needed.insert(*effect);
      std::vector<std::string> others = open_.campaign().model;
      std::erase(others, *effect);
      const std::vector<Error> errors = errors_;
      const bool failed = failed_;
      auto without = explained(others, all_);
      if (!without || !is_as_good(*without, *effect)) {
        errors_ = errors, failed_ = failed;
        continue;
      }
      if (!change(*effect, false)) return explain_after_failure();
      all_ = std::move(*without);
    }
  }

  /// Whether no part leaves notably more without the effect, predicts notably worse, has another
  /// verdict, or names the effect.
  bool is_as_good(const std::vector<modelling::Explained>& without,
                  const std::string& effect) const {
    constexpr double notable = 1.02;  // docs/dev/constants.md, M73
    if (without.size() != all_.size()) return false;
    const auto before = modelling::verdicts_of(all_), after = modelling::verdicts_of(without);
    for (std::size_t i = 0; i < without.size(); ++i) {
      const model::Comparison &one = all_[i].explanation.comparison,
                              &other = without[i].explanation.comparison;
      const auto& certain = after[i].certain;
      if (before[i].kind != after[i].kind || after[i].effect == effect ||
          std::find(certain.begin(), certain.end(), effect) != certain.end() ||
          other.fit.rms > notable * one.fit.rms ||
          (one.cv_rms && other.cv_rms && *other.cv_rms > notable * *one.cv_rms))
        return false;
    }
    return true;
  }

  void warn_of_run() {
    const reading::Context& context = open_.place->context;
    const auto& own = open_.read.manifest->run.analyses;
    const auto& names = own ? own : context.site.run.analyses;
    if (names && std::find(names->begin(), names->end(), reading::model_fit_name) == names->end())
      warnings_.push_back(remark_text(context.templates,
                                      common_.json ? "en" : context.site.language,
                                      Remark{"model.not-asked"}));
  }

  /// Readings with an apparent mistake have causes that no effect describes.
  void warn_of_readings() {
    const reading::Context& context = open_.place->context;
    for (const Results::Analysed& of :
         reading::implausible(open_.read, context, open_.read.inputs, {}))
      for (const Finding& f : of.evaluation.findings)
        if (f.attention)
          warnings_.push_back((of.measurement.empty() ? "" : of.measurement + ": ") +
                              finding_text(context.templates,
                                           common_.json ? "en" : context.site.language, f, "says"));
  }

  static void tell(const std::string& text) { complain(text); }

  /// The explanation of each part with these effects; those of `known` for parts with the same
  /// ones. Parts that cannot be explained are left out; their errors are in `errors_`.
  Expected<std::vector<modelling::Explained>> explained(
      const std::vector<std::string>& effects, const std::vector<modelling::Explained>& known) {
    NONIO_TRY(auto parts, modelling::part_models(open_.read, effects));
    warnings_.clear();
    for (const std::string& effect : modelling::unmeasured(effects, parts))
      warnings_.push_back(words_->unmeasured(effect));
    if (parts.empty())
      tell(text_of(errors_.emplace_back(modelling::nothing_to_compare(open_.read))));
    std::vector<modelling::Explained> out;
    for (modelling::PartModel& part : parts) {
      modelling::use_priors(
          part, config::priors_of(fleet_, open_.campaign().machine, {open_.campaign().id}));
      const auto one = std::find_if(known.begin(), known.end(), [&](const auto& k) {
        return k.part.part.name == part.part.name && k.part.names() == part.names();
      });
      auto explanation = one == known.end() ? modelling::explain_part(part, options_.seed)
                                            : Expected<model::Explanation>(one->explanation);
      if (explanation) {
        out.push_back({std::move(part), std::move(*explanation)});
        continue;
      }
      tell(text_of(explanation.error()));
      errors_.push_back(explanation.error());
      failed_ = true;
    }
    return out;
  }

  int explain() {
    const std::vector<modelling::Explained> before = std::exchange(all_, {});
    errors_ = open_.read.errors;
    failed_ = !errors_.empty();
    auto now = explained(open_.campaign().model, before);
    if (!now) {
      tell(text_of(now.error()));
      return exit_usage;
    }
    all_ = std::move(*now);
    return all_.empty() ? exit_failed : exit_done;
  }

  /// `part`: the one that the step compares, as in modelling::ModelEdit.
  bool change(const std::string& effect, bool add, const std::string& part = {}) {
    const auto change = modelling::change_model(open_.folder, open_.read, effect, add,
                                                known_ ? &*known_ : nullptr, part);
    if (!change) {
      tell(text_of(change.error()));
      failed_ = true;
      return false;
    }
    steps_.push_back(change->step);
    known_ = change->after;
    if (!common_.json) {
      std::cout << words_->terminal()("step", {{"number", std::to_string(steps_.size())}}) << ": ";
      print_change(std::cout, modelling::change_json(*change, open_.campaign(), *words_),
                   words_->terminal());
    }
    return true;
  }

  void show() {
    for (const std::string& warning : warnings_) tell(warning);
    for (modelling::Explained& e : all_)
      if (options_.what_if) e.what_if = model::foresee(e.part.part, e.explanation);
    const auto document = modelling::explain_json(all_, open_.campaign(), *words_, options_.seed,
                                                  steps_, warnings_, errors_);
    if (common_.json)
      std::cout << storage::dump(document);
    else
      for (const auto& part : modelling::parts_of(document))
        print_explanation(std::cout, part, options_.folder, options_.all, words_->terminal());
  }

  const ExplainOptions& options_;
  const Common& common_;
  OpenCampaign open_;
  std::optional<modelling::ModelWords> words_;
  config::Fleet fleet_;
  std::vector<modelling::Explained> all_;
  std::vector<modelling::ModelStep> steps_;
  std::optional<modelling::Compared> known_;
  std::vector<std::string> warnings_;
  std::vector<Error> errors_;
  bool failed_ = false;
};

int explain(ExplainOptions& options, const Common& common) {
  if (!is_single(options.together)) {
    for (const auto& [given, name] :
         {std::pair{options.automatic, "--auto"}, {options.what_if, "--what-if"}})
      if (given) return complain(std::string(name) + " is for one campaign; found several");
    return explain_together(options.together, common, options.seed);
  }
  if (!options.together.page.empty()) return complain("--page is for several campaigns; found one");
  options.folder = options.together.folders.front();
  return Explain(options, common).run();
}

}  // namespace

Verb explain_verb(Common& common) {
  auto options = std::make_shared<ExplainOptions>();
  return {
      .name = "explain",
      .summary = "Finds the effect that is missing from the model: ranked candidates and a verdict",
      .arguments = joined(
          {required(existing(Argument::Takes::folder,
                             {"CAMPAIGN", &options->together.folders,
                              "Folder of a campaign. Several, or a folder with campaigns below it: "
                              "they are explained together"})),
           templates_argument(common)},
          common_arguments(common),
          {{"--machine", &options->together.machine,
            "Of several campaigns those of this machine: asset, serial number or model"},
           day({"--since", &options->together.since,
                "Of several campaigns those from this day on (YYYY-MM-DD)"}),
           day({"--until", &options->together.until, "Of several campaigns those up to this day"}),
           takes(Argument::Takes::file,
                 {"--page", &options->together.page,
                  "Of several campaigns: also write a page with the residuals of all axes and "
                  "machined parts over position, time, temperature and order"}),
           {"--all", &options->all,
            "Every candidate that has evidence, and why an effect could not be tested"},
           {"--library", &options->library,
            "Accepted and without effect: the library of causes is always searched"},
           {"--what-if", &options->what_if,
            "Also predicts what one more run, in each order of directions, would do to the "
            "uncertainties and to the evidence"},
           {"--auto", &options->automatic,
            "While an effect is missing or significant, add it to campaign.toml; show each step"},
           {.name = "--seed",
            .target = &options->seed,
            .help = "Random seed of the false-alarm estimate",
            .shows_default = true}}),
      .footer =
          "Tries every effect of the catalogue (`nonio plugin list`) that is not in the model. "
          "Verdicts: missing (an effect belongs in the model), complete (nothing missing: the "
          "model explains everything down to the noise; `nothing` in JSON), unknown (no effect "
          "explains the remaining error; it states where), unrepeatable (the readings contradict "
          "each other: check the machine first). Evidence: 2 ln of the odds that the effect exists "
          "(6: 20 to 1), for the effect alone and within the best set; - if there is "
          "none.\n\nSeveral "
          "campaigns: each axis is fitted in all "
          "of "
          "them, every line with its own zero, every campaign with its own noise and model. An "
          "effect has the same value in all, a value in each, or one before and one after a date.",
      .examples = {"nonio model explain samples/site/02-constant-reversal",
                   "nonio model explain samples/laboratory/LAB-02"},
      .run = [options, &common] { return explain(*options, common); }};
}

}  // namespace nonio::app
