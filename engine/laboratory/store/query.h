// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "laboratory/store/identity.h"

namespace nonio::store {

/// What is required; empty: any.
struct Query {
  std::string machine{}, axis{}, quantity{}, source{};
  std::string from{}, to{};  ///< days of the campaigns, both included
  bool superseded = false;   ///< also what was replaced since
};

/// One number of a machine's history.
struct Point {
  std::string machine, axis, quantity, source, unit, day, state, purpose;
  std::string value;  ///< in the fewest digits that give the double back, as all numbers here
  std::string u_repeat, u_common, expanded, k, tolerance, decision;
  std::string campaign, measurement, instrument, instrument_certificate, conditions;
  std::string evaluation, superseded_by;  ///< sequence numbers; empty: it is the last
};

/// By machine, axis, quantity, source and day, as found before as left. An error if there is no
/// store, or nothing of that machine, axis or quantity in it: with the nearest name.
Expected<std::vector<Point>> query(const std::filesystem::path& out, const Query& wanted);

/// The name under which the campaigns of a machine are stored, from that name or an alias. An error
/// names the nearest.
Expected<std::string> machine_named(const std::filesystem::path& out, const std::string& name);

/// The machines of a store, with aliases joined, by name.
Expected<std::vector<NamedMachine>> machines_in(const std::filesystem::path& out);

/// Names in a store that may be one machine and that no alias joins.
Expected<std::vector<Spelling>> spellings_in(const std::filesystem::path& out);

}  // namespace nonio::store
