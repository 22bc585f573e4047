// SPDX-License-Identifier: Apache-2.0
#include "campaign/modelling/model_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "campaign/modelling/model_verdict.h"
#include "campaign/modelling/model_words.h"
#include "campaign/modelling/thermal_tests.h"
#include "campaign/reading/names.h"
#include "nonio/sdk/channels.h"

namespace nonio::modelling {

namespace {

using Kind = model::Verdict::Kind;

Number count(const char* name, std::size_t n) {
  return {name, static_cast<double>(n), Quantity::count};
}

void add(std::vector<Value>& values, std::string name, std::optional<double> value, Quantity q,
         std::optional<double> u = std::nullopt) {
  if (!value || !std::isfinite(*value)) return;
  if (u && !std::isfinite(*u)) u.reset();
  values.push_back({std::move(name), *value, q, u ? std::optional(2.0 * *u) : std::nullopt});
}

std::vector<Value> values_of(const model::Comparison& c, Quantity q) {
  std::vector<Value> values;
  add(values, "rms", c.fit.rms, q);
  add(values, "cv_rms", c.cv_rms, q);
  if (c.floor) add(values, "noise_floor", c.floor->s, q, c.floor->u);
  if (c.largest != 0.0) add(values, "largest_residual", c.largest, q);
  add(values, "redundancy", static_cast<double>(c.fit.redundancy), Quantity::count);
  if (c.lack_of_fit) {
    add(values, "lack_of_fit_F", c.lack_of_fit->F, Quantity::number);
    add(values, "lack_of_fit_p", c.lack_of_fit->p, Quantity::probability);
  }
  for (const model::Parameter& p : c.fit.parameters)
    if (!p.held) add(values, p.effect + "." + p.name, p.value, p.quantity, p.u);
  return values;
}

class Findings {
 public:
  Findings(const PartModel& part, const Campaign& campaign) : part_(part), campaign_(campaign) {}

  std::vector<Finding> of(const model::Explanation& e) {
    verdict(e);
    fails(e.comparison);
    suspects(e.comparison);
    if (const auto small = model::below_uncertainty(e.comparison.fit); !small.empty())
      out_.push_back({"model.below-uncertainty", false, {}, {{"effects", storage::listed(small)}}});
    for (Finding& f : time_constant_findings(part_, e.comparison.fit)) out_.push_back(std::move(f));
    for (Finding& f : out_)
      std::erase_if(f.evidence, [](const Number& n) { return !std::isfinite(n.value); });
    return std::move(out_);
  }

 private:
  void verdict(const model::Explanation& e) {
    if (e.verdict.kind == Kind::nothing) return;
    Finding f = verdict_finding(e, part_);
    const bool alias = f.id == "verdict.missing-or-alias";
    f.id = "model." + std::string(to_text(e.verdict.kind)) + (alias ? "-or-alias" : "");
    out_.push_back(std::move(f));
  }

  void fails(const model::Comparison& c) {
    const auto worst = std::find_if(c.places.begin(), c.places.end(),
                                    [](const auto& place) { return place.p < model::place_p; });
    if (worst == c.places.end()) return;
    Finding f{
        "model.fails", true, {}, {{"where", to_text(worst->where)}, {"line", on_line(*worst)}}};
    f.evidence = {{"share", worst->share, Quantity::ratio},
                  {"percent", std::round(100.0 * worst->share), Quantity::count},
                  {"p", worst->p, Quantity::probability},
                  {"rms", c.fit.rms, part_.deviation()}};
    if (worst->at && std::isfinite(*worst->at))
      f.evidence.push_back({"at", *worst->at, worst->at_quantity});
    out_.push_back(std::move(f));
  }

  void suspects(const model::Comparison& c) {
    if (c.suspects.empty()) return;
    std::vector<std::string> which;
    for (const model::Suspect& s : c.suspects) {
      const ReadingPlace at = place_of(part_, campaign_, s.row);
      which.push_back(at.file + ":" + std::to_string(at.line));
    }
    out_.push_back({"model.suspects",
                    false,
                    {count("readings", which.size())},
                    {{"which", storage::listed(which)}}});
  }

