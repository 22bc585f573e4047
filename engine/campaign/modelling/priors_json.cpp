// SPDX-License-Identifier: Apache-2.0
#include "campaign/modelling/priors_json.h"

#include "nonio/sdk/format.h"

namespace nonio::modelling {

using storage::Json;

void put_priors(Json& part, const config::Priors& priors, const ModelWords& words) {
  if (priors.campaigns == 0) return;
  const config::TerminalWords say = words.terminal();
  Json json = {{"file", config::fleet_name},
               {"campaigns", priors.campaigns},
               {"counted", priors.counted},
               {"from", priors.from},
               {"until", priors.until}};
  if (!priors.machines.empty()) json["machines"] = priors.machines;
  json["says"] = say(priors.machines.empty() ? "priors.all" : "priors.of-model",
                     {{"machines", priors.machines},
                      {"count", std::to_string(priors.campaigns)},
                      {"from", priors.from},
                      {"until", priors.until}});
  part["priors"] = std::move(json);
}

void put_prior(Json& candidate, const std::string& effect, double weight,
               const config::Priors& priors, const ModelWords& words) {
  if (priors.campaigns == 0) return;
  const config::TerminalWords say = words.terminal();
  const config::Priors::Of of = priors.of(effect.substr(0, effect.find(':')));
  Json json = {{"found", of.found}, {"weight", printed(weight, Quantity::ratio)}};
  config::TerminalWords::Parts parts{{"effect", effect},
                                     {"found", std::to_string(of.found)},
                                     {"count", std::to_string(priors.campaigns)},
                                     {"weight", say.number(short_text(weight))}};
  if (!of.unit.empty()) {
    json.update({{"median", of.median}, {"spread", of.spread}, {"unit", of.unit}});
    for (const auto& [name, value] : {std::pair{"median", of.median}, {"spread", of.spread}})
      parts.emplace_back(name, say.number(short_text(value)) + " " + of.unit);
  }
  json["says"] = say(of.unit.empty() ? "prior" : "prior.sized", parts);
  candidate["prior"] = std::move(json);
}

}  // namespace nonio::modelling
