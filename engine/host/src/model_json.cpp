// SPDX-License-Identifier: Apache-2.0
#include "nonio/host/model_json.h"

#include <algorithm>
#include <cmath>

#include "json_values.h"
#include "nonio/host/model_history.h"

namespace nonio::host {

namespace {

constexpr double high_correlation = 0.9;

Json parameters_json(const std::vector<model::Parameter>& parameters, bool with_effect) {
  Json list = Json::array();
  for (const model::Parameter& p : parameters) {
    Json one = Json::object();
    if (with_effect) one["effect"] = p.effect;
    one["name"] = p.name;
    const double value = printed(p.value, p.quantity), u = printed(p.u, p.quantity);
    if (std::isfinite(value)) one["value"] = value;
    if (std::isfinite(u)) one["u"] = u;
    one["unit"] = unit_of(p.quantity).symbol;
    if (p.shape) one["searched"] = true;
    if (!p.shape && std::fabs(p.value) < 2.0 * p.u) one["below_uncertainty"] = true;
    list.push_back(std::move(one));
  }
  return list;
}

Json places_json(const std::vector<model::Place>& places, const ModelWords& words,
                 Quantity deviation) {
  Json list = Json::array();
  for (const model::Place& place : places) {
    Json one = {{"where", place.where}};
    if (!place.line.empty()) one["line"] = place.line;
    put(one, "share", place.share, Quantity::ratio);
    one["says"] = words.place(place, deviation);
    put(one, "p", place.p, Quantity::probability);
    put(one, "rms", place.rms, deviation);
    if (place.at && place.at_quantity == Quantity::count)
      one["at_run"] = std::llround(*place.at);
    else
      put(one, "at", place.at, place.at_quantity);
    list.push_back(std::move(one));
  }
  return list;
}

std::vector<model::Place> failing(const std::vector<model::Place>& places) {
  std::vector<model::Place> out;
  for (const model::Place& place : places)
    if (place.p < model::place_p) out.push_back(place);
  return out;
}

Json reading_json(const ReadingPlace& at) {
  Json json = {{"measurement", at.measurement}, {"file", at.file}};
  if (at.line != 0) json["line"] = at.line;
  if (at.run != 0) json["run"] = at.run;
  if (at.direction != 0) json["direction"] = at.direction > 0 ? "+" : "-";
  put(json, "target", at.target, at.position);
  return json;
}

Json suspects_json(const std::vector<model::Suspect>& suspects, const PartModel& part,
                   const Campaign& campaign, const ModelWords& words) {
  const Quantity q = part.deviation();
  Json list = Json::array();
  for (const model::Suspect& s : suspects) {
    const ReadingPlace at = place_of(part, campaign, s.row);
    Json one = reading_json(at);
    put(one, "residual", s.residual, q);
    put(one, "t", s.t, Quantity::number);
    put(one, "minimal_detectable", s.minimal_detectable, q);
    one["says"] = words.suspect(s, at, q);
    list.push_back(std::move(one));
  }
  return list;
}

void put_floor(Json& json, const model::Comparison& c, Quantity q) {
  if (!c.floor) return;
  put(json, "noise_floor", c.floor->s, q);
  put(json, "noise_floor_u", c.floor->u, q);
}

const char* zero_text(model::Noise::Zero zero) {
  switch (zero) {
    case model::Noise::Zero::walks:
      return "walks";
    case model::Noise::Zero::of_run:
      return "of-run";
    case model::Noise::Zero::of_pass:
      return "of-pass";
    case model::Noise::Zero::steady:
      break;
  }
  return "steady";
}

/// How the noise hangs together, and what the weights and u have of it.
void put_noise(Json& json, const model::Fit& fit, Quantity q) {
  const model::Noise& noise = fit.noise;
  Json one = {{"zero", zero_text(noise.zero)}};
  put(one, "neighbours", noise.measured, Quantity::number);
  if (std::isfinite(noise.measured)) put(one, "neighbours_p", noise.p, Quantity::probability);
  put(one, "neighbours_used", noise.neighbours, Quantity::number);
  if (noise.zero != model::Noise::Zero::steady) put(one, "zero_s", noise.zero_found * fit.s, q);
  if (noise.digit > 0.0) put(one, "last_digit", noise.digit, q);
  if (noise.stretch) {
    const Quantity at = q == Quantity::deviation ? Quantity::length : Quantity::angle;
    put(one, "stretch_from", noise.stretch->from, at);
    put(one, "stretch_to", noise.stretch->to, at);
    put(one, "stretch_s", noise.stretch->inside * fit.s, q);
    put(one, "elsewhere_s", noise.stretch->outside * fit.s, q);
  }
  json["noise"] = std::move(one);
}

void put_lack_of_fit(Json& json, const model::Comparison& c) {
  if (!c.lack_of_fit) return;
  Json one = Json::object();
  put(one, "F", c.lack_of_fit->F, Quantity::number);
  put(one, "p", c.lack_of_fit->p, Quantity::probability);
  put(one, "dof1", c.lack_of_fit->dof1, Quantity::number);
  put(one, "dof2", c.lack_of_fit->dof2, Quantity::number);
  json["lack_of_fit"] = std::move(one);
}

Json model_json(const PartModel& part, const model::Comparison& c) {
  Json json = {{"effects", part.names()}};
  put(json, "rms", c.fit.rms, part.deviation());
  put(json, "cv_rms", c.cv_rms, part.deviation());
  json["parameters"] = parameters_json(c.fit.parameters, true);
  return json;
}

void put_part(Json& json, const PartModel& part) {
  json["axis"] = part.part.name;
  json["measurements"] = part.part.measurements;
  json["observations"] = part.part.table.size();
}

Json compared_json(const Compared& c, const Campaign& campaign, const ModelWords& words) {
  const Quantity q = c.part.deviation();
  const model::Comparison& comparison = c.comparison;
  Json json = Json::object();
  put_part(json, c.part);
  json["model"] = model_json(c.part, comparison);
  put(json, "rms", comparison.fit.rms, q);
  put(json, "cv_rms", comparison.cv_rms, q);
  put_floor(json, comparison, q);
  put_noise(json, comparison.fit, q);
  put(json, "s", comparison.fit.s, q);
  json["redundancy"] = comparison.fit.redundancy;
  put_lack_of_fit(json, comparison);
  if (comparison.largest != 0.0) {
    Json largest = reading_json(place_of(c.part, campaign, comparison.largest_row));
    put(largest, "residual", comparison.largest, q);
    json["largest"] = std::move(largest);
  }
  Json pairs = Json::array();
  for (const Correlated& pair : correlated(comparison.fit))
    pairs.push_back({{"one", pair.one->effect + " " + pair.one->name},
                     {"other", pair.other->effect + " " + pair.other->name},
                     {"r", printed(pair.r, Quantity::ratio)}});
  json["correlations"] = std::move(pairs);
  json["fails"] = places_json(failing(comparison.places), words, q);
  json["places"] = places_json(comparison.places, words, q);
  json["left"] = places_json(comparison.seats, words, q);
  if (comparison.means > 0) json["means"] = comparison.means;
  json["suspects"] = suspects_json(comparison.suspects, c.part, campaign, words);
  json["warnings"] = warnings_of(c.part, comparison.fit, words);
  return json;
}

Json candidate_json(const model::Candidate& c, const PartModel& part, double rms_before,
                    const ModelWords& words) {
  const Quantity q = part.deviation();
  Json json = {{"effect", c.term.name()}};
  put(json, "rms", c.rms, q);
  put(json, "cv_rms", c.cv_rms, q);
  put(json, "p", c.p, Quantity::probability);
  put(json, "score", c.score, Quantity::number);
  json["parameters"] = parameters_json(c.parameters, false);
  json["aliases"] = c.aliases;
  if (!c.beside.empty()) json["beside"] = c.beside;
  json["says"] = words.candidate(c, part, rms_before);
  put(json, "minimum_detectable_rms", c.minimal_detectable, q);
  if (c.bias > 1.0) put(json, "bias", c.bias, Quantity::ratio);
  return json;
}

/// Why an effect is no candidate, in which lines of the file, and what would help.
Json unseen_json(const model::Candidate& c, const PartModel& part, const Campaign& campaign,
                 const ModelWords& words) {
  const std::string says = words.unseen(c, place_of(part, campaign, c.rows));
  Json json = {{"effect", c.term.name()}, {"says", says}, {"why_not", c.why}};
  if (c.rows.empty()) return json;
  Json lines = Json::array();
  for (const std::uint32_t row : c.rows) lines.push_back(place_of(part, campaign, row).line);
  json["lines"] = std::move(lines);
  return json;
}

Json plans_json(const std::vector<model::Plan>& plans, const ModelWords& words) {
  Json list = Json::array();
  for (const model::Plan& plan : plans) {
    Json one = {
        {"plan", plan.id}, {"readings", plan.readings}, {"separates", {plan.one, plan.other}}};
    if (!plan.of.empty()) one["of"] = plan.of;
    put(one, "power", plan.power, Quantity::number);
    one["says"] = words.plan(plan);
    list.push_back(std::move(one));
  }
  return list;
}

Json verdict_json(const Explained& e, const ModelWords& words) {
  const model::Verdict& v = e.explanation.verdict;
  Json json = {{"kind", to_text(v.kind)}};
  if (!v.effect.empty()) json["effect"] = v.effect;
  json["says"] = words.verdict(e.explanation, e.part);
  put(json, "suspects_share", v.suspects_share, Quantity::ratio);
  return json;
}

void put_explained(Json& json, const Explained& e, const Campaign& campaign,
                   const ModelWords& words) {
  const model::Explanation& x = e.explanation;
  const Quantity q = e.part.deviation();
  json["observations"] = e.part.part.table.size();
  json["model"] = model_json(e.part, x.comparison);
  put_floor(json, x.comparison, q);
  put_noise(json, x.comparison.fit, q);
  put_lack_of_fit(json, x.comparison);
  json["fails"] = places_json(x.fails, words, q);
  Json candidates = Json::array(), unseen = Json::array();
  for (const model::Candidate& c : x.candidates)
    if (is_ranked(c))
      candidates.push_back(candidate_json(c, e.part, x.comparison.fit.rms, words));
    else
      unseen.push_back(unseen_json(c, e.part, campaign, words));
  json["candidates"] = std::move(candidates);
  json["unseen"] = std::move(unseen);
  json["together"] = x.together;
  json["certain"] = x.certain;
  Json cancelling = Json::array();
  for (const auto& pair : x.cancelling) cancelling.push_back({pair.first, pair.second});
  json["cancelling"] = std::move(cancelling);
  Json descriptions = Json::array();
  for (const model::Description& d : x.descriptions) {
    Json one = {{"effect", d.term.name()}};
    put(one, "rms", d.rms, q);
    put(one, "low", d.low, q);
    put(one, "high", d.high, q);
    put(one, "mean", d.mean, q);
    one["says"] = words.description(d, e.part);
    descriptions.push_back(std::move(one));
  }
  json["descriptions"] = std::move(descriptions);
  json["verdict"] = verdict_json(e, words);
  json["plans"] = plans_json(x.plans, words);
  json["next"] = words.next(x, e.part);
  if (const std::string text = words.no_sign(x, e.part); !text.empty()) json["no_sign"] = text;
  if (x.verdict.trials > 0) {
    put(json, "false_alarm_rate", x.verdict.false_alarms, Quantity::ratio);
    json["false_alarm_trials"] = x.verdict.trials;
  }
  json["suspects"] = suspects_json(x.comparison.suspects, e.part, campaign, words);
  json["warnings"] = warnings_of(e.part, x.comparison.fit, words);
}

Json steps_json(const std::vector<ModelStep>& steps) {
  Json list = Json::array();
  for (const ModelStep& step : steps) list.push_back(Json::parse(history_line(step)));
  return list;
}

void put_trouble(Json& json, const std::vector<std::string>& warnings,
                 const std::vector<Error>& errors) {
  if (!warnings.empty()) json["campaign_warnings"] = warnings;
  Json list = Json::array();
  for (const Error& e : errors) list.push_back(to_json(e));
  json["errors"] = std::move(list);
}

}  // namespace

const char* to_text(model::Verdict::Kind kind) {
  switch (kind) {
    case model::Verdict::Kind::missing:
      return "missing";
    case model::Verdict::Kind::nothing:
      return "nothing";
    case model::Verdict::Kind::unknown:
      return "unknown";
    case model::Verdict::Kind::unrepeatable:
      break;
  }
  return "unrepeatable";
}

bool is_ranked(const model::Candidate& c) {
  return c.visible && std::isfinite(c.score) && (c.rms > 0.0 || !c.parameters.empty());
}

std::vector<Correlated> correlated(const model::Fit& fit) {
  std::vector<Correlated> out;
  for (std::size_t i = 0; i < fit.correlation.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (const double r = fit.correlation[i][j]; std::fabs(r) > high_correlation)
        out.push_back({&fit.parameters[j], &fit.parameters[i], r});
  return out;
}

std::size_t most_severe(const std::vector<Explained>& all) {
  using Kind = model::Verdict::Kind;
  for (const Kind kind : {Kind::missing, Kind::unrepeatable, Kind::unknown})
    for (std::size_t i = 0; i < all.size(); ++i)
      if (all[i].explanation.verdict.kind == kind) return i;
  return 0;
}

std::vector<std::string> warnings_of(const PartModel& part, const model::Fit& fit,
                                     const ModelWords& words) {
  std::vector<std::string> out;
  for (const std::string& effect : below_uncertainty(fit))
    out.push_back(words.below_uncertainty(effect));
  for (std::size_t t = 0; t < fit.lost.size(); ++t)
    if (fit.lost[t] > 0) out.push_back(words.not_told(fit.terms[t].name(), fit.lost[t]));
  if (part.part.kind == model::Part::Kind::space && model::stood_somewhere(part.part))
    out.push_back(words.stood_somewhere());
  for (const std::string& measurement : part.part.order_assumed)
    out.push_back(words.order_assumed(measurement));
  if (!part.part.table.order_known) out.push_back(words.order_unknown());
  if (part.interpolated.count > 0) out.push_back(words.temperature_interpolated(part.interpolated));
  for (std::string& said : words.noise(fit, part)) out.push_back(std::move(said));
  return out;
}

std::string compare_json(const std::vector<Compared>& all, const Campaign& campaign,
                         const ModelWords& words, const std::vector<std::string>& warnings,
                         const std::vector<Error>& errors) {
  Json json = {{"schema", "nonio-compare/1"}, {"campaign", campaign.id}};
  json["model"] = {{"effects", campaign.model}};
  Json parts = Json::array();
  for (const Compared& c : all) parts.push_back(compared_json(c, campaign, words));
  json["parts"] = std::move(parts);
  put_trouble(json, warnings, errors);
  return dump(json);
}

std::string explain_json(const std::vector<Explained>& all, const Campaign& campaign,
                         const ModelWords& words, std::uint64_t seed,
                         const std::vector<ModelStep>& steps,
                         const std::vector<std::string>& warnings,
                         const std::vector<Error>& errors) {
  Json json = {{"schema", "nonio-explain/1"}, {"campaign", campaign.id}};
  put_explained(json, all[most_severe(all)], campaign, words);
  json["axis"] = all[most_severe(all)].part.part.name;
  if (all.size() > 1) {
    Json parts = Json::array();
    for (const Explained& e : all) {
      Json one = Json::object();
      put_part(one, e.part);
      put_explained(one, e, campaign, words);
      parts.push_back(std::move(one));
    }
    json["parts"] = std::move(parts);
  }
  json["seed"] = seed;
  if (!steps.empty()) json["steps"] = steps_json(steps);
  put_trouble(json, warnings, errors);
  return dump(json);
}

std::string change_json(const Change& change, const Campaign& campaign, const ModelWords& words) {
  Json json = {{"schema", "nonio-model/1"}, {"campaign", campaign.id}};
  json["step"] = Json::parse(history_line(change.step));
  json["effects"] = change.effects;
  if (change.before) json["before"] = compared_json(*change.before, campaign, words);
  if (change.after) json["after"] = compared_json(*change.after, campaign, words);
  return dump(json);
}

}  // namespace nonio::host
