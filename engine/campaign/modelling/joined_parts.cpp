// SPDX-License-Identifier: Apache-2.0
#include "campaign/modelling/joined_parts.h"

#include <algorithm>

#include "campaign/config/machines.h"

namespace nonio::modelling {

bool of_parts(const Observations& o) {
  return std::any_of(o.lines.begin(), o.lines.end(), [](const auto& l) { return !l.body.empty(); });
}

namespace {

/// One campaign with the parts that a machine made, of all its campaigns: each has a placement and a
/// temperature of its own, so they are explained like several parts of one campaign.
reading::ReadCampaign with_all_parts(const std::vector<const reading::ReadCampaign*>& campaigns) {
  reading::ReadCampaign out = *campaigns.back();
  Campaign& to = out.manifest->campaign;
  to.measurements.clear(), out.observations.clear();
  for (const reading::ReadCampaign* read : campaigns) {
    const Campaign& from = read->manifest->campaign;
    for (std::size_t m = 0; m < read->observations.size(); ++m) {
      if (!of_parts(read->observations[m])) continue;
      to.measurements.push_back(from.measurements[m]);
      // What follows a space is a state of the machine.
      to.measurements.back().id = from.id + "/" + from.measurements[m].id;
      Observations& o = out.observations.emplace_back(read->observations[m]);
      o.measurement = to.measurements.back().id;
      for (auto& line : o.lines)
        line.name = from.id + "/" + line.name, line.body = from.id + "/" + line.body;
    }
  }
  to.id =
      campaigns.front()->manifest->campaign.id + (campaigns.size() > 2 ? " ... " : ", ") + to.id;
  return out;
}

std::size_t coordinates_in(const std::vector<const reading::ReadCampaign*>& campaigns) {
  std::size_t n = 0;
  for (const reading::ReadCampaign* read : campaigns)
    for (const Observations& o : read->observations) n += of_parts(o) ? o.size() : 0;
  return n;
}

}  // namespace

std::vector<const reading::ReadCampaign*> join_parts(
    std::vector<const reading::ReadCampaign*> campaigns, std::list<reading::ReadCampaign>& made,
    Joined& joined) {
  std::map<std::string, std::vector<const reading::ReadCampaign*>> by_machine;
  for (const reading::ReadCampaign* read : campaigns)
    if (const std::string machine = config::machine_input(read->manifest->campaign.machine);
        !machine.empty() &&
        std::any_of(read->observations.begin(), read->observations.end(), of_parts))
      by_machine[machine].push_back(read);
  for (const auto& [machine, list] : by_machine) {
    if (list.size() < 2 || coordinates_in(list) > most_readings) continue;
    for (const reading::ReadCampaign*& read : campaigns) {
      if (std::find(list.begin(), list.end(), read) == list.end()) continue;
      reading::ReadCampaign& rest = made.emplace_back(*read);
      for (Observations& o : rest.observations)
        if (of_parts(o)) o = {};
      read = &rest;
    }
    campaigns.push_back(&made.emplace_back(with_all_parts(list)));
    joined[campaigns.back()->manifest->campaign.id] = list;
  }
  return campaigns;
}

}  // namespace nonio::modelling
