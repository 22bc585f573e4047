// SPDX-License-Identifier: Apache-2.0
#include "campaign/evaluation/evaluate.h"

#include <iterator>

#include "campaign/evaluation/control_tables.h"
#include "campaign/evaluation/evaluation.h"
#include "campaign/modelling/model_fit.h"
#include "campaign/reading/names.h"
#include "campaign/reading/plausibility/plausibility.h"
#include "platform/process/guarded.h"

namespace nonio::evaluation {
namespace fs = std::filesystem;

void Work::report(Error error) const {
  if (read.manifest) reading::give_line(error, read.manifest->lines, {"campaign"});
  errors.push_back(std::move(error));
}

void Work::locate_error(Error& error, const std::string& plugin) const {
  reading::locate(error, read.manifest->lines, context.site.lines, plugin);
}

Error Work::error_at(std::string key, const std::string& message) const {
  Error error{key + ": " + message};
  error.key = std::move(key);
  locate_error(error);
  return error;
}

std::optional<Settings> Work::settle(const Info& info) const {
  auto options = config::settle_options(info, context.site.options, read.manifest->options,
                                        context.plugins->options_of_namesakes(info));
  if (options) return std::move(*options);
  for (Error& e : options.error()) report(std::move(e));
  return std::nullopt;
}

bool Work::asks_to_apply(const std::string& who, const std::string& where,
                         const std::function<bool()>& ask) const {
  stage(who + where + ", asked whether it applies");
  const auto said = process::guarded_answer(who, ask);
  if (!said) report(said.error());
  return said && *said;
}

bool Work::is_chosen_by_itself(const Info& info) const {
  return !info.opt_in || read.manifest->options.contains(info.name) ||
         campaign().machine.control == info.name;
}

void report_absent(const Work& work, const char* kind, const char* key, const PluginNames& names,
                   const std::function<bool(const std::string&)>& is_there) {
  if (!names) return;
  for (const std::string& name : *names)
    if (name != reading::model_fit_name && !is_there(name))
      work.report(work.error_at(key, work.context.plugins->absence(kind, name)));
}

namespace {

void append_analyses(std::vector<Results::Analysed>& to, std::vector<Results::Analysed> more) {
  to.insert(to.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

/// Returns false without a valid manifest, or if its id is no longer `id`.
bool begin_results(reading::ReadCampaign& read, const std::string& id, const reading::Twins& twins,
                   Evaluated& out) {
  out.campaign.id = id;
  out.inputs = std::move(read.inputs);
  reading::note_shared(twins, out.inputs);
  out.results.errors = std::move(read.errors);
  out.results.notes = std::move(read.notes);
  if (!read.manifest) return false;
  out.campaign = read.manifest->campaign;
  out.purpose = read.manifest->purpose;
  if (out.campaign.id == id) return true;
  Error error{"the id changed while the campaign was read", config::manifest_name};
  reading::give_line(error, read.manifest->lines, {"campaign"});
  out.results.errors.push_back(std::move(error));
  out.campaign.id = id;
  return false;
}

}  // namespace

AnalysedCampaign analyse(reading::ReadCampaign read, const std::string& id,
                         const reading::Context& context, const reading::Stage& stage,
                         const reading::Twins& twins) {
  AnalysedCampaign out{std::move(read), {}, {}, {}};
  Results& results = out.evaluated.results;
  if (!begin_results(out.read, id, twins, out.evaluated)) return out;
  const Work work{context, stage, out.read, results.errors};
  const auto failed = [&] { return !results.errors.empty(); };
  results.analyses = run_analyses(work);
  append_analyses(results.analyses, fit_models(work, results.models));
  Doubts doubts;
  if (!failed()) {
    stage("analysis " + std::string(reading::plausibility_name));
    append_analyses(results.analyses, reading::implausible(out.read, context, out.evaluated.inputs,
                                                           results.analyses));
    doubts = open_doubts(work, results.analyses);
  }
  for (Remark& note : unevaluated(out.read, results)) results.notes.push_back(std::move(note));
  report_other_units(work, results.analyses);
  if (failed()) return out;
  out.evaluated.followed = followed_of(out.read, results);
  results.conformity = held_against_tolerances(work.campaign(), results.analyses);
  WantedPlugins wanted = wanted_plugins(work, results.notes);
  write_tables(work, wanted.controllers, doubts, results);
  out.evaluated.control_tables =
      control_tables(out.read, results, with_control(work, wanted.controllers), results.notes);
  out.documents = std::move(wanted.outputs);
  if (!out.documents.empty()) out.number = number_request(work, out.documents, results);
  return out;
}

Evaluated evaluate(const fs::path& folder, const std::string& id, const reading::Context& context,
                   const reading::Stage& stage) {
  return write_documents(
      analyse(reading::read_campaign(folder, context, stage), id, context, stage, {}), nullptr,
      context, stage);
}

}  // namespace nonio::evaluation