  const PartModel& part_;
  const Campaign& campaign_;
  std::vector<Finding> out_;
};

Finding cannot_fit(const std::string& reason) {
  return {"model.cannot-fit", true, {}, {{"reason", reason}}};
}

bool follows(const PartModel& part, const std::string& channel) {
  return std::any_of(part.terms.begin(), part.terms.end(), [&](const model::Term& term) {
    const std::string& of = term.axis.name;
    return of == channel || of.starts_with(channel + "-") || of.ends_with("-" + channel);
  });
}

void put_channels(ModelFit& out, const PartModel& whole) {
  const Observations& o = whole.part.table;
  for (const Observations::Channel& c : o.channels) {
    std::vector<double> values = lagged(c, 0.0, o.time);
    for (double& v : values) v += c.value.front();
    out.channels.push_back({c.name, c.unit, follows(whole, c.name), std::move(values)});
  }
}

void put_readings(ModelFit& out, const PartModel& whole) {
  const model::Part& part = whole.part;
  const Observations& o = part.table;
  if (part.kind == model::Part::Kind::course) put_channels(out, whole);
  out.measurement = part.measurement;
  out.source_line = o.source_line;
  out.run = o.run;
  out.target = part.along;
  out.direction = part.way;
  out.time = o.time;
  out.temperature = o.material;
  out.deviation = whole.measured();
}

/// Sets what a fit leaves, for the model and for the model without one effect.
template <class Out>
void put_residuals(Out& out, const model::Comparison& c) {
  out.rms = c.fit.rms;
  out.cv_rms = c.cv_rms;
  out.largest = c.largest;
  out.residual = c.fit.residual;
  out.weight = c.fit.weight;
  out.cv_residual = c.cv_residual;
  if (c.floor) {
    out.floor = c.floor->s;
    out.floor_u = c.floor->u;
  }
  for (const model::Suspect& s : c.suspects) out.suspects.push_back({s.row, s.minimal_detectable});
}

void put_fit(ModelFit& out, const PartModel& part, const model::Comparison& c) {
  const model::Fit& fit = c.fit;
  put_residuals(out, c);
  for (std::size_t t = 0; t < fit.terms.size(); ++t)
    out.effects.push_back({fit.terms[t].name(), fit.terms[t].effect->compensable, fit.part[t],
                           curve_of(part, fit, t), fit.terms[t].effect->is_nuisance});
  for (const model::Parameter& p : fit.parameters)
    out.parameters.push_back({p.effect, p.name, p.value,
                              std::isfinite(p.u) ? std::optional(p.u) : std::nullopt, p.quantity,
                              p.shape});
  out.correlation = fit.correlation;
}

// With more readings, reduced models are not fitted, because each fit takes seconds.
constexpr std::size_t most_refitted = 20000;

std::vector<model::Term> chosen(const std::vector<model::Term>& terms,
                                const std::vector<char>& in) {
  std::vector<model::Term> out;
  for (std::size_t t = 0; t < terms.size(); ++t)
    if (in[t] != 0) out.push_back(terms[t]);
  return out;
}

std::vector<char> set_up_of(const std::vector<model::Term>& terms) {
  std::vector<char> in;
  for (const model::Term& term : terms) in.push_back(term.effect->is_nuisance ? 1 : 0);
  return in;
}

/// Orders effects by their reduction of the RMS; with more than 20000 readings, as in the model.
std::vector<std::size_t> falling_order(const PartModel& part, const model::Fit& whole) {
  std::vector<std::size_t> order;
  std::vector<char> in = set_up_of(part.terms);
  const auto effects = static_cast<std::size_t>(std::count(in.begin(), in.end(), 0));
  while (order.size() < effects) {
    std::size_t best = part.terms.size();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t t = 0; t < part.terms.size(); ++t) {
      if (in[t] != 0) continue;
      if (best == part.terms.size()) best = t;
      if (part.part.table.size() > most_refitted) break;
      in[t] = 1;
      const auto fitted = model::fit(part.part.table, chosen(whole.terms, in), whole.weight);
      in[t] = 0;
      if (fitted && fitted->rms < least) least = fitted->rms, best = t;
    }
    in[best] = 1;
    order.push_back(best);
  }
  return order;
}

void put_steps(ModelFit& out, const PartModel& part, const model::Comparison& whole) {
  const std::vector<std::size_t> order = falling_order(part, whole.fit);
  PartModel grown = part;
  std::vector<char> in = set_up_of(part.terms);
  for (std::size_t n = 0; n < order.size(); ++n) {
    grown.terms = chosen(part.terms, in);
    if (const auto c = compare_part(grown))
      out.steps.push_back({n == 0 ? "" : part.terms[order[n - 1]].name(), c->fit.rms, c->cv_rms});
    in[order[n]] = 1;
  }
  out.steps.push_back(
      {order.empty() ? "" : part.terms[order.back()].name(), whole.fit.rms, whole.cv_rms});
}

void put_candidates(ModelFit& out, const PartModel& part, const model::Explanation& e) {
  for (const model::Candidate& c : e.candidates) {
    if (!is_ranked(c) || !(c.score > 0.0)) continue;
    // In correlated readings, evidence that also occurs without a cause is left out.
    if (part.part.kind == model::Part::Kind::course && !(c.p < e.verdict.false_alarms)) continue;
    const bool certain =
        std::find(e.certain.begin(), e.certain.end(), c.term.name()) != e.certain.end();
    out.candidates.push_back(
        {c.term.name(), c.score, c.rms, c.cv_rms, c.p, c.minimal_detectable, c.aliases, certain});
  }
  out.no_sign = no_sign_findings(e, part);
  out.next = next_findings(e, part);
}

/// Returns null unless one axis moved, because the phase of a screw is otherwise not defined.
const Axis* one_moved(const model::Part& part) {
  const Axis* moved = nullptr;
  for (const auto& column : part.table.axes) {
    const auto [low, high] = std::minmax_element(column.position.begin(), column.position.end());
    if (low == high || !(*low < *high)) continue;
    const auto axis = std::find_if(part.axes.begin(), part.axes.end(),
                                   [&](const Axis& a) { return a.name == column.axis; });
    if (moved != nullptr || axis == part.axes.end()) return nullptr;
    moved = &*axis;
  }
  return moved;
}

ModelFit value_of(const PartModel& part, const model::Explanation& e) {
  ModelFit out = fitted_value(part, e.comparison);
  put_steps(out, part, e.comparison);
  out.without = without_each(part);
  put_candidates(out, part, e);
  out.diagnosis = {verdict_finding(e, part)};
  if (e.comparison.lack_of_fit && std::isfinite(e.comparison.lack_of_fit->F))
    out.diagnosis.push_back(left_finding(e.comparison, part.deviation()));
  for (const model::Place& place : e.verdict.kind == Kind::unknown ? e.fails : e.comparison.seats)
    out.diagnosis.push_back(place_finding(place, part.deviation()));
  for (const model::Description& d : e.descriptions)
    out.diagnosis.push_back(description_finding(d, part));
  if (e.verdict.trials > 0) out.diagnosis.push_back(false_alarms_finding(e.verdict));
  return out;
}

std::vector<char> first_of_each(const Observations& o) {
  std::set<std::vector<double>> seen;
  std::vector<char> kept(o.size(), 0);
  for (std::size_t i = 0; i < o.size(); ++i) {
    std::vector<double> place{static_cast<double>(o.line.empty() ? 0 : o.line[i])};
    for (const auto& axis : o.axes) {
      place.push_back(axis.position[i]);
      if (!axis.approach.empty()) place.push_back(axis.approach[i]);
    }
    kept[i] = seen.insert(std::move(place)).second ? 1 : 0;
  }
  return kept;
}

/// Sum of the compensable effects for each reading, m or rad.
std::vector<double> compensable_part(const model::Fit& fit) {
  std::vector<double> said(fit.residual.size(), 0.0);
  for (std::size_t t = 0; t < fit.terms.size(); ++t) {
    if (!fit.terms[t].effect->compensable) continue;
    for (std::size_t i = 0; i < said.size(); ++i) said[i] += fit.part[t][i];
  }
  return said;
}

std::vector<std::string> compensable(const model::Fit& fit) {
  std::vector<std::string> names;
  for (const model::Term& t : fit.terms)
    if (t.effect->compensable) names.push_back(t.name());
  return names;
}

Remark compensated(const PartModel& part, const std::vector<std::string>& effects) {
  Remark remark{effects.empty() ? "model.not-compensated" : "model.compensated",
                {},
                {{"axis", part.part.name}},
                part.part.measurements.front()};
  if (!effects.empty()) remark.texts.emplace_back("effects", storage::listed(effects));
  return remark;
}

}  // namespace

