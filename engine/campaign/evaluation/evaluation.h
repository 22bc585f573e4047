// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "campaign/evaluation/evaluate.h"
#include "campaign/reading/campaign_reader.h"

/// Evaluates one campaign from its folder to its output files in four steps, each of which takes
/// the result of the previous one:
///
///   read_campaign    the files of the folder        -> observations
///   analyse          observations                   -> analyses, models, decisions, tables
///   assign a number  (numbering.h; optional)        -> the certificate, or why there is none
///   write_documents  all results                    -> output files
///
/// The process with the plugins runs steps 1, 2 and 4; the process with the register runs step 3
/// (computing.h).
namespace nonio::evaluation {

/// A controller whose tables are to be written. If `asked` is false, neither `[run] outputs` nor
/// the machine names this controller, and a table that cannot be written is a finding instead of an
/// error.
struct WantedController {
  const Controller* controller = nullptr;
  Settings options;
  bool asked = false;
};

/// An output plugin that writes files for the campaign, with its settled options.
struct WantedOutput {
  const Output* output = nullptr;
  Settings options;
  bool history = false;  ///< the output shows the history of the machine
};

/// A request for a certificate number: the output that is issued, and what is missing for it.
struct NumberRequest {
  std::string output;
  /// Keys that must be filled, and findings that must be corrected.
  std::vector<std::string> missing;
  OutputResult incomplete;  ///< result with the findings about traceability
};

/// A campaign that is completely evaluated, before its documents are written.
struct AnalysedCampaign {
  reading::ReadCampaign read;
  Evaluated evaluated;                  ///< results of the campaign, including the tables
  std::vector<WantedOutput> documents;  ///< documents to write next
  /// Request for a number; none: no output is issued under one.
  std::optional<NumberRequest> number;
};

AnalysedCampaign analyse(reading::ReadCampaign read, const std::string& id,
                         const reading::Context& context, const reading::Stage& stage,
                         const reading::Twins& twins);

/// Writes the documents of a campaign. `assigned` is the answer to `AnalysedCampaign::number`, or
/// null if no number is assigned. `history` is the history of the machine up to this campaign, or
/// null if it is not known.
Evaluated write_documents(AnalysedCampaign analysed, const AssignedNumber* assigned,
                          const reading::Context& context, const reading::Stage& stage,
                          const HistorySoFar* history = nullptr);

// Steps of `analyse` and `write_documents`:

/// The state that the steps of one campaign share: its inputs, and the list to which errors are
/// reported with the line that causes them.
struct Work {
  const reading::Context& context;
  const reading::Stage& stage;
  const reading::ReadCampaign& read;
  std::vector<Error>& errors;

  const Campaign& campaign() const { return read.manifest->campaign; }
  void report(Error error) const;
  /// Adds the line in the manifest or in site.toml to an error of a plugin.
  void locate_error(Error& error, const std::string& plugin = {}) const;
  /// Returns an error that names a key of the manifest and its line.
  Error error_at(std::string key, const std::string& message) const;
  /// Returns the options of a plugin; reports errors in them.
  std::optional<Settings> settle(const Info& info) const;
  /// Whether a plugin states that it applies. An error of the plugin is reported, and the result is
  /// then false.
  bool asks_to_apply(const std::string& who, const std::string& where,
                     const std::function<bool()>& ask) const;
  /// Whether a plugin runs if neither manifest nor site names plugins.
  bool is_chosen_by_itself(const Info& info) const;
};

/// Names of plugins in a list of `[run]`; none: all plugins that apply.
using PluginNames = std::optional<std::vector<std::string>>;

/// Returns the plugins with these names in the order of the names; without names all plugins that
/// run by default.
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

/// Reports each of `names` that no plugin of this kind has, except the name of the model fit, which
/// is not a plugin.
void report_absent(const Work& work, const char* kind, const char* key, const PluginNames& names,
                   const std::function<bool(const std::string&)>& is_there);

/// Run the requested analyses and return their results. `fit_models` fits the models if `[run]
/// analyses` names the model fit or, without this list, if [model] has effects.
std::vector<Results::Analysed> run_analyses(const Work& work);
std::vector<Results::Analysed> fit_models(const Work& work, std::vector<ModelFit>& models);

/// Returns the ids of the findings that prevent tables: signs of a mistake in the files that were
/// not accepted with a reason. Adds the reason to an accepted finding, and reports an error if an
/// accepted finding does not occur.
std::vector<std::string> open_doubts(const Work& work, std::vector<Results::Analysed>& analyses);

/// Returns a remark for each measurement that no analysis and no model has used, and one if the
/// manifest has a model that was not fitted.
std::vector<Remark> unevaluated(const reading::ReadCampaign& read, const Results& results);

/// Compares values with the tolerances of the manifest and returns the decisions. The decision is
/// `cannot_be_decided` for a tolerance without a value.
std::vector<Conformity> held_against_tolerances(const Campaign& campaign,
                                                const std::vector<Results::Analysed>& analyses);

/// Reports tolerances whose unit differs from that of the result that they name.
void report_other_units(const Work& work, const std::vector<Results::Analysed>& analyses);

/// The requested controllers and outputs that apply; empty after an error.
struct WantedPlugins {
  std::vector<WantedController> controllers;
  std::vector<WantedOutput> outputs;
};
WantedPlugins wanted_plugins(const Work& work, std::vector<Remark>& notes);
/// Writes the tables of the controllers into `results`. `doubts` contains the ids that
/// `open_doubts` returned.
void write_tables(const Work& work, const std::vector<WantedController>& wanted,
                  const std::vector<std::string>& doubts, Results& results);
/// Returns the request for a certificate number; none if no output is issued under a number, or
/// after an error.
std::optional<NumberRequest> number_request(const Work& work,
                                            const std::vector<WantedOutput>& documents,
                                            const Results& results);

/// Checks the result of a plugin. A file name that a result in `taken` already uses is an error.
Expected<void> check_output(const OutputResult& result, const std::vector<Results::Written>& taken);

}  // namespace nonio::evaluation
