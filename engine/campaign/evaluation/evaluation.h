// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "campaign/evaluation/evaluate.h"
#include "campaign/reading/campaign_reader.h"

/// One campaign from its folder to its artifacts is four calls in a row, each of which takes what
/// the one before has made:
///
///   read_campaign    the files of the folder        -> observations
///   analyse          observations                   -> analyses, models, decisions, tables
///   assign a number (numbering.h; optional)       -> what is issued under it, or why nothing is
///   write_documents  all of that                    -> artifacts
///
/// The first two and the last are done by the process with the plugins, the third by the one with
/// the register (computing.h).
namespace nonio::evaluation {

/// A controller whose tables are to be written. Without `asked` a table that the control cannot
/// have is a finding and does not fail the campaign: it was tried only because the control of the
/// machine is not stated.
struct WantedController {
  const Controller* controller = nullptr;
  Settings options;
  bool asked = false;
};

/// An output that is to be written.
struct WantedOutput {
  const Output* output = nullptr;
  Settings options;
  bool history = false;  ///< it shows the machine's
};

/// The output that is issued under a number, and what it lacks for one.
struct NumberRequest {
  std::string output;
  std::vector<std::string> missing;  ///< keys to fill, findings to correct
  OutputResult incomplete;           ///< what is found of its traceability
};

/// A campaign of which everything is evaluated and no document written.
struct AnalysedCampaign {
  reading::ReadCampaign read;
  Evaluated evaluated;                  ///< with the tables
  std::vector<WantedOutput> documents;  ///< what follows
  std::optional<NumberRequest> number;  ///< none: nothing is issued under one
};

AnalysedCampaign analyse(reading::ReadCampaign read, const std::string& id,
                         const reading::Context& context, const reading::Stage& stage,
                         const reading::Twins& twins);

/// `assigned`: the answer to `AnalysedCampaign::number`; null where no number is drawn. `history`:
/// of the machine up to this campaign; null where it is not known.
Evaluated write_documents(AnalysedCampaign analysed, const AssignedNumber* assigned,
                          const reading::Context& context, const reading::Stage& stage,
                          const HistorySoFar* history = nullptr);

// Steps of `analyse` and `write_documents`.

/// What the calls of one campaign share: where errors go, each with the line that is to blame.
struct Work {
  const reading::Context& context;
  const reading::Stage& stage;
  const reading::ReadCampaign& read;
  std::vector<Error>& errors;

  const Campaign& campaign() const { return read.manifest->campaign; }
  void report(Error error) const;
  /// With its line in the manifest or in site.toml.
  void locate_error(Error& error, const std::string& plugin = {}) const;
  /// An error that a key of the manifest is to blame for.
  Error error_at(std::string key, const std::string& message) const;
  /// The options of a plugin; what is wrong with them is reported.
  std::optional<Settings> settle(const Info& info) const;
  /// What the plugin reports of itself; an error is reported, and means no.
  bool asks_to_apply(const std::string& who, const std::string& where,
                     const std::function<bool()>& ask) const;
  /// What runs if neither manifest nor site names plugins.
  bool is_chosen_by_itself(const Info& info) const;
};

/// Names of a list under `[run]`; none: all that apply.
using PluginNames = std::optional<std::vector<std::string>>;

/// The plugins that are requested, in that order; without names all.
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

/// A name that no plugin of the kind has is an error.
void report_absent(const Work& work, const char* kind, const char* key, const PluginNames& names,
                   const std::function<bool(const std::string&)>& is_there);

/// Of the analyses that are requested; then of the model, if one is.
std::vector<Results::Analysed> run_analyses(const Work& work);
std::vector<Results::Analysed> fit_models(const Work& work, std::vector<ModelFit>& models);

/// Ids of the findings of `analyses` for which no table is written: what looks like a mistake in
/// the files and was not accepted with a reason. An accepted finding states that.
std::vector<std::string> open_doubts(const Work& work, std::vector<Results::Analysed>& analyses);

/// Measurements that no analysis and no model has used, reported so that they are not overlooked.
std::vector<Remark> unevaluated(const reading::ReadCampaign& read, const Results& results);

/// Values against the tolerances of the manifest.
std::vector<Conformity> held_against_tolerances(const Campaign& campaign,
                                                const std::vector<Results::Analysed>& analyses);

/// Tolerances of measurements in another unit than the result that they name.
void report_other_units(const Work& work, const std::vector<Results::Analysed>& analyses);

/// The controllers and outputs that are requested and apply; notes how their options are written
/// now. Nothing after an error.
struct WantedPlugins {
  std::vector<WantedController> controllers;
  std::vector<WantedOutput> outputs;
};
WantedPlugins wanted_plugins(const Work& work, std::vector<Remark>& notes);
/// `doubts`: as `open_doubts` gives them.
void write_tables(const Work& work, const std::vector<WantedController>& wanted,
                  const std::vector<std::string>& doubts, Results& results);
/// None where nothing is issued under a number, or after an error.
std::optional<NumberRequest> number_request(const Work& work,
                                            const std::vector<WantedOutput>& documents,
                                            const Results& results);

/// What is wrong with a plugin's answer. `taken`: outputs whose files have their names already.
Expected<void> check_output(const OutputResult& result, const std::vector<Results::Written>& taken);

}  // namespace nonio::evaluation
