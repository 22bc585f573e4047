// SPDX-License-Identifier: Apache-2.0
#include "campaign/modelling/joint_model.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "campaign/modelling/model_json.h"
#include "nonio/math/distributions.h"
#include "nonio/sdk/format.h"

namespace nonio::modelling {

namespace {

using model::Holds;
using storage::Json;

// Limits the memory for the columns of all effects.
constexpr std::size_t most_readings = 20000;

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

/// `trouble` receives the error of a campaign whose model has a mistake.
std::map<std::string, std::vector<std::pair<const reading::ReadCampaign*, PartModel>>> common_parts(
    const std::vector<const reading::ReadCampaign*>& campaigns, Expected<void>& trouble,
    std::vector<std::string>& left_out) {
  std::map<std::string, std::vector<std::pair<const reading::ReadCampaign*, PartModel>>> out;
  for (const reading::ReadCampaign* read : campaigns) {
    const Campaign& campaign = read->manifest->campaign;
    auto parts = part_models(*read, campaign.model);
    if (!parts) {
      Error error = parts.error();
      error.message = campaign.id + ": " + error.message;
      trouble = fail(std::move(error));
      return {};
    }
    for (PartModel& part : *parts) {
      if (part.part.kind != model::Part::Kind::axis)
        left_out.push_back(campaign.id + " " + part.part.name);
      else if (part.part.table.size() > most_readings)
        left_out.push_back(campaign.id + " " + part.part.name + " (more than " +
                           std::to_string(most_readings) + " readings)");
      else if (!part.unfit.empty())
        left_out.push_back(campaign.id + " " + part.part.name + " (" + part.unfit + ")");
      else
        out[part.part.name].emplace_back(read, std::move(part));
    }
  }
  for (auto it = out.begin(); it != out.end();) {
    if (it->second.size() < 2) {
      left_out.push_back(it->second.front().first->manifest->campaign.id + " " + it->first);
      it = out.erase(it);
    } else {
      ++it;
    }
  }
  return out;
}

/// Whether the effect has more than 3 linear parameters in a group; then only its RMS is printed.
bool is_curve(const std::vector<model::Parameter>& group) {
  return std::count_if(group.begin(), group.end(), [](const auto& p) { return !p.shape; }) > 3;
}

std::string value_text(const std::vector<model::Parameter>& group, double size, Quantity deviation,
                       const config::TerminalWords& say) {
  std::string out;
  if (is_curve(group))
    return "RMS " + say.number(short_text(printed(size, deviation))) + " " +
           std::string(unit_of(deviation).symbol);
  for (const model::Parameter& p : group) {
    if (p.shape) continue;
    const std::string unit(unit_of(p.quantity).symbol);
    out += (out.empty() ? "" : "; ") + (group.size() > 1 ? p.name + " " : std::string()) +
           say.number(short_text(printed(p.value, p.quantity))) + (unit.empty() ? "" : " " + unit) +
           ", U = " + say.number(short_text(2.0 * printed(p.u, p.quantity), 2));
  }
  return out;
}

std::string place_text(const Together& t, std::size_t campaign) {
  return t.campaigns[campaign] + (t.dates[campaign].empty() ? "" : " (" + t.dates[campaign] + ")");
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
    if (e.groups[g].empty()) continue;
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
    return say("joint.shared",
               {{"effect", e.effect}, {"value", value_text(e.groups.front(), e.size, q, say)}});
  if (e.holds == Holds::changed) {
    if (is_curve(e.groups[0]))
      return say("joint.changed-curve", {{"effect", e.effect},
                                         {"last", place_text(t, e.after - 1)},
                                         {"first", place_text(t, e.after)},
                                         {"value", value_text(e.groups[0], e.size, q, say)}});
    const char* id = is_absent(e.groups[0])   ? "joint.appears"
                     : is_absent(e.groups[1]) ? "joint.vanishes"
                                              : "joint.changed";
    return say(id, {{"effect", e.effect},
                    {"last", place_text(t, e.after - 1)},
                    {"first", place_text(t, e.after)},
                    {"before", value_text(e.groups[0], e.size, q, say)},
                    {"after", value_text(e.groups[1], e.size, q, say)}});
  }
  const auto [low, high] = extremes(e);
  if (is_curve(e.groups[low]))
    return say("joint.own-curve",
               {{"effect", e.effect}, {"value", value_text(e.groups[low], e.size, q, say)}});
  return say("joint.own", {{"effect", e.effect},
                           {"low", value_text(e.groups[low], e.size, q, say)},
                           {"of-low", place_text(t, low)},
                           {"high", value_text(e.groups[high], e.size, q, say)},
                           {"of-high", place_text(t, high)}});
}

std::string sentence_of(const Together& t, const config::TerminalWords& say) {
  const model::JointExplanation& x = t.explanation;
  const Quantity q = t.deviation();
  constexpr int usual = 3, most = 5;
  const auto text_of = [&](double v, int digits) { return short_text(printed(v, q), digits); };
  const int digits = text_of(x.rms, usual) == text_of(x.rms_after, usual) ? most : usual;
  const auto text = [&](double v) {
    return say.number(text_of(v, digits)) + " " + std::string(unit_of(q).symbol);
  };
  std::vector<std::string> names;
  for (const model::JointEffect& e : x.effects) names.push_back(e.effect);
  const config::TerminalWords::Parts parts{{"part", t.part},
                                           {"count", std::to_string(t.campaigns.size())},
                                           {"effects", storage::listed(names)},
                                           {"before", text(x.rms)},
                                           {"after", text(x.rms_after)},
                                           {"floor", text(x.noise)}};
  std::string out = say(x.verdict == model::Verdict::Kind::missing   ? "joint.missing"
                        : x.verdict == model::Verdict::Kind::unknown ? "joint.unknown"
                                                                     : "joint.nothing",
                        parts);
  if (x.verdict == model::Verdict::Kind::missing && !x.explains_all)
    out += " " + say("joint.more", parts);
  return out;
}

Json effect_json(const model::JointEffect& e, const Together& t, const config::TerminalWords& say) {
  const Quantity q = t.deviation();
  Json json = {{"effect", e.effect}, {"per_campaign", name_of(e.holds)}};
  storage::put(json, "rms", e.rms, q);
  storage::put(json, "size", e.size, q);
  json["score"] = e.evidence;
  json["p"] = e.p;
  if (e.holds == Holds::shared) {
    json["parameters"] = parameters_json(e.groups.front());
  } else {
    Json values = Json::array();
    for (std::size_t g = 0; g < e.groups.size(); ++g) {
      Json one = Json::object();
      if (e.holds == Holds::own)
        one["campaign"] = t.campaigns[g];
      else
        one[g == 0 ? "to" : "from"] = t.campaigns[e.after - (g == 0 ? 1 : 0)];
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
  json["says"] = sentence_of(e, t, say);
  return json;
}

Json part_of_json(const Together& t, const ModelWords& words) {
  const config::TerminalWords say = words.terminal();
  const model::JointExplanation& x = t.explanation;
  const Quantity q = t.deviation();
  Json json = {{"axis", t.part}};
  std::size_t readings = 0;
  Json campaigns = Json::array();
  for (std::size_t m = 0; m < x.campaigns.size(); ++m) {
    const auto& one = x.campaigns[m];
    const std::size_t taken = t.parts[m].part.table.size();
    readings += taken;
    Json c = {{"campaign", t.campaigns[m]}, {"date", t.dates[m]}, {"observations", taken}};
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
  Json candidates = Json::array(), effects = Json::array();
  for (const model::JointEffect& e : x.candidates) {
    if (!(e.evidence > 0.0)) continue;
    Json one = effect_json(e, t, say);
    if (candidates.size() < most_best) one["best"] = true;
    candidates.push_back(std::move(one));
  }
  json["candidates"] = std::move(candidates);
  Json verdict = {{"kind", to_text(x.verdict)}};
  Json same = Json::array(), differs = Json::array();
  for (const model::JointEffect& e : x.effects) {
    effects.push_back(effect_json(e, t, say));
    (e.holds == Holds::shared ? same : differs).push_back(e.effect);
  }
  if (!x.effects.empty()) verdict["effect"] = x.effects.front().effect;
  verdict["same"] = std::move(same);
  verdict["differs"] = std::move(differs);
  verdict["explains_all"] = x.explains_all;
  verdict["p_left"] = x.p_left;
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

std::vector<model::Member> members_of(const Together& t) {
  std::vector<model::Member> members;
  for (std::size_t m = 0; m < t.parts.size(); ++m)
    members.push_back({t.campaigns[m], &t.parts[m].part, t.parts[m].terms, t.parts[m].catalogue});
  return members;
}

/// Adds causes that one campaign shows, because otherwise another effect would be named in their
/// place. Returns false without such a cause.
bool add_named_causes(Together& t, std::uint64_t seed) {
  std::set<std::string> named;
  for (const PartModel& part : t.parts)
    if (const auto alone = explain_part(part, seed);
        alone && alone->verdict.kind == model::Verdict::Kind::missing &&
        alone->candidates.front().term.library)
      named.insert(alone->verdict.effect);
  if (named.empty()) return false;
  for (PartModel& part : t.parts)
    for (model::Term& term : library_of(part, t.keeps.emplace_back()))
      if (named.contains(term.name())) {
        term.library = false;
        part.catalogue.push_back(std::move(term));
      }
  return true;
}

}  // namespace

Expected<std::vector<Together>> explain_together(
    const std::vector<const reading::ReadCampaign*>& campaigns, std::uint64_t seed,
    std::vector<std::string>& left_out) {
  std::vector<const reading::ReadCampaign*> ordered = campaigns;
  std::stable_sort(ordered.begin(), ordered.end(), [](const auto* a, const auto* b) {
    return a->manifest->campaign.date < b->manifest->campaign.date;
  });
  Expected<void> trouble;
  auto parts = common_parts(ordered, trouble, left_out);
  if (!trouble) return fail(trouble.error());
  if (parts.empty())
    return fail("expected an axis that two campaigns or more measured with runs; found none");
  std::vector<Together> out;
  for (auto& [name, list] : parts) {
    Together t{name, {}, {}, {}, {}, {}};
    for (auto& [read, part] : list) {
      t.campaigns.push_back(read->manifest->campaign.id);
      t.dates.push_back(read->manifest->campaign.date);
      for (const std::string& effect : part.names())
        if (std::find(t.effects.begin(), t.effects.end(), effect) == t.effects.end())
          t.effects.push_back(effect);
      if (part.part.table.angular != list.front().second.part.table.angular)
        return fail("axis " + name + ": " + t.campaigns.front() + " and " + t.campaigns.back() +
                    " give its deviation in different units (um and arcsec)");
      t.parts.push_back(std::move(part));
    }
    NONIO_TRY(t.explanation, model::explain_together(members_of(t), seed));
    const bool explained =
        t.explanation.verdict == model::Verdict::Kind::nothing ||
        (t.explanation.verdict == model::Verdict::Kind::missing && t.explanation.explains_all);
    if (!explained && add_named_causes(t, seed)) {
      NONIO_TRY(t.explanation, model::explain_together(members_of(t), seed));
    }
    out.push_back(std::move(t));
  }
  return out;
}

Json together_json(const std::vector<Together>& all, const ModelWords& words, std::uint64_t seed,
                   const std::vector<std::string>& left_out, const std::vector<Error>& errors) {
  Json json = {{"schema", "nonio-explain/1"}};
  Json parts = Json::array();
  for (const Together& t : all) parts.push_back(part_of_json(t, words));
  if (!all.empty()) json.update(parts[most_severe(all)]);
  if (all.size() > 1) json["parts"] = std::move(parts);
  if (!left_out.empty()) json["left_out"] = left_out;
  json["seed"] = seed;
  Json list = Json::array();
  for (const Error& e : errors) list.push_back(storage::to_json(e));
  if (!list.empty()) json["errors"] = std::move(list);
  return json;
}

}  // namespace nonio::modelling
