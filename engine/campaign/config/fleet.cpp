// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/fleet.h"

#include <algorithm>

#include "campaign/config/toml_reader.h"
#include "nonio/sdk/format.h"
#include "platform/storage/files.h"

namespace nonio::config {
namespace fs = std::filesystem;

namespace {

// docs/dev/constants.md, M56.
constexpr std::size_t fewest_of_model = 10;
constexpr double campaigns_assumed = 10.0, finds_assumed = 1.0;

std::string list_of(const std::vector<std::string>& ids) {
  std::string out;
  for (const std::string& id : ids) out += (out.empty() ? "" : ", ") + quoted_toml(id);
  return "[" + out + "]";
}

std::size_t count_without(const std::vector<std::string>& ids,
                          const std::vector<std::string>& without) {
  return static_cast<std::size_t>(std::count_if(ids.begin(), ids.end(), [&](const auto& id) {
    return std::find(without.begin(), without.end(), id) == without.end();
  }));
}

}  // namespace

Checked<Fleet> parse_fleet(std::string_view text, const std::string& file) {
  auto root = parse_toml(text, file);
  if (!root) return tl::unexpected(std::vector<Error>{root.error()});
  std::vector<Error> errors;
  Fleet fleet;
  TableReader top(*root, fleet_file(), file, errors);
  top.fill(fleet);
  top.finish();
  if (!errors.empty()) return tl::unexpected(std::move(errors));
  return fleet;
}

std::string text_of(const Fleet& fleet) {
  std::string out =
      "# How often each effect was found, counted by `nonio export --format fleet`.\n"
      "# `nonio model explain` weighs its candidates by it ([explain] priors in site.toml).\n"
      "format = 1\n";
  out += "counted = " + fleet.counted + "\n";
  for (const auto& [key, day] : {std::pair{"from", &fleet.from}, {"until", &fleet.until}})
    if (!day->empty()) out += std::string(key) + " = " + *day + "\n";
  for (const Fleet::Machines& m : fleet.machines) {
    out += "\n[[machines]]\n";
    for (const auto& [key, value] : {std::pair{"maker", &m.maker}, {"model", &m.model}})
      if (!value->empty()) out += std::string(key) + " = " + quoted_toml(*value) + "\n";
    out += "campaigns = " + list_of(m.campaigns) + "\n";
    for (const Fleet::Effect& e : m.effects) {
      out += "\n[[machines.effect]]\nname = " + quoted_toml(e.name) +
             "\nfound = " + list_of(e.found) + "\n";
      if (!e.unit.empty())
        out += "median = " + short_text(e.median) + "\nspread = " + short_text(e.spread) +
               "\nunit = " + quoted_toml(e.unit) + "\n";
    }
  }
  return out;
}

Checked<Fleet> read_fleet(const fs::path& site, const SiteFile& settings) {
  if (!settings.priors) return Fleet{};
  const auto failed = [](Error error) {
    return tl::unexpected(std::vector<Error>{std::move(error)});
  };
  const auto there = storage::is_there(site / fleet_name);
  if (!there) return failed(there.error());
  if (!*there) return Fleet{};
  const auto text = storage::read_file(site / fleet_name);
  if (!text) return failed(Error{text.error().message, fleet_name});
  return parse_fleet(*text, fleet_name);
}

Priors::Of Priors::of(const std::string& effect) const {
  const auto found = effects.find(effect);
  return found == effects.end() ? Of{} : found->second;
}

double Priors::frequency(const std::string& effect) const {
  return (static_cast<double>(of(effect).found) + finds_assumed) /
         (static_cast<double>(campaigns) + campaigns_assumed);
}

Priors priors_of(const Fleet& fleet, const Machine& machine,
                 const std::vector<std::string>& without) {
  Priors out;
  out.counted = fleet.counted, out.from = fleet.from, out.until = fleet.until;
  const Fleet::Machines* chosen = nullptr;
  for (const Fleet::Machines& m : fleet.machines) {
    const bool all = m.maker.empty() && m.model.empty();
    if (all ? chosen == nullptr
            : m.maker == machine.maker && m.model == machine.model &&
                  count_without(m.campaigns, without) >= fewest_of_model)
      chosen = &m;
  }
  if (chosen == nullptr) return out;
  out.machines = chosen->maker + (chosen->maker.empty() ? "" : " ") + chosen->model;
  out.campaigns = count_without(chosen->campaigns, without);
  for (const Fleet::Effect& e : chosen->effects)
    out.effects[e.name] = {count_without(e.found, without), e.median, e.spread, e.unit};
  return out;
}

}  // namespace nonio::config
