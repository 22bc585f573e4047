// SPDX-License-Identifier: Apache-2.0
#include "host/evaluation/evaluate.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "host/evaluation/cmc.h"
#include "host/modelling/model_fit.h"
#include "host/process/guarded.h"
#include "host/reading/campaign_reader.h"
#include "host/reading/names.h"
#include "host/reading/plausibility.h"
#include "host/reading/traceability.h"
#include "host/storage/files.h"
#include "host/storage/nearest.h"
#include "host/tables/table_check.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/statement.h"

namespace nonio::host::evaluation {
namespace fs = std::filesystem;

namespace {

class CampaignRun {
 public:
  CampaignRun(const fs::path& folder, const reading::Context& context, const reading::Stage& stage,
              const Draw& draw, const reading::Twins& twins)
      : folder_(folder), context_(context), stage_(stage), draw_(draw), twins_(twins) {}

  Evaluated run(const std::string& id) {
    id_ = out_.campaign.id = id;
    if (read()) {
      analyse();
      fit_model();
      doubt();
      note_unevaluated();
      if (!failed()) hold_against_tolerances();
      fill_advice();
      if (!failed()) write_outputs();
    }
    out_.status = failed() ? "failed" : needs_attention() ? "attention" : "ok";
    return std::move(out_);
  }

 private:
  bool failed() const { return !out_.results.errors.empty(); }
  void report(Error error) {
    if (read_.manifest) reading::give_line(error, read_.manifest->lines, {"campaign"});
    out_.results.errors.push_back(std::move(error));
  }
  void locate(Error& error, const std::string& plugin = {}) const {
    host::reading::locate(error, read_.manifest->lines, context_.site.lines, plugin);
  }
  /// An error that a key of the manifest is to blame for.
  Error at(std::string key, const std::string& message) const {
    Error error{key + ": " + message};
    error.key = std::move(key);
    locate(error);
    return error;
  }

  /// False if there is nothing to evaluate.
  bool read() {
    read_ = reading::read_campaign(folder_, context_, stage_);
    out_.inputs = std::move(read_.inputs);
    reading::note_shared(twins_, out_.inputs);
    out_.results.errors = std::move(read_.errors);
    out_.results.notes = std::move(read_.notes);
    if (!read_.manifest) return false;
    out_.campaign = read_.manifest->campaign;
    if (out_.campaign.id == id_) return true;
    report(Error{"the id changed while the campaign was read", config::manifest_name});
    out_.campaign.id = id_;
    return false;
  }

  std::optional<Settings> settle(const Info& info) {
    auto options = config::settle_options(info, context_.site.options, read_.manifest->options);
    if (options) return std::move(*options);
    for (Error& e : options.error()) report(std::move(e));
    return std::nullopt;
  }

  std::optional<Settings> settle(const Output& output) {
    if (output.stage != Output::Stage::table) return settle(output.info);
    auto options = config::settle_table_options(output.info, context_.site.options, *read_.manifest,
                                                read_.machine ? &*read_.machine : nullptr);
    if (options) return std::move(*options);
    for (Error& e : options.error()) report(std::move(e));
    return std::nullopt;
  }

  /// The plugins that are asked for, or all; a name that is not there is an error.
  template <class Plugin>
  std::vector<const Plugin*> chosen(const std::vector<Plugin>& all, const char* kind,
                                    const char* key,
                                    const std::optional<std::vector<std::string>>& campaign,
                                    const std::optional<std::vector<std::string>>& site) {
    std::vector<const Plugin*> out;
    const auto& names = campaign ? campaign : site;
    if (!names) {
      for (const Plugin& p : all)
        if (!p.info.on_request || read_.manifest->options.contains(p.info.name) ||
            out_.campaign.machine.control == p.info.name)
          out.push_back(&p);
      return out;
    }
    for (const std::string& name : *names) {
      if (name == reading::model_fit_name) continue;
      const auto found = std::find_if(all.begin(), all.end(),
                                      [&](const Plugin& p) { return p.info.name == name; });
      if (found == all.end())
        report(at(key, context_.plugins->absence(kind, name)));
      else if (std::find(out.begin(), out.end(), &*found) == out.end())
        out.push_back(&*found);
    }
    return out;
  }

