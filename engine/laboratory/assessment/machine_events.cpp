// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/series.h"

namespace nonio::assessment {

MachineNames::MachineNames(const std::vector<store::MachineState>& all,
                           const store::StoredLogs& logs)
    : logs_(logs) {
  for (const store::MachineState& m : all)
    for (const std::string& serial : m.serials) {
      const auto [at, is_new] = named_.try_emplace(serial, &m.machine.name);
      if (!is_new) at->second = nullptr;
    }
  for (const store::MachineState& m : all) named_[m.machine.name] = &m.machine.name;
}

const std::string* MachineNames::of(const std::string& stated) const {
  const auto alias = logs_.aliases.find(stated);
  const auto found = named_.find(alias == logs_.aliases.end() ? stated : alias->second);
  return found == named_.end() ? nullptr : found->second;
}

MachineEvents::MachineEvents(const std::vector<store::MachineState>& all,
                             const store::StoredLogs& logs) {
  const MachineNames names(all, logs);
  for (const config::Event& e : logs.events)
    if (const std::string* machine = names.of(e.machine))
      by_machine_[*machine].push_back(e);
    else
      of_none_.push_back(e);
}

const std::vector<config::Event>& MachineEvents::of(const std::string& machine) const {
  static const std::vector<config::Event> none;
  const auto found = by_machine_.find(machine);
  return found == by_machine_.end() ? none : found->second;
}

}  // namespace nonio::assessment
