// SPDX-License-Identifier: Apache-2.0
#include "campaign/modelling/joint_model.h"

#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include "campaign/config/machines.h"
#include "campaign/modelling/held_terms.h"
#include "campaign/modelling/joined_parts.h"
#include "nonio/math/distributions.h"

namespace nonio::modelling {

namespace {

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

/// Adds causes that more than half of `asked` campaigns, evenly chosen, show alone, or with `any` one
/// of them: otherwise other effects would be named in their place. Returns false without such a
/// cause.
bool add_named_causes(Together& t, std::size_t asked, bool any, std::uint64_t seed) {
  std::map<std::string, std::size_t> shown;
  asked = std::min(asked, t.parts.size());
  for (std::size_t m = 0; m < asked; ++m) {
    const auto alone = explain_part(t.parts[m * t.parts.size() / asked], seed);
    if (!alone || alone->verdict.kind != model::Verdict::Kind::missing) continue;
    const auto& set = alone->together;
    for (const model::Candidate& c : alone->candidates)
      if (c.term.library &&
          (c.term.name() == alone->verdict.effect ||
           (!any && std::find(set.begin(), set.end(), c.term.name()) != set.end())))
        ++shown[c.term.of_all()];
  }
  std::set<std::string> named;
  for (const auto& [name, count] : shown)
    if (any || 2 * count > asked) named.insert(name);
  for (const PartModel& part : t.parts)
    for (const model::Term& known : part.catalogue)
      if (!known.library) named.erase(known.of_all());
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
  for (const auto& [name, campaigns] : joined) {
    const std::string& id = name;
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
    constexpr std::size_t few = 8;  // docs/dev/constants.md, M73
    add_named_causes(t, few, false, seed);
    NONIO_TRY(t.explanation, model::explain_together(members_of(t), seed));
    const bool explained =
        t.explanation.verdict == model::Verdict::Kind::nothing ||
        (t.explanation.verdict == model::Verdict::Kind::missing && t.explanation.explains_all);
    if (!explained && add_named_causes(t, t.parts.size(), true, seed)) {
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

}  // namespace nonio::modelling