  void analyse() {
    const auto analyses = chosen(context_.plugins->analyses(), "analysis", "run.analyses",
                                 read_.manifest->run.analyses, context_.site.run.analyses);
    for (Error& e : reading::ownerless_options(read_.manifest->options, *context_.plugins))
      report(std::move(e));
    for (std::size_t i = 0; i < read_.observations.size(); ++i) {
      const Measurement& m = out_.campaign.measurements[i];
      if (read_.observations[i].size() == 0) continue;
      for (const Analysis* analysis : analyses)
        if (analysis->applies &&
            applies(
                "analysis", analysis->info.name,
                [&] { return analysis->applies(out_.campaign, m); }, " (measurement " + m.id + ")"))
          analyse_with(*analysis, &m, [&](const Settings& options) {
            return analysis->analyse(
                {out_.campaign, m, read_.observations[i], options, &read_.observations});
          });
    }
    for (const Analysis* analysis : analyses)
      if (analysis->analyse_campaign)
        analyse_with(*analysis, nullptr, [&](const Settings& options) {
          return analysis->analyse_campaign({out_.campaign, read_.observations, options});
        });
  }

  /// What the plugin says of itself.
  template <class Ask>
  bool applies(const char* kind, const std::string& name, const Ask& ask,
               const std::string& where = {}) {
    const std::string who = std::string(kind) + " " + name;
    stage_(who + where + ", asked whether it applies");
    const auto said = process::guarded_answer(who, ask);
    if (!said) report(said.error());
    return said && *said;
  }

  /// Of one measurement, or of the campaign if there is none.
  template <class Call>
  void analyse_with(const Analysis& analysis, const Measurement* measurement, const Call& call) {
    const auto options = settle(analysis.info);
    if (!options) return;
    const std::string who = "analysis " + analysis.info.name;
    const std::string id = measurement == nullptr ? "" : measurement->id;
    stage_(measurement == nullptr ? who : who + " (measurement " + id + ")");
    auto evaluation = process::guarded(who, [&] { return call(*options); });
    if (evaluation)
      if (auto sound = check(*evaluation); !sound)
        evaluation = fail(who + " gave " + sound.error().message);
    if (!evaluation) {
      locate(evaluation.error(), analysis.info.name);
      if (evaluation.error().file.empty())
        evaluation.error().file =
            measurement == nullptr ? config::manifest_name : measurement->file;
      reading::give_line(evaluation.error(), read_.manifest->lines,
                         {"options." + analysis.info.name, "run.analyses"});
      return report(std::move(evaluation.error()));
    }
    const std::vector<std::string>& uses = evaluation->uses;
    for (const Measurement& m : out_.campaign.measurements)
      if (m.id == id || std::find(uses.begin(), uses.end(), m.id) != uses.end())
        note_reasons_missing(m, *evaluation);
    apply_cmc(out_.campaign.laboratory, length_of(*evaluation, measurement), *evaluation);
    for (Finding& f : evaluation->findings) f.measurement = id;
    word(evaluation->notes);
    out_.results.analyses.push_back(
        {analysis.info.name, analysis.info.version, id, std::move(*evaluation)});
  }

  /// Readings that were taken out without a word why. The evaluation stands; nothing is issued.
  static void note_reasons_missing(const Measurement& m, Evaluation& evaluation) {
    if (m.exclude.empty() || says_something(m.exclude_reason)) return;
    evaluation.findings.push_back(
        {.id = "readings.excluded-without-reason",
         .attention = true,
         .evidence = {{"excluded", static_cast<double>(m.exclude.size()), Quantity::count}},
         .texts = {{"file", m.file}, {"id", m.id}}});
  }

  /// Over which an evaluation was measured: its budget's, or as far as the axes moved.
  double length_of(const Evaluation& e, const Measurement* measurement) const {
    if (e.budget) return e.budget->length;
    double most = 0.0;
    for (std::size_t i = 0; measurement != nullptr && i < read_.observations.size(); ++i)
      if (out_.campaign.measurements[i].id == measurement->id)
        for (const auto& axis : read_.observations[i].axes)
          if (!axis.rotary && !axis.position.empty()) {
            const auto [low, high] =
                std::minmax_element(axis.position.begin(), axis.position.end());
            most = std::max(most, *high - *low);
          }
    return most;
  }