ModelFit measured_value(const PartModel& part) {
  const bool balls = part.part.kind == model::Part::Kind::balls;
  const Axis* const axis = balls ? nullptr : one_moved(part.part);
  ModelFit out;
  out.part = out.axis = part.part.name;
  out.measurements = part.part.measurements;
  out.rotary = part.position() == Quantity::angle;
  out.angular = part.part.table.angular;
  if (axis != nullptr && axis->rotary && axis->teeth)
    out.period = 2.0 * std::numbers::pi / static_cast<double>(*axis->teeth);
  else if (axis != nullptr)
    out.period = axis->screw_pitch;
  else if (!balls)
    out.period = 0.0;
  put_readings(out, part);
  out.residual = out.deviation;
  return out;
}

ModelFit fitted_value(const PartModel& part, const model::Comparison& comparison) {
  ModelFit out = measured_value(part);
  put_fit(out, part, comparison);
  return out;
}

std::vector<ModelFit::Without> without_each(const PartModel& part) {
  std::vector<ModelFit::Without> out;
  if (part.part.table.size() > most_refitted) return out;
  for (std::size_t t = 0; t < part.terms.size(); ++t) {
    if (part.terms[t].effect->is_nuisance) continue;
    PartModel rest = part;
    rest.terms.erase(rest.terms.begin() + static_cast<std::ptrdiff_t>(t));
    const auto c = compare_part(rest);
    if (!c) continue;
    out.emplace_back().effect = part.terms[t].name();
    put_residuals(out.back(), *c);
  }
  return out;
}

