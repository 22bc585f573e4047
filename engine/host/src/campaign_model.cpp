// SPDX-License-Identifier: Apache-2.0
#include "nonio/host/campaign_model.h"

#include <algorithm>
#include <cmath>

#include "guarded.h"
#include "nonio/host/nearest.h"

namespace nonio::host {

namespace {

std::pair<std::string, std::string> split(const std::string& effect) {
  const std::size_t colon = effect.find(':');
  if (colon == std::string::npos) return {effect, ""};
  return {effect.substr(0, colon), effect.substr(colon + 1)};
}

std::vector<std::string> known_names(const ReadCampaign& read) {
  std::vector<std::string> names;
  for (const Axis& axis : read.manifest->campaign.machine.axes)
    for (const Effect& effect : read.effects) names.push_back(effect.info.name + ":" + axis.name);
  return names;
}

std::string mistake_of(const std::string& effect, const ReadCampaign& read) {
  const auto [kind, axis] = split(effect);
  const auto is_kind = [&, &k = kind](const Effect& e) { return e.info.name == k; };
  const bool known = std::any_of(read.effects.begin(), read.effects.end(), is_kind);
  const std::string nearest = suggestion(effect, known_names(read));
  if (kind.empty() || axis.empty())
    return "wanted kind:axis, such as backlash:X; found \"" + effect + "\"" + nearest;
  if (!known) return "there is no effect \"" + kind + "\"" + nearest;
  if (read.manifest->campaign.machine.axis(axis) == nullptr)
    return "\"" + effect + "\": the machine has no axis \"" + axis + "\"" + nearest;
  return {};
}

}  // namespace

std::vector<std::string> PartModel::names() const {
  std::vector<std::string> out;
  for (const model::Term& t : terms) out.push_back(t.name());
  return out;
}

ReadingPlace place_of(const PartModel& part, const Campaign& campaign, std::size_t row) {
  const Observations& o = part.part.table;
  ReadingPlace place;
  place.measurement = o.lines[o.line[row]].name;
  for (const Measurement& m : campaign.measurements)
    if (m.id == place.measurement) place.file = m.file;
  if (row < o.source_line.size()) place.line = o.source_line[row];
  if (row < o.run.size()) place.run = o.run[row];
  place.direction = o.axes.front().approach[row] > 0 ? 1 : -1;
  place.target = o.axes.front().position[row];
  return place;
}

std::vector<std::string> model_mistakes(const std::vector<std::string>& effects,
                                        const ReadCampaign& read) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    const auto first = std::find(effects.begin(), effects.end(), effects[i]);
    if (static_cast<std::size_t>(first - effects.begin()) != i)
      out.push_back("\"" + effects[i] + "\" is there twice");
    else if (std::string mistake = mistake_of(effects[i], read); !mistake.empty())
      out.push_back(std::move(mistake));
  }
  return out;
}

Expected<std::vector<PartModel>> part_models(const ReadCampaign& read,
                                             const std::vector<std::string>& effects) {
  const Campaign& campaign = read.manifest->campaign;
  const auto at_effects = [&](const std::string& message) {
    const auto line = read.manifest->lines.find("model.effects");
    return fail(Error{"model.effects: " + message, manifest_name,
                      line == read.manifest->lines.end() ? 0 : line->second});
  };
  if (const auto mistakes = model_mistakes(effects, read); !mistakes.empty())
    return at_effects(mistakes.front());
  std::vector<PartModel> parts;
  for (model::Part& part : model::parts_of(campaign, read.observations)) {
    auto terms = model::terms_of(part, campaign.machine, effects, read.effects);
    auto catalogue = model::catalogue(part, read.effects);
    PartModel one{std::move(part), {}, std::move(catalogue), {}};
    if (terms)
      one.terms = std::move(*terms);
    else
      one.unfit = terms.error().message;
    parts.push_back(std::move(one));
  }
  return parts;
}

std::vector<std::string> unmeasured(const std::vector<std::string>& effects,
                                    const std::vector<PartModel>& parts) {
  std::vector<std::string> out;
  for (const std::string& effect : effects)
    if (std::none_of(parts.begin(), parts.end(),
                     [&](const PartModel& p) { return p.axis().name == split(effect).second; }))
      out.push_back(effect);
  return out;
}

std::vector<std::string> below_uncertainty(const model::Fit& fit) {
  std::vector<std::string> out;
  for (const model::Term& term : fit.terms) {
    bool any = false, small = true;
    for (const model::Parameter& p : fit.parameters) {
      if (p.effect != term.name() || p.shape) continue;
      any = true;
      small = small && !(std::fabs(p.value) >= 2.0 * p.u);
    }
    if (any && small) out.push_back(term.name());
  }
  return out;
}

Expected<model::Comparison> compare_part(const PartModel& part) {
  if (!part.unfit.empty()) return fail(part.unfit);
  return guarded("axis " + part.axis().name, [&] { return model::compare(part.part, part.terms); });
}

Expected<model::Explanation> explain_part(const PartModel& part, std::uint64_t seed) {
  if (!part.unfit.empty()) return fail(part.unfit);
  return guarded("axis " + part.axis().name,
                 [&] { return model::explain(part.part, part.terms, part.catalogue, seed); });
}

}  // namespace nonio::host
