// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "laboratory/store/entry.h"

namespace nonio::store {

/// How a machine is called in the history: by its asset, else by maker and serial; empty where a
/// campaign states neither, and then it belongs to no machine.
std::string machine_of(const MachineAsStated& machine);

/// Two names that may be one machine. Nothing is joined until site.toml states that.
struct Spelling {
  std::string one, other;  ///< the name that more campaigns have comes first
  std::string why;         ///< in words: what they have in common
};

struct NamedMachine {
  std::string name;
  MachineAsStated stated;
  std::size_t campaigns = 0;
};

/// Names that differ in case, spaces, punctuation, O and 0, I, l and 1 only, and assets whose maker
/// and serial other campaigns state without an asset.
std::vector<Spelling> spellings(const std::vector<NamedMachine>& machines);

}  // namespace nonio::store