  void fit_model() {
    const auto& names =
        read_.manifest->run.analyses ? read_.manifest->run.analyses : context_.site.run.analyses;
    const bool asked =
        names ? std::find(names->begin(), names->end(), reading::model_fit_name) != names->end()
              : !out_.campaign.model.empty();
    if (!asked) return;
    stage_("analysis " + std::string(reading::model_fit_name));
    auto fitted = modelling::model_fit(read_, context_);
    if (!fitted) return report(std::move(fitted.error()));
    out_.results.models = std::move(fitted->models);
    for (Results::Analysed& one : fitted->analyses) {
      for (Finding& f : one.evaluation.findings) f.measurement = one.measurement;
      word(one.evaluation.notes);
      out_.results.analyses.push_back(std::move(one));
    }
  }

  static Expected<void> check(const Evaluation& e) {
    for (const Value& v : e.values)
      if (!std::isfinite(v.value) || (v.U && !std::isfinite(*v.U)) || !std::isfinite(v.k) ||
          (v.repeatability && !std::isfinite(*v.repeatability)))
        return fail("a value " + v.name + " that is not a number");
    for (const Finding& f : e.findings)
      for (const Number& n : f.evidence)
        if (!std::isfinite(n.value))
          return fail("evidence " + n.name + " of finding " + f.id + " that is not a number");
    for (const PointTable* table : {&e.points, &e.rows})
      for (const PointTable::Column& c : table->columns)
        if (c.values.size() != table->columns.front().values.size())
          return fail("a table with columns of different lengths");
    for (const Series& s : e.series)
      if (s.value.size() != s.position.size() || (!s.U.empty() && s.U.size() != s.value.size()) ||
          (!s.repeatability.empty() && s.repeatability.size() != s.value.size()))
        return fail("a series " + s.name + " with columns of different lengths");
    if (e.budget)
      for (const auto& r : e.budget->results)
        if (r.u.size() != e.budget->contributions.size())
          return fail("a budget of " + r.name + " with other contributions than it lists");
    return {};
  }

  /// What looks like a mistake in the files, beside what was evaluated from them.
  void doubt() {
    if (failed()) return;
    stage_("analysis " + std::string(reading::plausibility_name));
    for (auto& one : reading::implausible(read_, context_, out_.inputs, out_.results.analyses))
      out_.results.analyses.push_back(std::move(one));
    const auto& may_stand = read_.manifest->tables_may_stand;
    std::set<std::string> known;
    for (Results::Analysed& a : out_.results.analyses) {
      if (a.plugin != reading::plausibility_name) continue;
      for (Finding& f : a.evaluation.findings) {
        known.insert(f.id);
        const auto standing =
            std::find_if(may_stand.begin(), may_stand.end(),
                         [&](const config::StandingFinding& one) { return one.finding == f.id; });
        if (standing == may_stand.end())
          doubts_.insert(f.id);
        else
          f.texts.emplace_back(reading::stands_because, standing->reason);
      }
    }
    for (const config::StandingFinding& standing : may_stand)
      if (!known.contains(standing.finding))
        report(Error{"tables.may_stand: the readings have no finding " + standing.finding +
                         "; they have " +
                         (known.empty() ? "none" : list({known.begin(), known.end()})),
                     config::manifest_name, standing.line});
  }

  /// No analysis and no model has looked at it: said, so that nobody takes silence for a result.
  void note_unevaluated() {
    std::set<std::string> seen(read_.unread.begin(), read_.unread.end());
    for (const Results::Analysed& a : out_.results.analyses) {
      seen.insert(a.measurement);
      seen.insert(a.evaluation.uses.begin(), a.evaluation.uses.end());
    }
    for (const ModelFit& m : out_.results.models)
      seen.insert(m.measurements.begin(), m.measurements.end());
    for (std::size_t i = 0; i < read_.observations.size(); ++i) {
      const Measurement& m = out_.campaign.measurements[i];
      if (read_.observations[i].size() != 0 && !seen.contains(m.id))
        out_.results.notes.push_back({"measurement.not-evaluated", {}, {{"kind", m.kind}}, m.id});
    }
  }

  void hold_against_tolerances() {
    for (const Axis& axis : out_.campaign.machine.axes)
      for (const auto& [name, tolerance] : axis.tolerance) {
        bool found = false;
        for (const Measurement& m : out_.campaign.measurements)
          if (m.axis == axis.name && m.kind == "axis") found |= hold(axis, m.id, name, tolerance);
        if (!found)
          out_.results.conformity.push_back({"", axis.name, "", name, tolerance,
                                             deviation_of(axis.rotary), Decision::cannot_be_decided,
                                             "no-value"});
      }
  }

