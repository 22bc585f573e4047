// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>

#include "campaign/evaluation/evaluation.h"
#include "campaign/modelling/model_fit.h"
#include "campaign/reading/names.h"
#include "nonio/math/decision.h"
#include "nonio/sdk/campaign.h"
#include "nonio/sdk/check.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/results.h"
#include "nonio/sdk/statement.h"
#include "platform/process/guarded.h"

namespace nonio::evaluation {

namespace {

/// Raises each U to at least the CMC over `length` (m) or the measured range. Does nothing without accreditation. Source:
/// the policy of ILAC-P14; its text was not available.
void apply_cmc(const Laboratory& laboratory, double length, const math::Ranges& measured,
               Evaluation& e) {
  if (laboratory.accreditation.empty() || !laboratory.cmc.stated()) return;
  std::string raised;
  const auto raise = [&](double& U, Quantity q) {
    const double least = math::least_U(laboratory, q, length, measured);
    const bool below = U < least;
    if (below) U = least;
    return below;
  };
  const auto note = [&](const std::string& name) { raised += (raised.empty() ? "" : ", ") + name; };
  for (Value& v : e.values)
    if (v.U && raise(*v.U, v.quantity)) {
      v.k = 2.0;  // coverage factor of [laboratory.cmc]
      note(v.name);
    }
  for (PointTable::Column& c : e.points.columns)
    if (c.U) raise(*c.U, c.quantity);
  for (Series& s : e.series) {
    bool any = false;
    for (double& U : s.U) any = raise(U, s.quantity) || any;
    if (any) note(s.name);
  }
  if (!raised.empty())
    e.findings.push_back({.id = "uncertainty.cmc", .texts = {{"results", std::move(raised)}}});
}

void note_reasons_missing(const Measurement& m, Evaluation& evaluation) {
  if (m.exclude.empty() || has_content(m.exclude_reason)) return;
  evaluation.findings.push_back(
      {.id = "readings.excluded-without-reason",
       .attention = true,
       .evidence = {{"excluded", static_cast<double>(m.exclude.size()), Quantity::count}},
       .texts = {{"file", m.file}, {"id", m.id}}});
}

/// Largest range of positions of a linear or rotary axis, m or rad; 0 without one.
double range_of(const reading::ReadCampaign& read, const Measurement* measurement, bool rotary) {
  double most = 0.0;
  for (std::size_t i = 0; measurement != nullptr && i < read.observations.size(); ++i)
    if (read.manifest->campaign.measurements[i].id == measurement->id)
      for (const auto& axis : read.observations[i].axes)
        if (axis.rotary == rotary && !axis.position.empty()) {
          const auto [low, high] = std::minmax_element(axis.position.begin(), axis.position.end());
          most = std::max(most, *high - *low);
        }
  return most;
}

/// For analyses that do not mark the values that are compared between campaigns.
void follow_all(const std::string& plugin, const Measurement* m, Evaluation& e) {
  for (Value& v : e.values) {
    v.followed = {plugin + ':' + v.name, m == nullptr ? std::string() : m->axis};
    if (m == nullptr) continue;
    if (!m->compensation.empty()) v.followed->texts.emplace_back("compensation", m->compensation);
    if (!m->at.empty()) v.followed->texts.emplace_back("at", positions_text(m->at));
  }
}

/// `measurement` is null for the whole campaign. Returns nullopt after an error, which is reported.
std::optional<Results::Analysed> analysed_with(
    const Work& work, const Analysis& analysis, const Measurement* measurement,
    const std::function<Expected<Evaluation>(const Settings&)>& call) {
  const auto options = work.settle(analysis.info);
  if (!options) return std::nullopt;
  const std::string who = "analysis " + analysis.info.name;
  const std::string id = measurement == nullptr ? "" : measurement->id;
  work.stage(measurement == nullptr ? who : who + " (measurement " + id + ")");
  auto evaluation = process::guarded(who, [&] { return call(*options); });
  if (evaluation)
    if (auto sound = check(*evaluation); !sound)
      evaluation = fail(who + " gave " + sound.error().message);
  if (!evaluation) {
    Error& error = evaluation.error();
    work.locate_error(error, analysis.info.name);
    if (error.file.empty())
      error.file = measurement == nullptr ? config::manifest_name : measurement->file;
    reading::give_line(error, work.read.manifest->lines,
                       {"options." + analysis.info.name, "run.analyses"});
    work.report(std::move(error));
    return std::nullopt;
  }
  const std::vector<std::string>& uses = evaluation->uses;
  for (const Measurement& m : work.campaign().measurements)
    if (m.id == id || std::find(uses.begin(), uses.end(), m.id) != uses.end())
      note_reasons_missing(m, *evaluation);
  const math::Ranges measured{range_of(work.read, measurement, false),
                              range_of(work.read, measurement, true)};
  apply_cmc(work.campaign().laboratory,
            evaluation->budget ? evaluation->budget->length : measured.length, measured,
            *evaluation);
  for (Finding& f : evaluation->findings) f.measurement = id;
  if (!analysis.states_followed) follow_all(analysis.info.name, measurement, *evaluation);
  return Results::Analysed{analysis.info.name, analysis.info.version, id, std::move(*evaluation)};
}

const ControlTable* control_table(const Work& work) {
  for (const auto& one : work.context.plugins->controllers())
    if (one.info.name == work.campaign().machine.control) return &one.table;
  return nullptr;
}

}  // namespace

std::vector<Results::Analysed> run_analyses(const Work& work) {
  const reading::ReadCampaign& read = work.read;
  const PluginNames& names =
      read.manifest->run.analyses ? read.manifest->run.analyses : work.context.site.run.analyses;
  const auto& all = work.context.plugins->analyses();
  report_absent(work, "analysis", "run.analyses", names,
                [&](const std::string& name) { return has_plugin(all, name); });
  const auto analyses = chosen_plugins(work, all, names);
  for (Error& e : reading::ownerless_options(read.manifest->options, *work.context.plugins))
    work.report(std::move(e));
  std::vector<Results::Analysed> out;
  const auto add = [&](std::optional<Results::Analysed> one) {
    if (one) out.push_back(std::move(*one));
  };
  for (std::size_t i = 0; i < read.observations.size(); ++i) {
    const Measurement& m = work.campaign().measurements[i];
    if (read.observations[i].size() == 0) continue;
    for (const Analysis* analysis : analyses)
      if (analysis->applies &&
          work.asks_to_apply("analysis " + analysis->info.name, " (measurement " + m.id + ")",
                             [&] { return analysis->applies(work.campaign(), m); }))
        add(analysed_with(work, *analysis, &m, [&](const Settings& options) {
          return analysis->analyse({work.campaign(), m, read.observations[i], options,
                                    &read.observations, control_table(work)});
        }));
  }
  for (const Analysis* analysis : analyses)
    if (analysis->analyse_campaign)
      add(analysed_with(work, *analysis, nullptr, [&](const Settings& options) {
        return analysis->analyse_campaign({work.campaign(), read.observations, options});
      }));
  return out;
}

std::vector<Results::Analysed> fit_models(const Work& work, std::vector<ModelFit>& models) {
  const auto& own = work.read.manifest->run.analyses;
  const auto& names = own ? own : work.context.site.run.analyses;
  const bool asked =
      names ? std::find(names->begin(), names->end(), reading::model_fit_name) != names->end()
            : !work.campaign().model.empty();
  if (!asked) return {};
  work.stage("analysis " + std::string(reading::model_fit_name));
  auto fitted = modelling::model_fit(work.read, work.context);
  if (!fitted) {
    work.report(std::move(fitted.error()));
    return {};
  }
  models = std::move(fitted->models);
  for (Results::Analysed& one : fitted->analyses)
    for (Finding& f : one.evaluation.findings) f.measurement = one.measurement;
  return std::move(fitted->analyses);
}

std::vector<Remark> unevaluated(const reading::ReadCampaign& read, const Results& results) {
  std::set<std::string> seen(read.unread.begin(), read.unread.end());
  for (const Results::Analysed& a : results.analyses) {
    seen.insert(a.measurement);
    seen.insert(a.evaluation.uses.begin(), a.evaluation.uses.end());
  }
  for (const ModelFit& m : results.models)
    seen.insert(m.measurements.begin(), m.measurements.end());
  std::vector<Remark> notes;
  for (std::size_t i = 0; i < read.observations.size(); ++i) {
    const Measurement& m = read.manifest->campaign.measurements[i];
    if (read.observations[i].size() != 0 && !seen.contains(m.id))
      notes.push_back({"measurement.not-evaluated", {}, {{"kind", method_name(m)}}, m.id});
  }
  const bool fitted =
      std::any_of(results.analyses.begin(), results.analyses.end(),
                  [](const auto& a) { return a.plugin == reading::model_fit_name; });
  if (!read.manifest->campaign.model.empty() && !fitted) notes.push_back({"model.not-asked"});
  return notes;
}

}  // namespace nonio::evaluation
