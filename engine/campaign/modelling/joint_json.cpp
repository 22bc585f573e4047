// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "campaign/modelling/joint_model.h"
#include "campaign/modelling/model_json.h"
#include "campaign/modelling/priors_json.h"
#include "nonio/math/distributions.h"
#include "nonio/sdk/format.h"

namespace nonio::modelling {

namespace {

using model::Holds;
using storage::Json;

const char* name_of(Holds holds) {
  switch (holds) {
    case Holds::shared:
      return "shared";
    case Holds::changed:
      return "changed";
    case Holds::own:
      break;
  }
  return "own";
}

/// Whether the effect has more than 3 linear parameters in a group; then only its RMS is printed.
bool is_curve(const std::vector<model::Parameter>& group) {
  return std::count_if(group.begin(), group.end(), [](const auto& p) { return !p.shape; }) > 3;
}

/// `shapes`: also the values that were searched, such as a time constant.
std::string value_text(const std::vector<model::Parameter>& group, double size, Quantity deviation,
                       const config::TerminalWords& say, bool shapes = false) {
  std::string out;
  const auto is_shown = [&](const model::Parameter& p) {
    return !p.shape || (shapes && p.quantity != Quantity::count);
  };
  const bool several = std::count_if(group.begin(), group.end(), is_shown) > 1;
  if (is_curve(group))
    return "RMS " + say.number(short_text(printed(size, deviation))) + " " +
           std::string(unit_of(deviation).symbol);
  for (const model::Parameter& p : group) {
    if (!is_shown(p)) continue;
    const std::string unit(unit_of(p.quantity).symbol);
    out += (out.empty() ? "" : "; ") + (several ? p.name + " " : std::string()) +
           say.number(short_text(printed(p.value, p.quantity))) + (unit.empty() ? "" : " " + unit);
    if (std::isfinite(p.u))
      out += ", U = " + say.number(short_text(2.0 * printed(p.u, p.quantity), 2));
  }
  return out;
}

std::string place_text(const Together& t, std::size_t campaign, const config::TerminalWords& say) {
  std::vector<std::string> more;
  if (each_once(t.machines).size() > 1) more.push_back(t.machines[campaign]);
  if (!t.adjustments[campaign].empty()) more.push_back(say("joint." + t.adjustments[campaign]));
  if (!t.dates[campaign].empty()) more.push_back(t.dates[campaign]);
  return t.campaigns[campaign] + (more.empty() ? "" : " (" + storage::listed(more) + ")");
}

bool is_absent(const std::vector<model::Parameter>& group) {
  constexpr double least_p = 0.001;
  double squares = 0.0, count = 0.0;
  for (const model::Parameter& p : group)
    if (!p.shape && p.u > 0.0) squares += p.value * p.value / (p.u * p.u), ++count;
  return math::chi2_upper(squares, count) > least_p;
}

std::pair<std::size_t, std::size_t> extremes(const model::JointEffect& e) {
  std::pair<std::size_t, std::size_t> out{e.groups.size(), e.groups.size()};
  for (std::size_t g = 0; g < e.groups.size(); ++g) {
    if (e.groups[g].empty() || e.groups[g].front().shape) continue;
    const double value = e.groups[g].front().value;
    if (out.first == e.groups.size() || value < e.groups[out.first].front().value) out.first = g;
    if (out.second == e.groups.size() || value > e.groups[out.second].front().value) out.second = g;
  }
  return out;
}

std::size_t most_severe(const std::vector<Together>& all) {
  const auto rank = [](const Together& t) {
    return t.explanation.verdict == model::Verdict::Kind::missing   ? 0
           : t.explanation.verdict == model::Verdict::Kind::unknown ? 1
                                                                    : 2;
  };
  return static_cast<std::size_t>(
      std::min_element(all.begin(), all.end(),
                       [&](const Together& a, const Together& b) { return rank(a) < rank(b); }) -
      all.begin());
}

std::string sentence_of(const model::JointEffect& e, const Together& t,
                        const config::TerminalWords& say) {
  const Quantity q = t.deviation();
  if (e.holds == Holds::shared)
    return say("joint.shared", {{"effect", e.effect},
                                {"value", value_text(e.groups.front(), e.size, q, say, true)}});
  if (e.holds == Holds::changed) {
    if (is_curve(e.groups[0]))
      return say("joint.changed-curve", {{"effect", e.effect},
                                         {"last", place_text(t, e.after - 1, say)},
                                         {"first", place_text(t, e.after, say)},
                                         {"value", value_text(e.groups[0], e.size, q, say)}});
    const char* id = is_absent(e.groups[0])   ? "joint.appears"
                     : is_absent(e.groups[1]) ? "joint.vanishes"
                                              : "joint.changed";
    return say(id, {{"effect", e.effect},
                    {"last", place_text(t, e.after - 1, say)},
                    {"first", place_text(t, e.after, say)},
                    {"before", value_text(e.groups[0], e.size, q, say)},
                    {"after", value_text(e.groups[1], e.size, q, say)}});
  }
  const auto [low, high] = extremes(e);
  if (is_curve(e.groups[low]))
    return say("joint.own-curve",
               {{"effect", e.effect}, {"value", value_text(e.groups[low], e.size, q, say)}});
  return say("joint.own", {{"effect", e.effect},
                           {"low", value_text(e.groups[low], e.size, q, say)},
                           {"of-low", place_text(t, low, say)},
                           {"high", value_text(e.groups[high], e.size, q, say)},
                           {"of-high", place_text(t, high, say)}});
}

/// U of the difference of two scales with what all readings of a campaign have in common; infinite
/// if that is not known, nullopt if the effect has no scale that differs.
std::optional<double> U_of_difference(const model::JointEffect& e, const Together& t) {
  if (e.holds == Holds::shared || !e.effect.starts_with("scale:")) return std::nullopt;
  const auto [low, high] = extremes(e);
  if (low == high || e.groups[low].front().quantity != Quantity::deviation_per_length)
    return std::nullopt;
  double variance = 0.0;
  for (const std::size_t g : {low, high}) {
    const std::size_t member = e.holds == Holds::own ? g : e.after - (g == 0 ? 1 : 0);
    const double common = t.u_scale[member].value_or(INFINITY), own = e.groups[g].front().u;
    variance += common * common + own * own;
  }
  return 2.0 * std::sqrt(variance);
}

/// The sentence, with what instrument, misalignment and temperatures permit to say of a difference.
std::string qualified(const model::JointEffect& e, const Together& t,
                      const config::TerminalWords& say) {
  const std::string sentence = sentence_of(e, t, say);
  const auto U = U_of_difference(e, t);
  if (!U) return sentence;
  const auto [low, high] = extremes(e);
  if (!std::isfinite(*U)) return sentence + " " + say("joint.scale-unknown");
  if (e.groups[high].front().value - e.groups[low].front().value > *U) return sentence;
  const Quantity q = Quantity::deviation_per_length;
  return sentence + " " +
         say("joint.scale-within", {{"U", say.number(short_text(printed(*U, q), 2)) + " " +
                                              std::string(unit_of(q).symbol)}});
}

std::string sentence_of(const Together& t, const config::TerminalWords& say) {
  const model::JointExplanation& x = t.explanation;
  const Quantity q = t.deviation();
  constexpr int usual = 3, most = 5;
  const auto text_of = [&](double v, int digits) { return short_text(printed(v, q), digits); };
  const bool falls = x.verdict == model::Verdict::Kind::missing;
  const int digits = falls && text_of(x.rms, usual) == text_of(x.rms_after, usual) ? most : usual;
  const auto text = [&](double v) {
    return say.number(text_of(v, digits)) + " " + std::string(unit_of(q).symbol);
  };
  std::vector<std::string> names;
  for (const model::JointEffect& e : x.effects) names.push_back(e.effect);
  const config::TerminalWords::Parts parts{{"part", t.part},
                                           {"count", std::to_string(each_once(t.campaigns).size())},
                                           {"effects", storage::listed(names)},
                                           {"before", text(x.rms)},
                                           {"after", text(x.rms_after)},
                                           {"floor", text(x.noise)}};
  if (x.single) {
    config::TerminalWords::Parts of_one = parts;
    of_one.emplace_back("campaign", t.campaigns[x.single->campaign]);
    of_one.emplace_back("effect", x.single->effect);
    return say("joint.single", of_one);
  }
  std::string out = say(falls                                        ? "joint.missing"
                        : x.verdict == model::Verdict::Kind::unknown ? "joint.unknown"
                                                                     : "joint.nothing",
                        parts);
  if (falls && !x.explains_all) out += " " + say("joint.more", parts);
  return out;
}

Json effect_json(const model::JointEffect& e, const Together& t, const ModelWords& words) {
  const config::TerminalWords say = words.terminal();
  const Quantity q = t.deviation();
  Json json = {{"effect", e.effect}, {"per_campaign", name_of(e.holds)}};
  storage::put(json, "rms", e.rms, q);
  storage::put(json, "size", e.size, q);
  json["score"] = e.evidence;
  json["p"] = e.p;
  put_prior(json, e.effect, e.weight, t.parts.front().priors, words);
  if (e.holds == Holds::shared) {
    json["parameters"] = parameters_json(e.groups.front());
  } else {
    Json values = Json::array();
    for (std::size_t g = 0; g < e.groups.size(); ++g) {
      Json one = Json::object();
      const std::size_t at = e.holds == Holds::own ? g : e.after - (g == 0 ? 1 : 0);
      one[e.holds == Holds::own ? "campaign" : g == 0 ? "to" : "from"] = t.campaigns[at];
      if (!t.adjustments[at].empty()) one["adjustment"] = t.adjustments[at];
      if (!e.groups[g].empty()) one["parameters"] = parameters_json(e.groups[g]);
      values.push_back(std::move(one));
    }
    json["values"] = std::move(values);
    if (e.holds == Holds::changed) {
      json["after"] = t.dates[e.after - 1];
      json["before"] = t.dates[e.after];
    }
  }
  json["aliases"] = e.aliases;
  if (const auto U = U_of_difference(e, t); U && std::isfinite(*U))
    storage::put(json, "U_difference", *U, Quantity::deviation_per_length);
  json["says"] = qualified(e, t, say);
  return json;
}

Json part_of_json(const Together& t, const ModelWords& words) {
  const config::TerminalWords say = words.terminal();
  const model::JointExplanation& x = t.explanation;
  const Quantity q = t.deviation();
  Json json = {{"axis", t.axis}, {"part", t.part}};
  if (!t.side.empty()) json["side"] = t.side;
  if (const auto machines = each_once(t.machines); machines != std::vector<std::string>{""})
    json["machines"] = machines;
  std::size_t readings = 0;
  Json campaigns = Json::array();
  for (std::size_t m = 0; m < x.campaigns.size(); ++m) {
    const auto& one = x.campaigns[m];
    const std::size_t taken = t.parts[m].part.table.size();
    readings += taken;
    Json c = {{"campaign", t.campaigns[m]}, {"date", t.dates[m]}, {"observations", taken}};
    if (!t.adjustments[m].empty()) c["adjustment"] = t.adjustments[m];
    if (!t.machines[m].empty()) c["machine"] = t.machines[m];
    storage::put(c, "rms", one.rms, q);
    storage::put(c, "rms_after", one.rms_after, q);
    if (one.floor) storage::put(c, "noise_floor", one.floor->s, q);
    campaigns.push_back(std::move(c));
  }
  json["observations"] = readings;
  json["campaigns"] = std::move(campaigns);
  Json of_model = {{"effects", t.effects}};
  storage::put(of_model, "rms", x.rms, q);
  json["model"] = std::move(of_model);
  storage::put(json, "noise_floor", x.noise, q);
  storage::put(json, "rms_after", x.rms_after, q);
  put_priors(json, t.parts.front().priors, words);
  Json candidates = Json::array(), effects = Json::array();
  for (const model::JointEffect& e : x.candidates) {
    if (!(e.evidence > 0.0)) continue;
    Json one = effect_json(e, t, words);
    if (candidates.size() < most_best) one["best"] = true;
    candidates.push_back(std::move(one));
  }
  json["candidates"] = std::move(candidates);
  Json verdict = {{"kind", to_text(x.verdict)}};
  Json same = Json::array(), differs = Json::array();
  for (const model::JointEffect& e : x.effects) {
    effects.push_back(effect_json(e, t, words));
    (e.holds == Holds::shared ? same : differs).push_back(e.effect);
  }
  if (!x.effects.empty()) verdict["effect"] = x.effects.front().effect;
  verdict["same"] = std::move(same);
  verdict["differs"] = std::move(differs);
  verdict["explains_all"] = x.explains_all;
  verdict["p_left"] = x.p_left;
  if (x.single)
    verdict["single"] = {{"campaign", t.campaigns[x.single->campaign]},
                         {"effect", x.single->effect},
                         {"p", x.single->p}};
  verdict["says"] = sentence_of(t, say);
  json["effects"] = std::move(effects);
  json["plans"] = Json::array();
  for (const model::JointPlan& one : x.plans) {
    Json plan = plan_json(one.plan, words);
    plan["campaign"] = t.campaigns[one.campaign];
    json["plans"].push_back(std::move(plan));
  }
  json["verdict"] = std::move(verdict);
  return json;
}

/// The best further measurement for each pair of effects that is confused, the best of all first.
Json next_json(const FleetExplanation& all, const ModelWords& words) {
  struct Next {
    const model::Plan* plan;
    std::string campaign, part;
  };
  std::vector<Next> list;
  for (const Together& t : all.together)
    for (const model::JointPlan& one : t.explanation.plans)
      list.push_back({&one.plan, t.campaigns[one.campaign], t.part});
  for (const Alone& one : all.alone)
    for (const model::Plan& plan : one.explained.plans)
      list.push_back({&plan, one.campaign, one.part.part.name});
  std::stable_sort(list.begin(), list.end(),
                   [](const Next& a, const Next& b) { return is_better(*a.plan, *b.plan); });
  Json json = Json::array();
  std::set<std::array<std::string, 4>> pairs;
  for (const Next& one : list) {
    if (!pairs.insert({one.campaign, one.part, one.plan->one, one.plan->other}).second) continue;
    json.push_back(plan_json(*one.plan, words));
    json.back()["campaign"] = one.campaign;
    json.back()["part"] = one.part;
  }
  return json;
}

}  // namespace

Json together_json(const FleetExplanation& all, const ModelWords& words, std::uint64_t seed,
                   const std::vector<Error>& errors) {
  Json json = {{"schema", "nonio-explain/1"}};
  Json parts = Json::array();
  for (const Together& t : all.together) parts.push_back(part_of_json(t, words));
  if (!parts.empty()) json.update(parts[most_severe(all.together)]);
  if (parts.size() != 1) json["parts"] = std::move(parts);
  json["next"] = next_json(all, words);
  if (!all.alone.empty()) {
    Json alone = Json::array(), verdicts = Json::array();
    for (const Alone& one : all.alone) {
      alone.push_back(one.campaign + " " + one.part.part.name);
      const model::Verdict& verdict = one.explained.verdict;
      verdicts.push_back({{"part", alone.back()}, {"kind", to_text(verdict.kind)}});
      if (!verdict.effect.empty()) verdicts.back()["effect"] = verdict.effect;
      if (!one.explained.together.empty()) verdicts.back()["together"] = one.explained.together;
      verdicts.back()["says"] = words.verdict(one.explained, one.part);
    }
    json["alone"] = std::move(alone);
    json["alone_verdicts"] = std::move(verdicts);
  }
  if (!all.differing.empty()) json["parts_differ"] = all.differing;
  if (!all.left_out.empty()) json["left_out"] = all.left_out;
  json["seed"] = seed;
  Json list = Json::array();
  for (const Error& e : errors) list.push_back(storage::to_json(e));
  if (!list.empty()) json["errors"] = std::move(list);
  return json;
}

}  // namespace nonio::modelling