Expected<ModelFits> model_fit(const reading::ReadCampaign& read, const reading::Context& context) {
  const Campaign& campaign = read.manifest->campaign;
  NONIO_TRY(const auto parts, part_models(read, campaign.model));
  ModelFits out;
  for (const PartModel& part : parts) {
    Results::Analysed one{reading::model_fit_name,
                          context.version,
                          part.part.measurements.front(),
                          {},
                          part.part.kind == model::Part::Kind::course ? part.part.name : ""};
    Evaluation& evaluation = one.evaluation;
    if (part.part.measurements.size() > 1)
      evaluation.notes.push_back({"model.joined",
                                  {},
                                  {{"measurements", storage::listed(part.part.measurements)},
                                   {"part", kind_of(part.part)},
                                   {"axis", part.part.name}}});
    if (const auto e = explain_part(part, 1)) {
      evaluation.values = values_of(e->comparison, part.deviation());
      evaluation.findings = Findings(part, campaign).of(*e);
      out.models.push_back(value_of(part, *e));
    } else {
      evaluation.findings = {cannot_fit(e.error().message)};
    }
    out.analyses.push_back(std::move(one));
  }
  return out;
}

Expected<std::vector<Observations>> compensable_readings(const reading::ReadCampaign& read,
                                                         std::vector<Remark>& notes) {
  const Campaign& campaign = read.manifest->campaign;
  NONIO_TRY(auto parts, part_models(read, campaign.model));
  std::vector<Observations> out = read.observations;
  // A measurement that belongs to two states of the machine is in two parts.
  std::set<std::size_t> done;
  for (const PartModel& part : parts) {
    const auto compared = compare_part(part);
    if (!compared)
      return fail(Error{"model.compensate: " + compared.error().message +
                            "; no table can be written from this model",
                        config::manifest_name});
    const std::vector<double> said = compensable_part(compared->fit);
    const std::vector<std::string> names = compensable(compared->fit);
    notes.push_back(compensated(part, names));
    for (std::size_t k = 0; k < part.part.measurements.size(); ++k)
      for (std::size_t m = 0; m < out.size(); ++m) {
        if (campaign.measurements[m].id != part.part.measurements[k] || done.contains(m)) continue;
        done.insert(m);
        if (campaign.measurements[m].kind == "ball-centres") continue;
        for (std::size_t i = 0; i < said.size(); ++i)
          if (part.part.measurement[i] == k) out[m].deviation[part.part.row[i]] = said[i];
        keep_rows(out[m],
                  names.empty() ? std::vector<char>(out[m].size(), 0) : first_of_each(out[m]));
        out[m].run.assign(out[m].size(), 1);
      }
  }
  return out;
}

}  // namespace nonio::modelling
