// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/series.h"

namespace nonio::assessment {

MachineEvents::MachineEvents(const std::vector<store::MachineState>& all,
                             const store::StoredLogs& logs) {
  // Name of a machine by name or serial number; null if several machines have the serial number.
  std::map<std::string, const std::string*> named;
  for (const store::MachineState& m : all)
    for (const std::string& serial : m.serials) {
      const auto [at, is_new] = named.try_emplace(serial, &m.machine.name);
      if (!is_new) at->second = nullptr;
    }
  for (const store::MachineState& m : all) named[m.machine.name] = &m.machine.name;
  for (const config::Event& e : logs.events) {
    const auto alias = logs.aliases.find(e.machine);
    const auto machine = named.find(alias == logs.aliases.end() ? e.machine : alias->second);
    if (machine == named.end() || machine->second == nullptr)
      of_none_.push_back(e);
    else
      by_machine_[*machine->second].push_back(e);
  }
}

const std::vector<config::Event>& MachineEvents::of(const std::string& machine) const {
  static const std::vector<config::Event> none;
  const auto found = by_machine_.find(machine);
  return found == by_machine_.end() ? none : found->second;
}

}  // namespace nonio::assessment