  bool hold(const Axis& axis, const std::string& measurement, const std::string& name,
            double tolerance) {
    bool found = false;
    for (const Results::Analysed& a : out_.results.analyses)
      for (const Value& v : a.evaluation.values) {
        if (a.measurement != measurement || v.name != name) continue;
        Conformity c{.measurement = measurement,
                     .axis = axis.name,
                     .plugin = a.plugin,
                     .name = name,
                     .tolerance = tolerance,
                     .quantity = v.quantity,
                     .decision = Decision::cannot_be_decided,
                     .reason = {}};
        if (v.U && *v.U > 0.0) {
          c.decision =
              decide(std::fabs(v.value), *v.U, tolerance, out_.campaign.certificate.decision_rule);
          if (c.decision == Decision::cannot_be_decided) c.reason = "near-limit";
        } else {
          c.reason = "no-uncertainty";
        }
        out_.results.conformity.push_back(std::move(c));
        found = true;
      }
    return found;
  }

  void word(std::vector<Remark>& notes) const {
    for (Remark& note : notes) note.english = remark_text(context_.templates, "en", note);
  }

  /// results.json speaks English; documents look the words up in their own language.
  void fill_advice() {
    word(out_.results.notes);
    for (Results::Analysed& a : out_.results.analyses)
      for (Finding& f : a.evaluation.findings)
        f.advice = finding_text(context_.templates, "en", f, "advice");
  }

  /// An output that is to be written. Without `asked` a table that the control cannot have is worth
  /// a finding, not the campaign: it was tried only because nobody said which control the machine
  /// has.
  struct Wanted {
    const Output& output;
    Settings options;
    bool asked;
  };

  std::vector<Wanted> wanted_outputs() {
    std::vector<Wanted> wanted;
    auto outputs = chosen(context_.plugins->outputs(), "output", "run.outputs",
                          read_.manifest->run.outputs, context_.site.run.outputs);
    const bool all = !read_.manifest->run.outputs && !context_.site.run.outputs;
    check_control();
    if (failed()) return wanted;
    std::stable_partition(outputs.begin(), outputs.end(),
                          [](const Output* o) { return o->stage == Output::Stage::table; });
    for (const Output* output : outputs) {
      const std::string& control = out_.campaign.machine.control;
      if (all && output->stage == Output::Stage::table && !control.empty() &&
          control != output->info.name)
        continue;
      if (output->stage == Output::Stage::table && !control_of_record(output->info.name)) continue;
      if (!applies("output", output->info.name, [&] { return output->applies(out_.campaign); }))
        continue;
      const bool asked =
          !all || output->stage != Output::Stage::table || control == output->info.name;
      if (auto options = settle(*output)) wanted.push_back({*output, std::move(*options), asked});
    }
    return wanted;
  }

  /// A table of another control than the machine's: the manifest that asks for it is wrong, and of
  /// what site.toml asks for all machines it is left out.
  bool control_of_record(const std::string& output) {
    if (!read_.machine || read_.machine->control.empty() || read_.machine->control == output)
      return true;
    if (read_.manifest->run.outputs)
      report(at("run.outputs", "asks for tables of " + output + ", and " + read_.machine->file +
                                   " says that the control is " + read_.machine->control));
    return false;
  }

  void write_outputs() {
    const auto wanted = wanted_outputs();
    if (out_.campaign.compensate_model)
      for_tables_ = modelling::compensable_readings(read_, out_.results.notes);
    word(out_.results.notes);
    bool numbered = false;
    for (const Wanted& w : wanted) {
      if (w.output.stage == Output::Stage::document && !std::exchange(numbered, true))
        draw_number(wanted);
      write_output(w);
    }
  }

  /// The output that is issued under a number; null if there is none, or an error.
  const Wanted* numbered_output(const std::vector<Wanted>& wanted) {
    const Wanted* numbered = nullptr;
    for (const Wanted& w : wanted) {
      if (w.output.lacks == nullptr) continue;
      if (numbered != nullptr)
        report(at("run.outputs", "both " + numbered->output.info.name + " and " +
                                     w.output.info.name +
                                     " are issued under a number; expected one of them"));
      numbered = &w;
    }
    return failed() ? nullptr : numbered;
  }

