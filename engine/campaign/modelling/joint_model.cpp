// SPDX-License-Identifier: Apache-2.0
#include "campaign/modelling/joint_model.h"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <set>

#include "campaign/config/machines.h"
#include "campaign/modelling/held_terms.h"
#include "campaign/modelling/joined_parts.h"
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

/// Side of a gantry and adjustment of a measurement.
using Line = std::pair<std::string, std::string>;

Line line_of(const Campaign& campaign, const std::string& measurement) {
  for (const Measurement& m : campaign.measurements)
    if (m.id == measurement) return {m.side, m.adjustment};
  return {};
}

/// Without "@side" and similar if the measurements of the part do not differ by it.
std::vector<std::string> effects_of(const model::Part& part, std::vector<std::string> effects) {
  for (std::string& written : effects) {
    Entry entry = entry_of(written);
    const std::size_t at = entry.effect.find('@');
    if (at == std::string::npos ||
        std::any_of(part.groupings.begin(), part.groupings.end(),
                    [&](const auto& g) { return g->by == entry.effect.substr(at + 1); }))
      continue;
    entry.effect.resize(at);
    written = entry.text();
  }
  std::set<std::string> known;
  std::erase_if(effects, [&](const std::string& e) { return !known.insert(e).second; });
  return effects;
}

/// The readings of the axis on one side before or after an adjustment, with the model for these.
PartModel only(const PartModel& whole, const Line& line, const reading::ReadCampaign& read) {
  const Campaign& campaign = read.manifest->campaign;
  std::vector<Observations> readings = read.observations;
  for (std::size_t m = 0; m < readings.size(); ++m) {
    const std::string& id = campaign.measurements[m].id;
    const auto& all = whole.part.measurements;
    if (std::find(all.begin(), all.end(), id) != all.end() && line_of(campaign, id) != line)
      readings[m] = {};
  }
  PartModel out;
  for (model::Part& part : model::parts_of(campaign, readings))
    if (part.kind == whole.part.kind && part.name == whole.part.name) out.part = std::move(part);
  set_model(out, effects_of(out.part, campaign.model), read);
  fill_catalogue(out, read);
  return out;
}

/// An axis of a machine, or of machines of one model, on one side.
struct Key {
  std::string machine, axis, side;
  auto operator<=>(const Key&) const = default;
};

struct Measured {
  const reading::ReadCampaign* read;
  std::string adjustment;
  PartModel part;
};

std::string name_of(const Machine& m) { return !m.asset.empty() ? m.asset : m.serial; }

/// Campaigns of one machine have one key, and so do machines with the same maker and model.
class Kinds {
 public:
  const std::string& of(const Machine& m) {
    const std::string machine = config::machine_input(m);
    const std::string kind = m.model.empty() ? machine : m.maker + "\n" + m.model;
    if (machine.empty()) return unnamed_ = kind;
    return kinds_.try_emplace(machine, kind).first->second;
  }

 private:
  std::map<std::string, std::string> kinds_;
  std::string unnamed_;
};

using Axes = std::map<Key, std::vector<Measured>>;

void put_axis(Axes& out, const std::string& machine, const reading::ReadCampaign& read,
              const PartModel& part, FleetExplanation& all) {
  const Campaign& campaign = read.manifest->campaign;
  std::set<Line, std::greater<>> lines;  // "before" comes before "after"
  for (const std::string& id : part.part.measurements) lines.insert(line_of(campaign, id));
  const std::string axis = part.part.name, name = campaign.id + " " + axis;
  for (const Line& line : lines) {
    PartModel one = lines.size() > 1 ? only(part, line, read) : part;
    if (one.part.table.size() > most_readings)
      all.left_out.push_back(name + " (more than " + std::to_string(most_readings) + " readings)");
    else if (!one.unfit.empty())
      all.left_out.push_back(name + " (" + one.unfit + ")");
    else
      out[{machine, axis, line.first}].push_back({&read, line.second, std::move(one)});
  }
}

