// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <set>

#include "host/evaluation/evaluation.h"
#include "host/modelling/model_fit.h"
#include "host/process/guarded.h"
#include "host/reading/names.h"
#include "host/reading/traceability.h"
#include "host/storage/files.h"
#include "host/storage/nearest.h"
#include "host/tables/table_check.h"
#include "nonio/sdk/format.h"

namespace nonio::host::evaluation {

namespace {

std::string comma_list(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

bool is_table(const Output& output) { return output.stage == Output::Stage::table; }

/// Whether outputs write tables for the machine's control, if it has one.
bool check_control(const Work& work) {
  const std::string& control = work.campaign().machine.control;
  std::vector<std::string> tables;
  for (const Output& o : work.context.plugins->outputs())
    if (is_table(o)) tables.push_back(o.info.name);
  if (control.empty() || std::find(tables.begin(), tables.end(), control) != tables.end())
    return true;
  work.report(work.error_at("machine.control", "no output writes tables for \"" + control + "\"" +
                                                   storage::suggestion(control, tables) +
                                                   "; there are " + comma_list(tables)));
  return false;
}

/// A table of another control than the machine's: the manifest that asks for it is wrong, and of
/// what site.toml asks for all machines it is left out.
bool is_control_of_record(const Work& work, const std::string& output) {
  const auto& machine = work.read.machine;
  if (!machine || machine->control.empty() || machine->control == output) return true;
  if (work.read.manifest->run.outputs)
    work.report(work.error_at("run.outputs", "asks for tables of " + output + ", and " +
                                                 machine->file + " says that the control is " +
                                                 machine->control));
  return false;
}

std::optional<Settings> settle_output(const Work& work, const Output& output) {
  if (!is_table(output)) return work.settle(output.info);
  auto options =
      config::settle_table_options(output.info, work.context.site.options, *work.read.manifest,
                                   work.read.machine ? &*work.read.machine : nullptr);
  if (options) return std::move(*options);
  for (Error& e : options.error()) work.report(std::move(e));
  return std::nullopt;
}

}  // namespace

std::vector<WantedOutput> wanted_outputs(const Work& work) {
  const auto &of_campaign = work.read.manifest->run.outputs,
             &of_site = work.context.site.run.outputs;
  auto outputs = chosen_plugins(work, work.context.plugins->outputs(), "output", "run.outputs",
                                of_campaign, of_site);
  const bool all = !of_campaign && !of_site;
  check_control(work);
  if (!work.errors.empty()) return {};
  std::stable_partition(outputs.begin(), outputs.end(),
                        [](const Output* o) { return is_table(*o); });
  std::vector<WantedOutput> wanted;
  const std::string& control = work.campaign().machine.control;
  for (const Output* output : outputs) {
    const std::string& name = output->info.name;
    if (all && is_table(*output) && !control.empty() && control != name) continue;
    if (is_table(*output) && !is_control_of_record(work, name)) continue;
    if (!work.asks_to_apply("output " + name, "", [&] { return output->applies(work.campaign()); }))
      continue;
    const bool asked = !all || !is_table(*output) || control == name;
    if (auto options = settle_output(work, *output))
      wanted.push_back({output, std::move(*options), asked});
  }
  return wanted;
}

namespace {

/// Where the manifest asks for the output, if the error does not know better.
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

/// What the output gives, if that is sound; else an error of the campaign.
void take_result(const Work& work, const Output& output, Expected<OutputResult> result,
                 Results& results) {
  if (result)
    if (auto sound = check_output(*result, results.outputs); !sound)
      result = fail("output " + output.info.name + " gave " + sound.error().message);
  if (result) return keep_result(output.info, std::move(*result), results);
  place_at_output(work, output.info.name, result.error());
  work.report(std::move(result.error()));
}

/// A finding in place of a table.
OutputResult no_table(const char* id, const Output& output, const char* why,
                      const std::string& text) {
  OutputResult nothing;
  nothing.findings.push_back(
      {.id = id, .attention = true, .texts = {{"output", output.info.name}, {why, text}}});
  return nothing;
}

/// What the tables take where the manifest wants them of the model and not of the readings; an
/// error if there is no model.
using ModelReadings = std::optional<Expected<std::vector<Observations>>>;

/// On top of what was on while the campaign was measured: the new table takes its place.
Expected<OutputResult> write_over_present(const Work& work, const WantedOutput& w,
                                          const ModelReadings& of_model, const Results& results) {
  const reading::ReadCampaign& read = work.read;
  const std::vector<Observations>& taken = of_model ? **of_model : read.observations;
  auto on = tables::what_was_on(read, *w.output, w.options);
  if (!on) {
    if (w.asked) on.error().key = "machine.axes." + read.tables_on.begin()->first + ".table_on";
    return fail(on.error());
  }
  if (!*on)
    return w.output->write({work.campaign(), taken, results, w.options, work.context.templates,
                            of_model ? &read.observations : nullptr, nullptr});
  const std::vector<Observations> of_curves =
      of_model ? tables::without_tables(work.campaign(), taken, (*on)->tables) : (*on)->readings;
  auto written =
      w.output->write({work.campaign(), of_curves, results, (*on)->options, work.context.templates,
                       of_model ? &(*on)->readings : nullptr, nullptr});
  if (written) tables::compare_with_measured(read, *written);
  return written;
}

Expected<OutputResult> table_of(const Work& work, const WantedOutput& w,
                                const ModelReadings& of_model,
                                const std::vector<std::string>& doubts, const Results& results) {
  if (!doubts.empty()) return no_table("table.withheld", *w.output, "findings", comma_list(doubts));
  if (of_model && !*of_model)
    return no_table("table.no-model", *w.output, "why", of_model->error().message);
  auto written = write_over_present(work, w, of_model, results);
  if (!written && !w.asked && written.error().key.empty())
    written = no_table("table.not-written", *w.output, "why", written.error().message);
  if (written && !w.asked)  // a control that the machine may not even have
    for (Finding& f : written->findings)
      if (f.id == "table.axis-number") f.attention = false;
  return written;
}

}  // namespace

void write_tables(const Work& work, const std::vector<WantedOutput>& wanted,
                  const std::vector<std::string>& doubts, Results& results) {
  ModelReadings of_model;
  if (work.campaign().compensate_model)
    of_model = modelling::compensable_readings(work.read, results.notes);
  for (const WantedOutput& w : wanted) {
    if (!is_table(*w.output) || w.output->lacks != nullptr) continue;
    const std::string who = "output " + w.output->info.name;
    work.stage(who);
    take_result(work, *w.output,
                process::guarded(who, [&] { return table_of(work, w, of_model, doubts, results); }),
                results);
  }
}

namespace {

/// The output that is issued under a number; null if there is none, or an error.
const WantedOutput* numbered_output(const Work& work, const std::vector<WantedOutput>& wanted) {
  const WantedOutput* numbered = nullptr;
  for (const WantedOutput& w : wanted) {
    if (w.output->lacks == nullptr) continue;
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
                           const std::optional<Certificate>& certificate) {
  return {work.campaign(),
          work.read.observations,
          results,
          w.options,
          work.context.templates,
          nullptr,
          certificate ? &certificate->issue : nullptr};
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
    return numbered->output->lacks(document_input(work, *numbered, results, {}));
  });
  if (!missing) {
    work.report(missing.error());
    return std::nullopt;
  }
  request.missing = std::move(*missing);
  request.incomplete.findings = reading::traceability_findings(work.campaign());
  for (const Finding& f : request.incomplete.findings)
    request.missing.push_back(finding_text(work.context.templates, "en", f, "title") + " (" + f.id +
                              ")");
  return request;
}

namespace {

/// Of the one that is issued under a number, what has become of it.
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

/// What was issued is not written again.
OutputResult as_issued(const Certificate& certificate, const std::string& output) {
  OutputResult issued;
  for (const IssuedFile& f : certificate.files)
    if (f.output == output) issued.artifacts.push_back({f.name, f.bytes});
  return issued;
}

void write_document(const Work& work, const WantedOutput& w, Evaluated& out) {
  const Output& output = *w.output;
  if (output.lacks != nullptr && !out.certificate) return;
  if (output.lacks != nullptr && out.certificate->issued)
    return keep_result(output.info, as_issued(*out.certificate, output.info.name), out.results);
  const std::string who = "output " + output.info.name;
  work.stage(who);
  take_result(
      work, output,
      process::guarded(
          who, [&] { return output.write(document_input(work, w, out.results, out.certificate)); }),
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
                          const reading::Context& context, const reading::Stage& stage) {
  Evaluated out = std::move(analysed.evaluated);
  const Work work{context, stage, analysed.read, out.results.errors};
  if (analysed.number)
    take_number(work, std::move(*analysed.number), assigned, analysed.documents, out);
  for (const WantedOutput& w : analysed.documents) write_document(work, w, out);
  const bool attention = !analysed.read.unread.empty() || needs_attention(out.results);
  out.status = !out.results.errors.empty() ? "failed" : attention ? "attention" : "ok";
  return out;
}

Expected<void> check_output(const OutputResult& result,
                            const std::vector<Results::Written>& taken) {
  std::set<std::string> names;
  for (const Results::Written& w : taken)
    for (const Artifact& a : w.result.artifacts) names.insert(a.name);
  for (const Artifact& a : result.artifacts) {
    if (!storage::is_artifact_name(a.name))
      return fail("the file name \"" + a.name + "\": expected a plain name inside the output folder");
    if (!names.insert(a.name).second)
      return fail("the file name \"" + a.name + "\", which is already taken");
  }
  for (const Prediction& p : result.predictions)
    if (!std::isfinite(p.before) || !std::isfinite(p.after))
      return fail("a prediction of " + p.name + " that is not a number");
  for (const Finding& f : result.findings)
    for (const Number& n : f.evidence)
      if (!std::isfinite(n.value))
        return fail("evidence " + n.name + " of finding " + f.id + " that is not a number");
  return {};
}

}  // namespace nonio::host::evaluation
