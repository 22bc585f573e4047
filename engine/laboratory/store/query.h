// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "laboratory/store/identity.h"

namespace nonio::store {

/// Filter of a query; empty members match anything.
struct Query {
  std::string machine{}, axis{}, quantity{}, source{};
  std::string from{}, to{};  ///< days of the campaigns, both included
  bool superseded = false;   ///< whether to include evaluations that were superseded
};

/// One result in the history of a machine.
struct Point {
  std::string machine, axis, quantity, source, unit, day, state, purpose;
  std::string value;  ///< fewest digits that restore the double, as in all numeric members
  std::string u_repeat, u_common, expanded, k, tolerance, decision;
  std::string campaign, measurement, instrument, instrument_certificate, conditions;
  std::string evaluation, superseded_by;  ///< sequence numbers of the evaluation and of the one
                                          ///< that supersedes it; superseded_by is empty for the
                                          ///< last evaluation
};

/// Returns the matching results, sorted by machine, axis, quantity, source and day, as found before
/// as left. An error if there is no store, or if the store has no such machine, axis or quantity;
/// the error then suggests the nearest name.
Expected<std::vector<Point>> query(const std::filesystem::path& out, const Query& wanted);

/// Returns the name under which the campaigns of a machine are stored, given that name or an alias.
/// An error suggests the nearest name.
Expected<std::string> machine_named(const std::filesystem::path& out, const std::string& name);

/// Returns the machines of a store, with aliases joined, sorted by name.
Expected<std::vector<NamedMachine>> machines_in(const std::filesystem::path& out);

/// Returns names in a store that may denote one machine and that no alias joins.
Expected<std::vector<Spelling>> spellings_in(const std::filesystem::path& out);

}  // namespace nonio::store
