// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/fleet_count.h"

#include <algorithm>
#include <cmath>

#include "campaign/reading/names.h"
#include "platform/storage/json_numbers.h"
#include "platform/storage/json_values.h"

namespace nonio::assessment {
using storage::Json;

namespace {

// Smallest root mean square of the parameters, in u: docs/dev/constants.md, M56.
constexpr double significant = 3.0;

struct Size {
  double value = 0.0;
  std::string unit{};
};

struct Parameters {
  double squares = 0.0, of_u = 0.0, count = 0.0;
  std::string unit;
};

std::string without_axis(const std::string& effect) { return effect.substr(0, effect.find(':')); }

// The pose and size of a part on the table are in every model of it: they are no candidates.
bool is_of_part(const std::string& effect) { return effect.starts_with("body-"); }

/// Significant effects of the fitted model; parameters are named "backlash:X.b".
void add_fitted(const Json& values, std::multimap<std::string, Size>& found) {
  std::map<std::string, Parameters> effects;
  for (const auto& [name, value] : values.items()) {
    const std::size_t dot = name.rfind('.');
    const double U = value.value("U", 0.0);
    if (name.find(':') == std::string::npos || dot == std::string::npos || !(U > 0.0) ||
        is_of_part(name))
      continue;
    Parameters& p = effects[name.substr(0, dot)];
    const double v = value.value("value", 0.0);
    p.squares += v * v, p.of_u += 4.0 * v * v / (U * U), ++p.count;
    p.unit = value.value("unit", "");
  }
  for (const auto& [effect, p] : effects)
    if (p.of_u > significant * significant * p.count)
      found.emplace(without_axis(effect), Size{std::sqrt(p.squares), p.unit});
}

/// The size of a missing effect is the RMS that it removes.
void add_missing(const Json& findings, std::multimap<std::string, Size>& found) {
  for (const Json& f : findings) {
    if (f.value("id", "") != "model.missing") continue;
    const Json& evidence = f.at("evidence");
    const auto rms = storage::get(evidence, "rms"), after = storage::get(evidence, "after");
    Size size;
    if (rms && after && rms->value > after->value)
      size = {
          printed(std::sqrt(rms->value * rms->value - after->value * after->value), rms->quantity),
          std::string(unit_of(rms->quantity).symbol)};
    found.emplace(without_axis(evidence.at("effect")), size);
  }
}

double quantile(const std::vector<double>& sorted, double share) {
  const double at = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (at - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

}  // namespace

Expected<void> FleetCount::add(std::string_view results) {
  try {
    const Json json = storage::parse(results);
    const Json& campaign = json.at("campaign");
    std::multimap<std::string, Size> found;
    bool searched = false;
    for (const Json& a : json.at("analyses")) {
      if (a.at("plugin") != reading::model_fit_name) continue;
      const Json findings = a.value("findings", Json::array());
      if (std::any_of(findings.begin(), findings.end(),
                      [](const Json& f) { return f.at("id") == "model.cannot-fit"; }))
        continue;
      searched = true;
      add_fitted(a.value("values", Json::object()), found);
      add_missing(findings, found);
    }
    if (!searched) return {};
    const std::string id = campaign.at("id"), date = campaign.value("date", "");
    const Json machine = campaign.value("machine", Json::object());
    std::vector<std::pair<std::string, std::string>> kinds{{"", ""}};
    if (const std::string model = machine.value("model", ""); !model.empty())
      kinds.emplace_back(machine.value("maker", ""), model);
    for (const auto& kind : kinds) {
      Machines& m = machines_[kind];
      m.campaigns.push_back(id);
      for (const auto& [effect, size] : found) {
        Effect& e = m.effects[effect];
        if (e.found.empty() || e.found.back() != id) e.found.push_back(id);
        if (!size.unit.empty()) e.sizes[size.unit].push_back(size.value);
      }
    }
    if (!date.empty() && (from_.empty() || date < from_)) from_ = date;
    until_ = std::max(until_, date);
  } catch (const Json::exception& e) {
    return fail(std::string("is not results.json: ") + e.what());
  }
  return {};
}

config::Fleet FleetCount::fleet(const std::string& today) const {
  config::Fleet out;
  out.counted = today, out.from = from_, out.until = until_;
  for (const auto& [kind, m] : machines_) {
    config::Fleet::Machines machines{kind.first, kind.second, m.campaigns, {}};
    std::sort(machines.campaigns.begin(), machines.campaigns.end());
    for (const auto& [name, e] : m.effects) {
      config::Fleet::Effect effect{name, e.found};
      std::sort(effect.found.begin(), effect.found.end());
      for (const auto& [unit, sizes] : e.sizes) {
        if (!effect.unit.empty() && sizes.size() <= e.sizes.at(effect.unit).size()) continue;
        std::vector<double> sorted = sizes;
        std::sort(sorted.begin(), sorted.end());
        effect.unit = unit, effect.median = quantile(sorted, 0.5);
        effect.spread = (quantile(sorted, 0.75) - quantile(sorted, 0.25)) / 2.0;
      }
      machines.effects.push_back(std::move(effect));
    }
    std::stable_sort(machines.effects.begin(), machines.effects.end(),
                     [](const auto& a, const auto& b) { return a.found.size() > b.found.size(); });
    out.machines.push_back(std::move(machines));
  }
  return out;
}

}  // namespace nonio::assessment