/// `trouble` receives the error of a campaign whose model has a mistake.
Axes common_parts(const std::vector<const reading::ReadCampaign*>& campaigns,
                  Expected<void>& trouble, FleetExplanation& all) {
  Axes out;
  Kinds kinds;
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
      if (part.part.kind == model::Part::Kind::axis)
        put_axis(out, kinds.of(campaign.machine), *read, part, all);
      else if (!part.unfit.empty())
        all.left_out.push_back(campaign.id + " " + part.part.name + " (" + part.unfit + ")");
      else if (part.part.kind != model::Part::Kind::course &&
               part.part.table.size() > most_readings)
        all.left_out.push_back(campaign.id + " " + part.part.name);
      else
        all.alone.push_back({campaign.id, std::move(part)});
    }
    if (!all.alone.empty() && all.alone.back().campaign == campaign.id)
      for (const Measurement& m : campaign.measurements)
        if (m.order == "as-listed") all.alone.back().ordered.push_back(m.id);
  }
  for (auto it = out.begin(); it != out.end();) {
    auto& list = it->second;
    if (list.front().read == list.back().read) {
      for (Measured& one : list)
        all.alone.push_back({one.read->manifest->campaign.id, std::move(one.part)});
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
  const int digits = text_of(x.rms, usual) == text_of(x.rms_after, usual) ? most : usual;
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
  std::string out = say(x.verdict == model::Verdict::Kind::missing   ? "joint.missing"
                        : x.verdict == model::Verdict::Kind::unknown ? "joint.unknown"
                                                                     : "joint.nothing",
                        parts);
  if (x.verdict == model::Verdict::Kind::missing && !x.explains_all)
    out += " " + say("joint.more", parts);
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

/// Whether the term is in the models of some campaigns only: it is searched like effects that no
/// model has, because otherwise the other campaigns would lack it.
bool in_some_only(const Together& t, const model::Term& term) {
  if (term.effect->is_nuisance || term.held || term.grouping) return false;
  return std::any_of(t.parts.begin(), t.parts.end(), [&](const PartModel& part) {
    return std::none_of(part.terms.begin(), part.terms.end(),
                        [&](const model::Term& own) { return own.of_all() == term.of_all(); });
  });
}

std::vector<model::Member> members_of(const Together& t) {
  std::vector<model::Member> members;
  for (std::size_t m = 0; m < t.parts.size(); ++m) {
    const PartModel& part = t.parts[m];
    model::Member& member = members.emplace_back(
        model::Member{t.campaigns[m], t.machines[m], &part.part, {}, part.catalogue});
    for (const model::Term& term : part.terms) {
      if (!in_some_only(t, term)) {
        member.model.push_back(term);
        continue;
      }
      if (std::any_of(member.catalogue.begin(), member.catalogue.end(),
                      [&](const model::Term& known) { return known.name() == term.name(); }))
        continue;
      member.catalogue.push_back(term);
      member.catalogue.back().shape.clear();
    }
  }
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

/// Keeps of the explanation what is shown of a part that is explained on its own.
void keep_explanation(Alone& one, model::Explanation explained) {
  one.explained = std::move(explained);
  model::Fit& fit = one.explained.comparison.fit;
  if (!of_parts(one.part.part.table)) return fit.part.clear();
  std::vector<model::Term> terms = fit.terms;
  const std::vector<std::string>& together = one.explained.together;
  for (const model::Candidate& c : one.explained.candidates)
    if (std::find(together.begin(), together.end(), c.term.name()) != together.end())
      terms.push_back(c.term);
  const auto found = model::fit(one.part.part.table, terms, fit.weight, fit.noise);
  one.residual = found ? found->residual : fit.residual;
  one.noise = found ? found->s : fit.s;
  fit.part.clear();
}

/// The parts that the machine made in one campaign, explained on their own.
std::vector<Alone> parts_of_one(const reading::ReadCampaign& read, std::uint64_t seed,
                                std::list<reading::ReadCampaign>& made) {
  reading::ReadCampaign& own = made.emplace_back(read);
  for (Observations& o : own.observations)
    if (!of_parts(o)) o = {};
  const Campaign& campaign = own.manifest->campaign;
  std::vector<Alone> out;
  auto parts = part_models(own, campaign.model);
  for (std::size_t p = 0; parts && p < parts->size(); ++p) {
    Alone one{campaign.id, std::move((*parts)[p])};
    for (const Measurement& m : campaign.measurements)
      if (m.order == "as-listed") one.ordered.push_back(m.id);
    auto explained = explain_part(one.part, seed);
    if (!explained) continue;
    keep_explanation(one, std::move(*explained));
    out.push_back(std::move(one));
  }
  return out;
}

/// Explains the parts of each campaign on their own where one model leaves more of all of them than
/// one model for each: the machine, the fixture or the measuring machine has changed between them.
void part_what_differs(FleetExplanation& all, const Joined& joined, std::uint64_t seed) {
  constexpr double differ_below = 0.001;  // docs/dev/constants.md, M72
  for (const auto& [id, campaigns] : joined) {
    const auto is = [&](const Alone& one) { return one.campaign == id; };
    const auto whole = std::find_if(all.alone.begin(), all.alone.end(), is);
    if (whole == all.alone.end()) continue;
    std::vector<Alone> each;
    double squares = 0.0, n = 0.0;
    for (const reading::ReadCampaign* read : campaigns)
      for (Alone& one : parts_of_one(*read, seed, all.made)) {
        const auto of = static_cast<double>(one.residual.size());
        squares += of * one.noise * one.noise, n += of;
        each.push_back(std::move(one));
      }
    const double ratio = whole->noise * whole->noise * n / squares;
    if (!(squares > 0.0) || n < static_cast<double>(whole->residual.size()) ||
        math::f_upper(ratio, n, n) > differ_below)
      continue;
    all.differing.push_back(id);
    std::erase_if(all.alone, is);
    std::move(each.begin(), each.end(), std::back_inserter(all.alone));
  }
}

}  // namespace

std::vector<std::string> each_once(const std::vector<std::string>& names) {
  std::vector<std::string> out;
  std::set<std::string> known;
  for (const std::string& name : names)
    if (known.insert(name).second) out.push_back(name);
  return out;
}

Expected<FleetExplanation> explain_together(
    const std::vector<const reading::ReadCampaign*>& campaigns, const config::Fleet& fleet,
    std::uint64_t seed) {
  std::vector<const reading::ReadCampaign*> ordered = campaigns;
  std::stable_sort(ordered.begin(), ordered.end(), [](const auto* a, const auto* b) {
    return a->manifest->campaign.date < b->manifest->campaign.date;
  });
  Expected<void> trouble;
  FleetExplanation out;
  Joined joined;
  ordered = join_parts(std::move(ordered), out.made, joined);
  auto parts = common_parts(ordered, trouble, out);
  if (!trouble) return fail(trouble.error());
  if (parts.empty() && out.alone.empty())
    return fail(
        "expected readings of axes, lines in space, circles, parts or displacements; found none");
  const bool one_kind =
      parts.empty() || parts.begin()->first.machine == std::prev(parts.end())->first.machine;
  for (auto& [key, list] : parts) {
    Together t;
    t.axis = key.axis, t.side = key.side;
    for (Measured& one : list) {
      const Campaign& campaign = one.read->manifest->campaign;
      t.campaigns.push_back(campaign.id), t.dates.push_back(campaign.date);
      t.adjustments.push_back(one.adjustment), t.machines.push_back(name_of(campaign.machine));
      t.u_scale.push_back(common_scale_uncertainty(one.part.part, campaign, key.axis));
      for (const std::string& effect : one.part.names())
        if (std::find(t.effects.begin(), t.effects.end(), effect) == t.effects.end())
          t.effects.push_back(effect);
      if (one.part.part.table.angular != list.front().part.part.table.angular)
        return fail("axis " + key.axis + ": " + t.campaigns.front() + " and " + t.campaigns.back() +
                    " give its deviation in different units (um and arcsec)");
      t.parts.push_back(std::move(one.part));
    }
    const config::Priors priors =
        config::priors_of(fleet, list.front().read->manifest->campaign.machine, t.campaigns);
    for (PartModel& part : t.parts) {
      use_priors(part, priors);
      for (const model::Term& term : part.terms)
        if (in_some_only(t, term)) std::erase(t.effects, term.name());
    }
    t.part = (one_kind ? "" : storage::listed(each_once(t.machines)) + " ") + key.axis +
             (key.side.empty() ? "" : " " + key.side);
    NONIO_TRY(t.explanation, model::explain_together(members_of(t), seed));
    const bool explained =
        t.explanation.verdict == model::Verdict::Kind::nothing ||
        (t.explanation.verdict == model::Verdict::Kind::missing && t.explanation.explains_all);
    if (!explained && add_named_causes(t, seed)) {
      NONIO_TRY(t.explanation, model::explain_together(members_of(t), seed));
    }
    out.together.push_back(std::move(t));
  }
  std::erase_if(out.alone, [&](Alone& one) {
    auto explained = explain_part(one.part, seed);
    if (explained)
      keep_explanation(one, std::move(*explained));
    else
      out.left_out.push_back(one.campaign + " " + one.part.part.name + " (" +
                             explained.error().message + ")");
    return !explained;
  });
  part_what_differs(out, joined, seed);
  return out;
}

namespace {

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