  /// Before the documents, which may print it.
  void draw_number(const std::vector<Wanted>& wanted) {
    const Wanted* numbered = numbered_output(wanted);
    if (numbered == nullptr) return;
    const Info& info = numbered->output.info;
    const std::string who = "output " + info.name;
    stage_(who);
    auto missing = process::guarded(who, [&]() -> Expected<std::vector<std::string>> {
      return numbered->output.lacks(input(*numbered));
    });
    if (!missing) return report(missing.error());
    OutputResult incomplete;
    incomplete.findings = reading::traceability_findings(out_.campaign);
    for (const Finding& f : incomplete.findings) missing->push_back(reason_of(f));
    if (draw_) {
      auto drawn = draw_(out_, *missing);
      if (!drawn) {
        out_.retry = true;
        return report(std::move(drawn.error()));
      }
      if (drawn->draft || !drawn->issue.number.empty()) {
        out_.certificate = std::move(*drawn);
        out_.certificate->output = info.name;
      }
    }
    if (!missing->empty() && !out_.certificate) {
      incomplete.findings.push_back({.id = "certificate.incomplete",
                                     .attention = true,
                                     .texts = {{"missing", list(*missing)}}});
      keep(info, std::move(incomplete));
    }
  }

  std::string reason_of(const Finding& f) const {
    return finding_text(context_.templates, "en", f, "title") + " (" + f.id + ")";
  }

  static std::string list(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
  }

  OutputInput input(const Wanted& w) const {
    const bool of_model = w.output.stage == Output::Stage::table && for_tables_ && *for_tables_;
    return {out_.campaign,
            of_model ? **for_tables_ : read_.observations,
            out_.results,
            w.options,
            context_.templates,
            of_model ? &read_.observations : nullptr,
            out_.certificate ? &out_.certificate->issue : nullptr};
  }

  /// On top of what was on while the campaign was measured: the new table takes its place.
  Expected<OutputResult> write_table(const Wanted& w) {
    auto on = tables::what_was_on(read_, w.output, w.options);
    if (!on) {
      if (w.asked) on.error().key = "machine.axes." + read_.tables_on.begin()->first + ".table_on";
      return fail(on.error());
    }
    if (!*on) return w.output.write(input(w));
    const bool of_model = for_tables_ && *for_tables_;
    const std::vector<Observations> of_curves =
        of_model ? tables::without_tables(out_.campaign, **for_tables_, (*on)->tables)
                 : (*on)->readings;
    auto written =
        w.output.write({out_.campaign, of_curves, out_.results, (*on)->options, context_.templates,
                        of_model ? &(*on)->readings : nullptr, nullptr});
    if (written) tables::compare_with_measured(read_, *written);
    return written;
  }

  void check_control() {
    const std::string& control = out_.campaign.machine.control;
    std::vector<std::string> tables;
    for (const Output& o : context_.plugins->outputs())
      if (o.stage == Output::Stage::table) tables.push_back(o.info.name);
    if (control.empty() || std::find(tables.begin(), tables.end(), control) != tables.end()) return;
    report(at("machine.control", "no output writes tables for \"" + control + "\"" +
                                     storage::suggestion(control, tables) + "; there are " +
                                     list(tables)));
  }

  static OutputResult without_model(const Output& output, const std::string& why) {
    OutputResult nothing;
    nothing.findings.push_back({.id = "table.no-model",
                                .attention = true,
                                .texts = {{"output", output.info.name}, {"why", why}}});
    return nothing;
  }

  /// Nobody has said why the readings are right all the same.
  OutputResult withheld(const Output& output) const {
    OutputResult nothing;
    nothing.findings.push_back({.id = "table.withheld",
                                .attention = true,
                                .texts = {{"output", output.info.name},
                                          {"findings", list({doubts_.begin(), doubts_.end()})}}});
    return nothing;
  }

  void write_output(const Wanted& w) {
    const Output& output = w.output;
    if (output.lacks != nullptr && !out_.certificate) return;
    if (output.lacks != nullptr && out_.certificate->issued) return keep_issued(output.info);
    const std::string who = "output " + output.info.name;
    stage_(who);
    auto result = process::guarded(who, [&]() -> Expected<OutputResult> {
      if (output.stage == Output::Stage::table && !doubts_.empty()) return withheld(output);
      if (output.stage == Output::Stage::table && for_tables_ && !*for_tables_)
        return without_model(output, for_tables_->error().message);
      auto written = output.stage == Output::Stage::table ? write_table(w) : output.write(input(w));
      if (!written && !w.asked && written.error().key.empty()) {
        const std::string why = std::move(written.error().message);
        written = OutputResult();
        written->findings.push_back({.id = "table.not-written",
                                     .attention = true,
                                     .texts = {{"output", output.info.name}, {"why", why}}});
      }
      if (written && !w.asked)  // a control that the machine may not even have
        for (Finding& f : written->findings)
          if (f.id == "table.axis-number") f.attention = false;
      return written;
    });
    if (result)
      if (auto sound = check(*result); !sound)
        result = fail(who + " gave " + sound.error().message);
    if (!result) {
      place_at_output(result.error(), w);
      return report(std::move(result.error()));
    }
    keep(output.info, std::move(*result));
  }

