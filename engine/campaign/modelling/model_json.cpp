// SPDX-License-Identifier: Apache-2.0
#include "campaign/modelling/model_json.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "campaign/modelling/after_table.h"
#include "campaign/modelling/held_terms.h"
#include "campaign/modelling/model_history.h"
#include "campaign/modelling/priors_json.h"
#include "nonio/sdk/axis_readings.h"

namespace nonio::modelling {

namespace {

bool is_stated(const model::Parameter& p, const std::vector<model::Term>& terms) {
  return p.shape && std::any_of(terms.begin(), terms.end(), [&](const model::Term& t) {
           return t.name() == p.effect && model::has_stated(t) &&
                  t.effect->shapes[t.stated->shape].parameter.name == p.name;
         });
}

/// Position of the machine at which the manifest states the fixed point, m. The shape of the effect
/// is its distance from the middle of the readings.
std::optional<double> stated_fixed_point(const model::Parameter& p,
                                         const std::vector<model::Term>& terms) {
  if (!p.shape || p.name != fixed_point_shape().parameter.name) return std::nullopt;
  for (const model::Term& t : terms)
    if (t.name() == p.effect && !t.axis.rotary) return t.axis.fixed_point;
  return std::nullopt;
}

std::string written_value(const PartModel& part, const model::Parameter& p) {
  for (const PartModel::Held& held : part.held)
    if (held.parameter.effect == p.effect) return *entry_of(held.text).value;
  return {};
}

storage::Json places_json(const std::vector<model::Place>& places, const ModelWords& words,
                          Quantity deviation) {
  storage::Json list = storage::Json::array();
  for (const model::Place& place : places) {
    storage::Json one = {{"where", to_text(place.where)}};
    if (!place.line.empty()) one["line"] = place.line;
    storage::put(one, "share", place.share, Quantity::ratio);
    one["says"] = words.place(place, deviation);
    storage::put(one, "p", place.p, Quantity::probability);
    storage::put(one, "rms", place.rms, deviation);
    if (place.at && place.at_quantity == Quantity::count)
      one["at_run"] = std::llround(*place.at);
    else
      storage::put(one, "at", place.at, place.at_quantity);
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

storage::Json reading_json(const ReadingPlace& at) {
  storage::Json json = {{"measurement", at.measurement}, {"file", at.file}};
  if (at.line != 0) json["line"] = at.line;
  if (at.run != 0) json["run"] = at.run;
  if (at.direction != 0) json["direction"] = at.direction > 0 ? "+" : "-";
  storage::put(json, "target", at.target, at.position);
  return json;
}

storage::Json suspects_json(const std::vector<model::Suspect>& suspects, const PartModel& part,
                            const Campaign& campaign, const ModelWords& words) {
  const Quantity q = part.deviation();
  storage::Json list = storage::Json::array();
  for (const model::Suspect& s : suspects) {
    const ReadingPlace at = place_of(part, campaign, s.row);
    storage::Json one = reading_json(at);
    storage::put(one, "residual", s.residual, q);
    storage::put(one, "t", s.t, Quantity::number);
    storage::put(one, "minimal_detectable", s.minimal_detectable, q);
    one["says"] = words.suspect(s, at, q);
    list.push_back(std::move(one));
  }
  return list;
}

void put_floor(storage::Json& json, const model::Comparison& c, const PartModel& part) {
  if (c.floor) {
    storage::put(json, "noise_floor", c.floor->s, part.deviation());
    storage::put(json, "noise_floor_u", c.floor->u, part.deviation());
    return;
  }
  const std::vector<std::uint32_t>& run = part.part.table.run;
  const bool runs = std::adjacent_find(run.begin(), run.end(), std::not_equal_to<>()) != run.end();
  json["noise_floor_unknown"] = runs ? "short-runs" : "no-repeats";
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

void put_noise(storage::Json& json, const model::Fit& fit, Quantity q) {
  const model::Noise& noise = fit.noise;
  storage::Json one = {{"zero", zero_text(noise.zero)}};
  storage::put(one, "neighbours", noise.measured, Quantity::number);
  if (std::isfinite(noise.measured))
    storage::put(one, "neighbours_p", noise.p, Quantity::probability);
  storage::put(one, "neighbours_used", noise.neighbours, Quantity::number);
  if (noise.zero != model::Noise::Zero::steady)
    storage::put(one, "zero_s", noise.zero_found * fit.s_noise, q);
  if (noise.digit > 0.0) storage::put(one, "last_digit", noise.digit, q);
  if (noise.stretch) {
    const Quantity at = q == Quantity::deviation ? Quantity::length : Quantity::angle;
    storage::put(one, "stretch_from", noise.stretch->from, at);
    storage::put(one, "stretch_to", noise.stretch->to, at);
    storage::put(one, "stretch_s", noise.stretch->inside * fit.s, q);
    storage::put(one, "elsewhere_s", noise.stretch->outside * fit.s, q);
  }
  json["noise"] = std::move(one);
}

void put_lack_of_fit(storage::Json& json, const model::Comparison& c, Quantity q,
                     const ModelWords& words) {
  if (!c.lack_of_fit) return;
  storage::Json one = storage::Json::object();
  storage::put(one, "F", c.lack_of_fit->F, Quantity::number);
  storage::put(one, "p", c.lack_of_fit->p, Quantity::probability);
  storage::put(one, "dof1", c.lack_of_fit->dof1, Quantity::number);
  storage::put(one, "dof2", c.lack_of_fit->dof2, Quantity::number);
  if (std::isfinite(c.lack_of_fit->F)) one["says"] = words.lack_of_fit(c, q);
  json["lack_of_fit"] = std::move(one);
}

storage::Json model_json(const PartModel& part, const model::Comparison& c,
                         const ModelWords& words) {
  storage::Json json = {{"effects", part.names()}};
  storage::put(json, "rms", c.fit.rms, part.deviation());
  storage::put(json, "cv_rms", c.cv_rms, part.deviation());
  json["parameters"] = parameters_json(c.fit.parameters, &part, c.fit.terms);
  storage::Json curves = storage::Json::array();
  for (std::size_t t = 0; t < c.fit.terms.size(); ++t)
    if (const auto curve = curve_of(part, c.fit, t))
      curves.push_back({{"effect", c.fit.terms[t].name()}, {"says", words.curve(*curve, part)}});
  if (!curves.empty()) json["curves"] = std::move(curves);
  return json;
}

void put_part(storage::Json& json, const PartModel& part) {
  json["axis"] = part.part.name;
  json["kind"] = kind_of(part.part);
  if (part.part.kind == model::Part::Kind::course) json["part"] = part.part.name;
  json["measurements"] = part.part.measurements;
  json["observations"] = part.part.table.size();
}

storage::Json positioning_json(const AfterTable::Positioning& p, Quantity q) {
  storage::Json json = storage::Json::object();
  storage::put(json, "E", p.E, q);
  storage::put(json, "A", p.A, q);
  storage::put(json, "R", p.R, q);
  return json;
}

void put_after_table(storage::Json& json, const PartModel& part, const model::Fit& fit,
                     Quantity q) {
  const AfterTable predicted = after_table(part, fit);
  if (predicted.effects.empty()) return;
  storage::Json one = {{"takes", predicted.effects}};
  storage::put(one, "rms_before", predicted.rms_before, q);
  storage::put(one, "rms", predicted.rms, q);
  storage::Json tests = storage::Json::array();
  for (const AfterTable::Test& test : predicted.tests)
    tests.push_back({{"measurement", test.measurement},
                     {"before", positioning_json(test.before, q)},
                     {"after", positioning_json(test.after, q)}});
  one["tests"] = std::move(tests);
  json["after_table"] = std::move(one);
}

/// Measurements along a path, sensed across it, whose feed is not stated.
std::vector<std::string> unstated_feed(const model::Part& part) {
  const Observations& o = part.table;
  std::set<std::string> out;
  for (std::size_t i = 0; i < o.size() && !o.sense.empty(); ++i) {
    const auto& line = o.lines[o.line_of(i)];
    if (!line.feed && line.body.empty() && o.sense[i] != line.sense)
      out.insert(part.measurements[part.measurement[i]]);
  }
  return {out.begin(), out.end()};
}

/// Returns the warnings about a fit as sentences: values below their uncertainty, gains that are
/// too large, parameters that are not identifiable, positions or orders that are not stated,
/// interpolated temperatures, channels that are not used, interrupted displacements, time constants
/// of thermal tests, and noise that is not independent or not constant.
std::vector<std::string> warnings_of(const PartModel& part, const model::Fit& fit,
                                     const ModelWords& words) {
  std::vector<std::string> out;
  for (const std::string& effect : model::below_uncertainty(fit))
    out.push_back(words.below_uncertainty(effect));
  for (const model::Parameter& p : fit.parameters)
    if (p.quantity == Quantity::deviation_per_kelvin &&
        std::fabs(p.value) - 2.0 * p.u > model::most_per_kelvin)
      out.push_back(words.gain_too_large(p));
  for (std::size_t t = 0; t < fit.lost.size(); ++t)
    if (fit.lost[t] > 0) out.push_back(words.not_identifiable(fit.terms[t].name(), fit.lost[t]));
  if (part.part.kind == model::Part::Kind::space) {
    if (const auto unstated = model::unstated_positions(part.part); !unstated.empty())
      out.push_back(words.unstated_position(unstated));
    if (const auto unstated = unstated_feed(part.part); !unstated.empty())
      out.push_back(words.unstated_feed(unstated));
    for (std::string& said : words.squareness_places(fit)) out.push_back(std::move(said));
  }
  for (const std::string& measurement : part.part.order_assumed)
    out.push_back(words.order_assumed(measurement));
  const auto& lines = part.part.table.lines;
  const bool features =
      !lines.empty() &&
      std::none_of(lines.begin(), lines.end(), [](const auto& l) { return l.body.empty(); });
  if (!part.part.table.order_known && !features) out.push_back(words.order_unknown());
  if (part.interpolated.count > 0) out.push_back(words.temperature_interpolated(part.interpolated));
  for (std::string& said : words.recordings(part, fit)) out.push_back(std::move(said));
  for (std::string& said : words.noise(fit, part)) out.push_back(std::move(said));
  return out;
}

storage::Json compared_json(const Compared& c, const Campaign& campaign, const ModelWords& words,
                            Extent extent = Extent::whole) {
  const Quantity q = c.part.deviation();
  const model::Comparison& comparison = c.comparison;
  storage::Json json = storage::Json::object();
  put_part(json, c.part);
  json["model"] = model_json(c.part, comparison, words);
  storage::put(json, "rms", comparison.fit.rms, q);
  storage::put(json, "cv_rms", comparison.cv_rms, q);
  put_floor(json, comparison, c.part);
  put_noise(json, comparison.fit, q);
  storage::put(json, "s", comparison.fit.s, q);
  json["redundancy"] = comparison.fit.redundancy;
  put_lack_of_fit(json, comparison, q, words);
  if (comparison.largest != 0.0) {
    storage::Json largest = reading_json(place_of(c.part, campaign, comparison.largest_row));
    storage::put(largest, "residual", comparison.largest, q);
    json["largest"] = std::move(largest);
  }
  storage::Json pairs = storage::Json::array();
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
  std::vector<std::string> warnings = warnings_of(c.part, comparison.fit, words);
  for (std::string& said : words.scales(c.part, comparison.fit, campaign))
    warnings.push_back(std::move(said));
  json["warnings"] = std::move(warnings);
  if (extent == Extent::whole) put_after_table(json, c.part, comparison.fit, q);
  return json;
}

storage::Json candidate_json(const model::Candidate& c, const PartModel& part, double rms_before,
                             const ModelWords& words) {
  const Quantity q = part.deviation();
  storage::Json json = {{"effect", c.term.name()}};
  storage::put(json, "rms", c.rms, q);
  storage::put(json, "cv_rms", c.cv_rms, q);
  storage::put(json, "p", c.p, Quantity::probability);
  storage::put(json, "score", c.score, Quantity::number);
  storage::put(json, "score_alone", c.alone, Quantity::number);
  storage::put(json, "score_within", c.within, Quantity::number);
  if (c.term.price > 0.0) storage::put(json, "prior_price", c.term.price, Quantity::number);
  if (c.term.frequency) put_prior(json, c.term.name(), c.term.weight, part.priors, words);
  json["parameters"] = parameters_json(c.parameters, nullptr, {c.term});
  json["aliases"] = c.aliases;
  if (!c.with_descriptions.empty())
    json["with_descriptions"] = json["beside"] = c.with_descriptions;
  json["says"] = words.candidate(c, part, rms_before);
  if (c.minimal_detectable > 0.0)
    storage::put(json, "minimum_detectable_rms", c.minimal_detectable, q);
  if (c.bias > 1.0) storage::put(json, "bias", c.bias, Quantity::ratio);
  return json;
}

storage::Json unseen_json(const model::Candidate& c, const PartModel& part,
                          const Campaign& campaign, const ModelWords& words) {
  const std::string says = words.unseen(c, place_of(part, campaign, c.rows));
  storage::Json json = {{"effect", c.term.name()}, {"says", says}, {"why_not", c.why}};
  if (c.rows.empty()) return json;
  storage::Json lines = storage::Json::array();
  for (const std::uint32_t row : c.rows) lines.push_back(place_of(part, campaign, row).line);
  json["lines"] = std::move(lines);
  return json;
}

storage::Json sensors_json(const model::Sensors& s, Quantity q) {
  storage::Json json = {{"recorded", s.recorded}, {"smallest", s.smallest}};
  storage::put(json, "cv_rms", s.rms, q);
  storage::put(json, "cv_rms_smallest", s.rms_smallest, q);
  storage::Json used = storage::Json::array();
  for (const model::Sensors::One& one : s.used) {
    storage::Json without = {{"channel", one.channel}};
    storage::put(without, "cv_rms_without", one.rms_without, q);
    used.push_back(std::move(without));
  }
  json["used"] = std::move(used);
  if (!s.unseen.empty()) {
    json["no_thermometer_for"] = s.unseen;
    storage::put(json, "tau", s.unseen_tau, Quantity::time);
  }
  json["weakest"] = s.weakest;
  storage::put(json, "relative_u", s.relative_u, Quantity::ratio);
  storage::put(json, "measured", s.measured, Quantity::time);
  storage::put(json, "wanted", s.wanted, Quantity::time);
  return json;
}

storage::Json values_json(const std::vector<model::Parameter>& parameters) {
  storage::Json list = storage::Json::array();
  for (const model::Parameter& p : parameters) {
    if (p.shape || p.group.empty()) continue;
    storage::Json one = {{"group", p.group}, {"name", p.name}};
    const double value = printed(p.value, p.quantity), U = printed(2.0 * p.u, p.quantity);
    if (std::isfinite(value)) one["value"] = value;
    if (std::isfinite(U)) one["U"] = U;
    one["unit"] = unit_of(p.quantity).symbol;
    list.push_back(std::move(one));
  }
  return list;
}

storage::Json verdict_json(const Explained& e, const ModelWords& words) {
  const model::Verdict& v = e.explanation.verdict;
  storage::Json json = {{"kind", to_text(v.kind)}};
  if (!v.effect.empty()) json["effect"] = v.effect;
  if (!v.effect.empty()) json["entry"] = model::written_for(e.part.part, v.effect);
  const auto& candidates = e.explanation.candidates;
  if (!v.effect.empty() && !candidates.empty() && candidates.front().term.grouping) {
    json["by"] = candidates.front().term.grouping->by;
    json["values"] = values_json(candidates.front().parameters);
  }
  json["says"] = words.verdict(e.explanation, e.part);
  if (const std::string text = words.card(v.effect, "is"); !text.empty()) json["is"] = text;
  if (const std::string text = words.card(v.effect, "remedy"); !text.empty())
    // The former name "cure" is written for one more version.
    json["remedy"] = json["cure"] = text;
  storage::put(json, "suspects_share", v.suspects_share, Quantity::ratio);
  return json;
}

storage::Json what_if_json(const std::vector<model::Foresight>& all,
                           const std::vector<model::Parameter>& now = {}) {
  storage::Json list = storage::Json::array();
  for (const model::Foresight& one : all) {
    storage::Json parameters = storage::Json::array(), evidence = storage::Json::array();
    for (const auto& f : one.parameters) {
      storage::Json of = {{"effect", f.effect},
                          {"name", f.parameter},
                          {"factor", printed(f.factor, Quantity::ratio)}};
      for (const model::Parameter& p : now)
        if (p.effect == f.effect && p.name == f.parameter)
          of.update({{"u", printed(p.u, p.quantity)},
                     {"then", printed(p.u * f.factor, p.quantity)},
                     {"unit", unit_of(p.quantity).symbol}});
      parameters.push_back(std::move(of));
    }
    for (const auto& x : one.evidence)
      evidence.push_back({{"effect", x.effect},
                          {"score", printed(x.now, Quantity::ratio)},
                          {"then", printed(x.then, Quantity::ratio)}});
    list.push_back({{"plan", one.id},
                    {"readings", one.readings},
                    {"parameters", std::move(parameters)},
                    {"evidence", std::move(evidence)}});
  }
  return list;
}

storage::Json statements_json(const std::vector<model::Statement>& statements,
                              const ModelWords& words, Quantity q) {
  storage::Json list = storage::Json::array();
  for (const model::Statement& s : statements) {
    const bool reversal = s.what == model::Statement::What::reversal;
    storage::Json one = {{"what", reversal ? "reversal" : "drift"}};
    storage::put(one, "value", s.value, q);
    storage::put(one, "U", 2.0 * s.u, q);
    if (reversal) {
      storage::put(one, "low", s.low, q);
      storage::put(one, "high", s.high, q);
    }
    storage::put(one, "p", s.p, Quantity::probability);
    one["says"] = words.statement(s, q);
    list.push_back(std::move(one));
  }
  return list;
}

void put_course(storage::Json& json, const PartModel& part, const model::Explanation& e) {
  if (part.part.kind != model::Part::Kind::course) return;
  storage::Json cv = {{"kind", "blocks"}, {"n", model::course_blocks}};
  storage::put(cv, "rms", e.comparison.cv_rms, part.deviation());
  json["cv"] = std::move(cv);
  storage::Json groups = storage::Json::array();
  for (const model::Candidate& c : e.candidates) {
    if (c.aliases.empty()) continue;
    std::vector<std::string> group = c.aliases;
    group.insert(group.begin(), c.term.name());
    groups.push_back(std::move(group));
  }
  json["indistinguishable"] = std::move(groups);
}

storage::Json explained_json(const Explained& e, const Campaign& campaign,
                             const ModelWords& words) {
  const model::Explanation& x = e.explanation;
  const Quantity q = e.part.deviation();
  storage::Json json = storage::Json::object();
  put_part(json, e.part);
  put_course(json, e.part, x);
  json["model"] = model_json(e.part, x.comparison, words);
  put_floor(json, x.comparison, e.part);
  put_noise(json, x.comparison.fit, q);
  put_lack_of_fit(json, x.comparison, q, words);
  json["fails"] = places_json(x.fails, words, q);
  if (e.part.part.kind != model::Part::Kind::course) put_priors(json, e.part.priors, words);
  storage::Json candidates = storage::Json::array(), unseen = storage::Json::array();
  for (const model::Candidate& c : x.candidates) {
    if (!is_ranked(c)) {
      unseen.push_back(unseen_json(c, e.part, campaign, words));
      continue;
    }
    storage::Json one = candidate_json(c, e.part, x.comparison.fit.rms, words);
    const bool is_together =
        std::find(x.together.begin(), x.together.end(), c.term.name()) != x.together.end();
    if (c.score > 0.0 && (candidates.size() < most_best || is_together)) one["best"] = true;
    candidates.push_back(std::move(one));
  }
  json["candidates"] = std::move(candidates);
  json["unseen"] = std::move(unseen);
  json["together"] = x.together;
  json["significant"] = x.certain;
  json["certain"] = x.certain;  // name in version 0.1
  storage::Json cancelling = storage::Json::array();
  for (const auto& pair : x.cancelling) cancelling.push_back({pair.first, pair.second});
  json["cancelling"] = std::move(cancelling);
  storage::Json replaceable = storage::Json::array();
  for (const model::Replaceable& r : x.replaceable)
    replaceable.push_back({{"effect", r.effect}, {"by", r.by}});
  json["replaceable"] = std::move(replaceable);
  storage::Json descriptions = storage::Json::array();
  for (const model::Description& d : x.descriptions) {
    storage::Json one = {{"effect", d.term.name()}};
    storage::put(one, "rms", d.rms, q);
    storage::put(one, "low", d.low, q);
    storage::put(one, "high", d.high, q);
    storage::put(one, "mean", d.mean, q);
    one["says"] = words.description(d, e.part);
    descriptions.push_back(std::move(one));
  }
  json["descriptions"] = std::move(descriptions);
  json["statements"] = statements_json(x.statements, words, q);
  json["verdict"] = verdict_json(e, words);
  json["plans"] = storage::Json::array();
  for (const model::Plan& plan : x.plans) json["plans"].push_back(plan_json(plan, words));
  json["next"] = words.next(x, e.part);
  if (x.sensors) json["sensors"] = sensors_json(*x.sensors, q);
  if (const std::string text = words.no_sign(x, e.part); !text.empty()) json["no_sign"] = text;
  if (x.verdict.trials > 0) {
    storage::put(json, "false_alarm_rate", x.verdict.false_alarms, Quantity::ratio);
    json["false_alarm_trials"] = x.verdict.trials;
    json["false_alarms"] = words.false_alarms(x.verdict);
  }
  json["suspects"] = suspects_json(x.comparison.suspects, e.part, campaign, words);
  json["warnings"] = warnings_of(e.part, x.comparison.fit, words);
  if (e.what_if) json["what_if"] = what_if_json(*e.what_if, x.comparison.fit.parameters);
  return json;
}

void put_trouble(storage::Json& json, const std::vector<std::string>& warnings,
                 const std::vector<Error>& errors) {
  if (!warnings.empty()) json["campaign_warnings"] = warnings;
  storage::Json list = storage::Json::array();
  for (const Error& e : errors) list.push_back(storage::to_json(e));
  json["errors"] = std::move(list);
}

}  // namespace

Json plan_json(const model::Plan& plan, const ModelWords& words) {
  Json one = {
      {"plan", plan.id}, {"readings", plan.readings}, {"separates", {plan.one, plan.other}}};
  if (!plan.of.empty()) one["of"] = plan.of;
  if (plan.duration) storage::put(one, "duration", *plan.duration, Quantity::time);
  if (plan.every) storage::put(one, "every", *plan.every, Quantity::time);
  storage::put(one, "power", plan.power, Quantity::number);
  one["says"] = words.plan(plan);
  return one;
}

storage::Json parameters_json(const std::vector<model::Parameter>& parameters,
                              const PartModel* part, const std::vector<model::Term>& terms) {
  storage::Json list = storage::Json::array();
  for (const model::Parameter& p : parameters) {
    storage::Json one = storage::Json::object();
    if (part != nullptr) one["effect"] = p.effect;
    one["name"] = p.name;
    const auto fixed = stated_fixed_point(p, terms);
    const double value = printed(fixed.value_or(p.value), p.quantity);
    const double u = printed(p.u, p.quantity);
    if (std::isfinite(value))
      one["value"] = p.quantity == Quantity::count ? Json(std::llround(value)) : Json(value);
    if (std::isfinite(u)) one["u"] = u;
    one["unit"] = unit_of(p.quantity).symbol;
    if (!p.group.empty()) one["group"] = p.group;
    if (p.shape && !fixed) one["searched"] = true;
    if (fixed) one["of_manifest"] = true;
    if (p.held) one["held"] = true;
    if (p.held && part != nullptr) one["written"] = written_value(*part, p);
    if (is_stated(p, terms)) one["stated"] = true;
    if (!p.shape && std::fabs(p.value) < 2.0 * p.u) one["below_uncertainty"] = true;
    list.push_back(std::move(one));
  }
  return list;
}

std::string part_json(const Compared& compared, const Campaign& campaign, const ModelWords& words,
                      Extent extent) {
  return storage::dump(compared_json(compared, campaign, words, extent));
}

std::string part_json(const Explained& explained, const Campaign& campaign,
                      const ModelWords& words) {
  return storage::dump(explained_json(explained, campaign, words));
}

storage::Json steps_json(const std::vector<ModelStep>& steps) {
  storage::Json list = storage::Json::array();
  for (const ModelStep& step : steps) list.push_back(storage::parse(history_line(step)));
  return list;
}

storage::Json compare_json(const std::vector<Compared>& all, const Campaign& campaign,
                           const ModelWords& words, const std::vector<std::string>& warnings,
                           const std::vector<Error>& errors) {
  storage::Json json = {{"schema", "nonio-compare/1"}, {"campaign", campaign.id}};
  json["model"] = {{"effects", campaign.model}};
  storage::Json parts = storage::Json::array();
  for (const Compared& c : all) parts.push_back(compared_json(c, campaign, words));
  json["parts"] = std::move(parts);
  put_trouble(json, warnings, errors);
  return json;
}

std::string foresight_json(const std::vector<model::Foresight>& all) {
  return storage::dump(what_if_json(all));
}

storage::Json explain_json(const std::vector<Explained>& all, const Campaign& campaign,
                           const ModelWords& words, std::uint64_t seed,
                           const std::vector<ModelStep>& steps,
                           const std::vector<std::string>& warnings,
                           const std::vector<Error>& errors) {
  storage::Json json = {{"schema", "nonio-explain/1"}, {"campaign", campaign.id}};
  storage::Json parts = storage::Json::array();
  for (const Explained& e : all) parts.push_back(explained_json(e, campaign, words));
  if (!all.empty()) json.update(parts[most_severe(all)]);
  // Displacements over time are written as parts even if there is only one.
  if (all.size() != 1 || all.front().part.part.kind == model::Part::Kind::course)
    json["parts"] = std::move(parts);
  json["seed"] = seed;
  if (!steps.empty()) json["steps"] = steps_json(steps);
  put_trouble(json, warnings, errors);
  return json;
}

storage::Json parts_of(const storage::Json& document) {
  return document.contains("parts") ? document.at("parts") : storage::Json::array({document});
}

storage::Json change_json(const Change& change, const Campaign& campaign, const ModelWords& words) {
  storage::Json json = {{"schema", "nonio-model/1"}, {"campaign", campaign.id}};
  json["step"] = storage::parse(history_line(change.step));
  json["effects"] = change.effects;
  if (!change.no_before.empty()) json["no_before"] = change.no_before;
  if (change.before) json["before"] = compared_json(*change.before, campaign, words);
  if (change.after) json["after"] = compared_json(*change.after, campaign, words);
  return json;
}

}  // namespace nonio::modelling
