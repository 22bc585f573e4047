// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "laboratory/store/entry.h"

namespace nonio::store {

/// Returns the name of a machine in the history: its asset, otherwise maker and serial. Empty if
/// the asset is missing and the maker or the serial too; the campaign then belongs to no machine.
std::string machine_of(const MachineAsStated& machine);

/// Two names that may denote one machine. They are joined only if site.toml states an alias.
struct Spelling {
  std::string one, other;  ///< names of two machines; `one` is the name that more campaigns state
  std::string why;         ///< why the names may denote one machine, in words
};

struct NamedMachine {
  std::string name;
  MachineAsStated stated;
  std::size_t campaigns = 0;
};

/// Finds names that differ only in case, spaces, punctuation, O and 0, or I, l and 1, and machines
/// of different names whose maker and serial are the same except for such differences.
std::vector<Spelling> spellings(const std::vector<NamedMachine>& machines);

}  // namespace nonio::store
