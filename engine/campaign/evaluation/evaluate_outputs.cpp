// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>

#include "campaign/evaluation/evaluation.h"
#include "campaign/modelling/model_fit.h"
#include "campaign/reading/names.h"
#include "campaign/reading/plausibility/traceability.h"
#include "campaign/tables/table_check.h"
#include "nonio/sdk/check.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/history.h"
#include "platform/process/guarded.h"
#include "platform/storage/files.h"

namespace nonio::evaluation {

namespace {

void check_control(const Work& work) {
  const std::string& control = work.campaign().machine.control;
  std::vector<std::string> tables;
  for (const Controller& c : work.context.plugins->controllers()) tables.push_back(c.info.name);
  if (control.empty() || std::find(tables.begin(), tables.end(), control) != tables.end()) return;
  work.report(work.error_at(
      "machine.control",
      work.context.plugins->absence("controller", control) + "; there are " + comma_list(tables)));
}

/// Whether the record of the machine states this control, or states none. Reports a difference only
/// if the manifest has `[run] outputs`, because site.toml requests controllers for all machines.
bool is_control_of_record(const Work& work, const std::string& controller) {
  const auto& machine = work.read.machine;
  if (!machine || machine->control.empty() || machine->control == controller) return true;
  if (work.read.manifest->run.outputs)
    work.report(work.error_at("run.outputs", "requests tables of " + controller + ", and " +
                                                 machine->file + " states that the control is " +
                                                 machine->control));
  return false;
}

void note_axes_as_texts(const Work& work, const Info& controller, const Settings& settled,
                        std::vector<Remark>& notes) {
  const auto& options = work.read.manifest->options;
  const auto plugin = options.find(controller.name);
  if (plugin == options.end()) return;
  const auto axes = plugin->second.find("axes");
  const NumberTables tables = settled.tables("axes");
  if (axes == plugin->second.end() || tables.empty() ||
      !std::holds_alternative<std::vector<std::string>>(axes->second.value))
    return;
  notes.push_back(
      {"options.axes-as-texts",
       {},
       {{"line", std::to_string(axes->second.line)},
        {"table", "[options." + controller.name + ".axes." + tables.begin()->first + "]"}}});
}

std::optional<Settings> settle_controller(const Work& work, const Info& controller,
                                          std::vector<Remark>& notes) {
  auto options =
      config::settle_table_options(controller, work.context.site.options, *work.read.manifest,
                                   work.read.machine ? &*work.read.machine : nullptr);
  if (options) {
    note_axes_as_texts(work, controller, *options, notes);
    return std::move(*options);
  }
  for (Error& e : options.error()) work.report(std::move(e));
  return std::nullopt;
}

void note_not_in_format(const Campaign& campaign, const std::string& controller,
                        std::vector<Remark>& notes) {
  std::set<std::string> measurements;
  for (const Measurement& m : campaign.measurements)
    if (m.kind == "axis" || !m.from.empty()) measurements.insert(m.id);
  if (!measurements.empty())
    notes.push_back({"table.not-in-format",
                     {},
                     {{"output", controller}, {"measurements", comma_list(measurements)}}});
}

}  // namespace

std::vector<WantedController> with_control(const Work& work, std::vector<WantedController> wanted) {
  const std::string& control = work.campaign().machine.control;
  const auto is_there = [&](const WantedController& w) {
    return w.controller->info.name == control;
  };
  if (std::any_of(wanted.begin(), wanted.end(), is_there)) return wanted;
  for (const Controller& c : work.context.plugins->controllers()) {
    if (c.info.name != control) continue;
    if (auto options =
            config::settle_table_options(c.info, work.context.site.options, *work.read.manifest,
                                         work.read.machine ? &*work.read.machine : nullptr))
      wanted.push_back({&c, std::move(*options), false});
  }
  return wanted;
}

WantedPlugins wanted_plugins(const Work& work, std::vector<Remark>& notes) {
  const auto& own = work.read.manifest->run.outputs;
  const PluginNames& names = own ? own : work.context.site.run.outputs;
  const loader::Plugins& plugins = *work.context.plugins;
  report_absent(work, "output", "run.outputs", names, [&](const std::string& name) {
    return has_plugin(plugins.outputs(), name) || has_plugin(plugins.controllers(), name);
  });
  check_control(work);
  WantedPlugins wanted;
  if (!work.errors.empty()) return wanted;
  const auto applies = [&](const char* kind, const auto& plugin) {
    return work.asks_to_apply(kind + plugin.info.name, "",
                              [&] { return plugin.applies(work.campaign()); });
  };
  const std::string& control = work.campaign().machine.control;
  for (const Controller* c : chosen_plugins(work, plugins.controllers(), names)) {
    if (!names && !control.empty() && control != c->info.name) continue;
    if (!is_control_of_record(work, c->info.name)) continue;
    const bool asked = names.has_value() || control == c->info.name;
    if (!applies("controller ", *c)) {
      if (asked) note_not_in_format(work.campaign(), c->info.name, notes);
      continue;
    }
    if (auto options = settle_controller(work, c->info, notes))
      wanted.controllers.push_back({c, std::move(*options), asked});
  }
  for (const Output* o : chosen_plugins(work, plugins.outputs(), names)) {
    if (!applies("output ", *o)) continue;
    auto options = work.settle(o->info);
    if (!options) continue;
    const bool history = o->wants_history != nullptr &&
                         work.asks_to_apply("output " + o->info.name, "",
                                            [&] { return o->wants_history(*options); });
    wanted.outputs.push_back({o, std::move(*options), history});
  }
  return wanted;
}

namespace {

void place_at_output(const Work& work, const std::string& name, Error& error) {
  const config::Manifest& manifest = *work.read.manifest;
  const config::SiteFile& site = work.context.site;
  work.locate_error(error, name);
  const bool blamed = error.line != 0;
  if (error.file.empty()) error.file = config::manifest_name;
  const bool own = manifest.run.outputs.has_value() || work.campaign().machine.control == name;
  if (const auto line = site.lines.find("run.outputs");
      !blamed && error.file == config::manifest_name && !own && site.run.outputs &&
      line != site.lines.end() && !manifest.lines.contains("options." + name)) {
    error.file = config::site_name;
    error.line = line->second;
  }
  const std::string asked = manifest.run.outputs ? "run.outputs" : "machine.control";
  reading::give_line(error, manifest.lines,
                     {"options." + name, own ? asked : "campaign.id", "campaign"});
}

void keep_result(const Info& output, OutputResult result, Results& results) {
  results.outputs.push_back({output.name, output.version, std::move(result)});
}

void take_result(const Work& work, const Info& plugin, const std::string& who,
                 Expected<OutputResult> result, Results& results) {
  if (result)
    if (auto sound = check_output(*result, results.outputs); !sound)
      result = fail(who + " gave " + sound.error().message);
  if (result) return keep_result(plugin, std::move(*result), results);
  place_at_output(work, plugin.name, result.error());
  work.report(std::move(result.error()));
}

Finding no_table(const char* id, const Info& controller,
                 std::vector<std::pair<std::string, std::string>> why) {
  why.emplace(why.begin(), "output", controller.name);
  return {.id = id, .attention = true, .texts = std::move(why)};
}

/// Readings predicted by the model; nullopt if the manifest requires the measured readings.
using ModelReadings = std::optional<Expected<std::vector<Observations>>>;

/// Active tables are removed from the readings first, because the new table replaces them.
Expected<OutputResult> write_over_present(const Work& work, const WantedController& w,
                                          const ModelReadings& of_model, const Results& results) {
  const reading::ReadCampaign& read = work.read;
  const Controller& controller = *w.controller;
  const std::vector<Observations>& taken = of_model ? **of_model : read.observations;
  auto on = tables::active_compensation(read, controller, w.options);
  if (!on) {
    if (w.asked)
      on.error().key = "machine.axes." + read.active_tables.begin()->first + ".active_table";
    return fail(on.error());
  }
  if (!*on)
    return controller.write(
        {work.campaign(), taken, results, w.options, of_model ? &read.observations : nullptr});
  const std::vector<Observations> of_curves =
      of_model ? tables::without_tables(work.campaign(), taken, (*on)->tables) : (*on)->readings;
  const Results of_tables = tables::without_tables(work.campaign(), results, (*on)->tables);
  auto written = controller.write({work.campaign(), of_curves, of_tables, (*on)->options,
                                   of_model ? &(*on)->readings : nullptr});
  if (written) tables::compare_with_measured(read, *written);
  return written;
}

Expected<OutputResult> table_of(const Work& work, const WantedController& w,
                                const ModelReadings& of_model, const Results& results) {
  const Info& info = w.controller->info;
  OutputResult nothing;
  if (of_model && !*of_model) {
    nothing.findings.push_back(
        no_table("table.no-model", info, {{"why", of_model->error().message}}));
    return nothing;
  }
  auto written = write_over_present(work, w, of_model, results);
  if (!written && !w.asked && written.error().key.empty()) {
    nothing.findings.push_back(
        no_table("table.not-written", info, {{"why", written.error().message}}));
    return nothing;
  }
  if (written && !w.asked)
    for (Finding& f : written->findings)
      if (f.id == "table.axis-number" || f.id == "table.active-not-stated") f.attention = false;
  return written;
}

/// The tables of all measurements that are not doubted. A model uses all of them.
Expected<OutputResult> sound_tables(const Work& work, const WantedController& w,
                                    const Doubts& doubts, const Results& results) {
  reading::ReadCampaign read = work.read;
  Results sound = results;
  std::set<std::string> ids, without = leave_out(doubts, read, sound);
  Campaign rest = work.campaign();
  for (const auto& [id, findings] : doubts) ids.insert(findings.begin(), findings.end());
  std::erase_if(rest.measurements, [&](const Measurement& m) { return without.contains(m.id); });
  Expected<OutputResult> written = OutputResult();
  if (!rest.compensate_model && w.controller->applies(rest))
    written = table_of({work.context, work.stage, read, work.errors}, w, std::nullopt, sound);
  if (written)
    written->findings.push_back(
        no_table("table.withheld", w.controller->info,
                 {{"findings", comma_list(ids)}, {"measurements", comma_list(without)}}));
  return written;
}

}  // namespace

void write_tables(const Work& work, const std::vector<WantedController>& wanted,
                  const Doubts& doubts, Results& results) {
  ModelReadings of_model;
  if (work.campaign().compensate_model)
    of_model = modelling::compensable_readings(work.read, results.notes);
  for (const WantedController& w : wanted) {
    const std::string who = "controller " + w.controller->info.name;
    work.stage(who);
    take_result(work, w.controller->info, who,
                process::guarded(who,
                                 [&] {
                                   return doubts.empty() ? table_of(work, w, of_model, results)
                                                         : sound_tables(work, w, doubts, results);
                                 }),
                results);
  }
}

namespace {

const WantedOutput* numbered_output(const Work& work, const std::vector<WantedOutput>& wanted) {
  const WantedOutput* numbered = nullptr;
  for (const WantedOutput& w : wanted) {
    if (!w.output->certificate) continue;
    if (numbered != nullptr)
      work.report(work.error_at("run.outputs", "both " + numbered->output->info.name + " and " +
                                                   w.output->info.name +
                                                   " are issued under a number; expected one of "
                                                   "them"));
    numbered = &w;
  }
  return work.errors.empty() ? numbered : nullptr;
}

OutputInput document_input(const Work& work, const WantedOutput& w, const Results& results,
                           const std::optional<Certificate>& certificate,
                           const HistorySoFar* history = nullptr) {
  return {work.campaign(),
          work.read.observations,
          results,
          w.options,
          work.context.templates,
          certificate ? &certificate->issue : nullptr,
          w.history ? history : nullptr};
}

}  // namespace

std::optional<NumberRequest> number_request(const Work& work,
                                            const std::vector<WantedOutput>& documents,
                                            const Results& results) {
  const WantedOutput* numbered = numbered_output(work, documents);
  if (numbered == nullptr) return std::nullopt;
  NumberRequest request{numbered->output->info.name, {}, {}};
  const std::string who = "output " + request.output;
  work.stage(who);
  auto missing = process::guarded(who, [&]() -> Expected<std::vector<std::string>> {
    return numbered->output->certificate->missing_requirements(
        document_input(work, *numbered, results, {}));
  });
  if (!missing) {
    work.report(missing.error());
    return std::nullopt;
  }
  request.missing = std::move(*missing);
  request.incomplete.findings = reading::traceability_findings(work.campaign());
  // An expired calibration does not prevent a certificate if the person who approves it states a
  // reason.
  std::erase_if(request.incomplete.findings,
                [](const Finding& f) { return reading::is_expired_calibration(f.id); });
  for (const Finding& f : request.incomplete.findings)
    request.missing.push_back(finding_text(work.context.templates, "en", f, "title") + " (" + f.id +
                              ")");
  return request;
}

namespace {

void take_number(const Work& work, NumberRequest request, const AssignedNumber* assigned,
                 const std::vector<WantedOutput>& documents, Evaluated& out) {
  if (assigned != nullptr && assigned->error) {
    out.retry = true;
    return work.report(*assigned->error);
  }
  const std::vector<std::string>& missing =
      assigned != nullptr ? assigned->missing : request.missing;
  if (assigned != nullptr && assigned->certificate) {
    out.certificate = assigned->certificate;
    out.certificate->output = request.output;
  }
  if (missing.empty() || out.certificate) return;
  request.incomplete.findings.push_back({.id = "certificate.incomplete",
                                         .attention = true,
                                         .texts = {{"missing", comma_list(missing)}}});
  for (const WantedOutput& w : documents)
    if (w.output->info.name == request.output)
      keep_result(w.output->info, std::move(request.incomplete), out.results);
}

OutputResult as_issued(const Certificate& certificate, const std::string& output) {
  OutputResult issued;
  for (const IssuedFile& f : certificate.files)
    if (f.output == output) issued.artifacts.push_back({f.name, f.bytes});
  return issued;
}

void write_document(const Work& work, const WantedOutput& w, const HistorySoFar* history,
                    Evaluated& out) {
  const Output& output = *w.output;
  if (output.certificate && !out.certificate) return;
  if (output.certificate && out.certificate->issued)
    return keep_result(output.info, as_issued(*out.certificate, output.info.name), out.results);
  const std::string who = "output " + output.info.name;
  work.stage(who);
  take_result(work, output.info, who,
              process::guarded(who,
                               [&] {
                                 return output.write(document_input(work, w, out.results,
                                                                    out.certificate, history));
                               }),
              out.results);
}

bool needs_attention(const Results& results) {
  const auto asks = [](const std::vector<Finding>& findings) {
    return std::any_of(findings.begin(), findings.end(),
                       [](const Finding& f) { return f.attention; });
  };
  return std::any_of(results.analyses.begin(), results.analyses.end(),
                     [&](const auto& a) { return asks(a.evaluation.findings); }) ||
         std::any_of(results.outputs.begin(), results.outputs.end(),
                     [&](const auto& o) { return asks(o.result.findings); }) ||
         std::any_of(results.conformity.begin(), results.conformity.end(),
                     [](const Conformity& c) { return c.decision != Decision::conforms; });
}

}  // namespace

Evaluated write_documents(AnalysedCampaign analysed, const AssignedNumber* assigned,
                          const reading::Context& context, const reading::Stage& stage,
                          const HistorySoFar* history) {
  Evaluated out = std::move(analysed.evaluated);
  const Work work{context, stage, analysed.read, out.results.errors};
  if (analysed.number)
    take_number(work, std::move(*analysed.number), assigned, analysed.documents, out);
  for (const WantedOutput& w : analysed.documents) {
    write_document(work, w, history, out);
    if (w.history)
      out.history =
          history != nullptr ? ShownHistory{history->sha256, history->campaigns} : ShownHistory{};
  }
  const bool attention = !analysed.read.unread.empty() || needs_attention(out.results);
  out.status = !out.results.errors.empty() ? Status::failed
               : attention                 ? Status::attention
                                           : Status::ok;
  return out;
}

Expected<void> check_output(const OutputResult& result,
                            const std::vector<Results::Written>& taken) {
  std::set<std::string> names;
  for (const Results::Written& w : taken)
    for (const Artifact& a : w.result.artifacts) names.insert(a.name);
  for (const Artifact& a : result.artifacts) {
    if (!storage::is_artifact_name(a.name))
      return fail("the file name \"" + a.name +
                  "\": expected a plain name inside the output folder");
    if (!names.insert(a.name).second)
      return fail("the file name \"" + a.name + "\", which is already taken");
  }
  return check(result);
}

}  // namespace nonio::evaluation
