// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "laboratory/store/entry.h"

namespace nonio::store {

/// Returns the name of a machine in the history: its asset, otherwise maker and serial number.
/// Empty if neither is complete; the campaign then has no machine.
std::string machine_of(const MachineAsStated& machine);

/// Names that may denote one machine. Only an alias in site.toml joins them.
struct Spelling {
  std::string one, other;  ///< `one` is the name that more campaigns state
  std::string why;
  /// Returns the key of `why` in the table term.alike of the words.
  const char* key() const { return why == "spelled alike" ? "alike" : "numbered"; }
};

struct NamedMachine {
  std::string name;
  MachineAsStated stated;
  std::size_t campaigns = 0;
};

/// Finds names that differ only in case, spaces, punctuation, O and 0, or I, l and 1, and machines
/// whose maker and serial number differ only in this way.
std::vector<Spelling> spellings(const std::vector<NamedMachine>& machines);

}  // namespace nonio::store