  /// Where the manifest asks for the output, if the error does not know better.
  void place_at_output(Error& error, const Wanted& w) const {
    const std::string& name = w.output.info.name;
    locate(error, name);
    const bool blamed = error.line != 0;
    if (error.file.empty()) error.file = config::manifest_name;
    const std::string& control = out_.campaign.machine.control;
    const bool own = read_.manifest->run.outputs.has_value() || control == name;
    if (const auto line = context_.site.lines.find("run.outputs");
        !blamed && error.file == config::manifest_name && !own && context_.site.run.outputs &&
        line != context_.site.lines.end() && !read_.manifest->lines.contains("options." + name)) {
      error.file = config::site_name;
      error.line = line->second;
    }
    const std::string asked = read_.manifest->run.outputs ? "run.outputs" : "machine.control";
    reading::give_line(error, read_.manifest->lines,
                       {"options." + name, own ? asked : "campaign.id", "campaign"});
  }

  /// What was issued is not written again.
  void keep_issued(const Info& output) {
    OutputResult issued;
    for (const IssuedFile& f : out_.certificate->files)
      if (f.output == output.name) issued.artifacts.push_back({f.name, f.bytes});
    keep(output, std::move(issued));
  }

  void keep(const Info& output, OutputResult result) {
    word(result.notes);
    for (Finding& f : result.findings)
      f.advice = finding_text(context_.templates, "en", f, "advice");
    for (const Artifact& a : result.artifacts) names_.insert(a.name);
    out_.results.outputs.push_back({output.name, output.version, std::move(result)});
  }

  Expected<void> check(const OutputResult& result) const {
    std::set<std::string> own;
    for (const Artifact& a : result.artifacts) {
      if (!storage::is_artifact_name(a.name))
        return fail("the file name \"" + a.name +
                    "\": expected a plain name inside the output folder");
      if (names_.contains(a.name) || !own.insert(a.name).second)
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

  bool needs_attention() const {
    const auto asks = [](const std::vector<Finding>& findings) {
      return std::any_of(findings.begin(), findings.end(),
                         [](const Finding& f) { return f.attention; });
    };
    return !read_.unread.empty() ||
           std::any_of(out_.results.analyses.begin(), out_.results.analyses.end(),
                       [&](const auto& a) { return asks(a.evaluation.findings); }) ||
           std::any_of(out_.results.outputs.begin(), out_.results.outputs.end(),
                       [&](const auto& o) { return asks(o.result.findings); }) ||
           std::any_of(out_.results.conformity.begin(), out_.results.conformity.end(),
                       [](const Conformity& c) { return c.decision != Decision::conforms; });
  }

  const fs::path& folder_;
  const reading::Context& context_;
  const reading::Stage& stage_;
  const Draw& draw_;
  const reading::Twins& twins_;
  std::string id_;
  Evaluated out_;
  reading::ReadCampaign read_;
  /// Where the manifest wants tables of the model and not of the readings; an error if there is
  /// none.
  std::optional<Expected<std::vector<Observations>>> for_tables_;
  std::set<std::string> names_;
  std::set<std::string> doubts_;  ///< ids of the findings for which no table is written
};

}  // namespace

Decision decide(double value, double U, double tolerance, std::string_view rule) {
  const bool simple = rule == "ilac-g8-simple", guarded = rule == "ilac-g8-guarded";
  if (!std::isfinite(value) || !std::isfinite(U)) return Decision::cannot_be_decided;
  if (simple || guarded)
    return value <= (guarded ? tolerance - U : tolerance) ? Decision::conforms
                                                          : Decision::does_not_conform;
  if (value <= tolerance - U) return Decision::conforms;
  if (value > tolerance + U) return Decision::does_not_conform;
  return Decision::cannot_be_decided;
}

Evaluated evaluate(const fs::path& folder, const std::string& id, const reading::Context& context,
                   const reading::Stage& stage, const Draw& draw, const reading::Twins& twins) {
  return CampaignRun(folder, context, stage, draw, twins).run(id);
}

}  // namespace nonio::host::evaluation
