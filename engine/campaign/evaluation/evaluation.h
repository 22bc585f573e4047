// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "campaign/evaluation/evaluate.h"
#include "campaign/reading/campaign_reader.h"

/// Evaluates one campaign in four steps: `read_campaign`, `analyse`, assignment of a number
/// (optional) and `write_documents`. The process with the register runs the third step, the process
/// with the plugins all others (computing.h).
namespace nonio::evaluation {

/// If `asked` is false, neither `[run] outputs` nor the machine names the controller, and a table
/// that cannot be written is a finding instead of an error.
struct WantedController {
  const Controller* controller = nullptr;
  Settings options;
  bool asked = false;
};

struct WantedOutput {
  const Output* output = nullptr;
  Settings options;
  bool history = false;
};

struct NumberRequest {
  std::string output;
  std::vector<std::string> missing;
  OutputResult incomplete;  ///< result with the findings about traceability
};

struct AnalysedCampaign {
  reading::ReadCampaign read;
  Evaluated evaluated;
  std::vector<WantedOutput> documents;
  /// nullopt if no output is issued under a number
  std::optional<NumberRequest> number;
};

AnalysedCampaign analyse(reading::ReadCampaign read, const std::string& id,
                         const reading::Context& context, const reading::Stage& stage,
                         const reading::Twins& twins);

/// `assigned` is null without a number, `history` is null if not known.
Evaluated write_documents(AnalysedCampaign analysed, const AssignedNumber* assigned,
                          const reading::Context& context, const reading::Stage& stage,
                          const HistorySoFar* history = nullptr);

/// State shared by the steps of one campaign.
struct Work {
  const reading::Context& context;
  const reading::Stage& stage;
  const reading::ReadCampaign& read;
  std::vector<Error>& errors;

  const Campaign& campaign() const { return read.manifest->campaign; }
  void report(Error error) const;
  void locate_error(Error& error, const std::string& plugin = {}) const;
  Error error_at(std::string key, const std::string& message) const;
  /// Returns nullopt after errors, which are reported.
  std::optional<Settings> settle(const Info& info) const;
  /// Returns false after an error of the plugin, which is reported.
  bool asks_to_apply(const std::string& who, const std::string& where,
                     const std::function<bool()>& ask) const;
  /// Whether a plugin runs if neither manifest nor site names plugins.
  bool is_chosen_by_itself(const Info& info) const;
};

/// Names in a list of `[run]`; nullopt selects all plugins that apply.
using PluginNames = std::optional<std::vector<std::string>>;

/// Returns the plugins in the order of `names`; without names, the plugins that run by default.
template <class Plugin>
std::vector<const Plugin*> chosen_plugins(const Work& work, const std::vector<Plugin>& all,
                                          const PluginNames& names) {
  std::vector<const Plugin*> out;
  if (!names)
    for (const Plugin& p : all)
      if (work.is_chosen_by_itself(p.info)) out.push_back(&p);
  if (names)
    for (const std::string& name : *names)
      for (const Plugin& p : all)
        if (p.info.name == name && std::find(out.begin(), out.end(), &p) == out.end())
          out.push_back(&p);
  return out;
}

template <class Plugin>
bool has_plugin(const std::vector<Plugin>& all, const std::string& name) {
  return std::any_of(all.begin(), all.end(), [&](const Plugin& p) { return p.info.name == name; });
}

/// Reports names without a plugin, except that of the model fit, which is not a plugin.
void report_absent(const Work& work, const char* kind, const char* key, const PluginNames& names,
                   const std::function<bool(const std::string&)>& is_there);

/// `fit_models` fits the models if `[run] analyses` names the model fit or, without this list, if
/// [model] has effects.
std::vector<Results::Analysed> run_analyses(const Work& work);
std::vector<Results::Analysed> fit_models(const Work& work, std::vector<ModelFit>& models);

/// Ids of the open plausibility findings by measurement from which no table may be made.
using Doubts = std::map<std::string, std::set<std::string>>;

/// Adds the reason to each accepted finding. An accepted finding that does not occur is an error.
Doubts open_doubts(const Work& work, std::vector<Results::Analysed>& analyses);

/// Removes doubted readings and what was computed from them. Returns the measurements left out.
std::set<std::string> leave_out(const Doubts& doubts, reading::ReadCampaign& read,
                                Results& results);

template <class Names>
std::string comma_list(const Names& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// Returns a remark for each measurement that no analysis and no model uses, and for an unfitted
/// model.
std::vector<Remark> unevaluated(const reading::ReadCampaign& read, const Results& results);

/// The decision is `cannot_be_decided` for a tolerance without a value.
std::vector<Conformity> held_against_tolerances(const Campaign& campaign,
                                                const std::vector<Results::Analysed>& analyses);

void report_other_units(const Work& work, const std::vector<Results::Analysed>& analyses);

struct WantedPlugins {
  std::vector<WantedController> controllers;
  std::vector<WantedOutput> outputs;
};
WantedPlugins wanted_plugins(const Work& work, std::vector<Remark>& notes);
/// Adds the control of the machine, whose tables are recorded even if no new ones are written. Wrong
/// options of a control without output are no error.
std::vector<WantedController> with_control(const Work& work, std::vector<WantedController> wanted);
void write_tables(const Work& work, const std::vector<WantedController>& wanted,
                  const Doubts& doubts, Results& results);
/// Returns nullopt if no output is issued under a number, or after an error.
std::optional<NumberRequest> number_request(const Work& work,
                                            const std::vector<WantedOutput>& documents,
                                            const Results& results);

/// A file name that a result in `taken` already uses is an error.
Expected<void> check_output(const OutputResult& result, const std::vector<Results::Written>& taken);

}  // namespace nonio::evaluation
