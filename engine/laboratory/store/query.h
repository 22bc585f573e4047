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
  std::string from{}, to{};  ///< closed interval of the dates of campaigns
  bool superseded = false;   ///< whether to include superseded evaluations
};

/// A result in the history of a machine.
struct Point {
  std::string machine, axis, quantity, source, unit, day, state, purpose;
  std::string value;  ///< shortest text that restores the double, as in all numeric members
  std::string u_repeat, u_common, expanded, k, tolerance, decision;
  std::string campaign, measurement, instrument, instrument_certificate, conditions;
  /// Numbers of the evaluation and of the evaluation that supersedes it, if any.
  std::string evaluation, superseded_by;
};

/// Returns the matching results, sorted by machine, axis, quantity, source, date and state. An
/// error if there is no store, or if the machine, axis or quantity is unknown; the message suggests
/// the nearest name.
Expected<std::vector<Point>> query(const std::filesystem::path& out, const Query& wanted);

/// Returns the name of a machine in the history, given this name or an alias. An error suggests the
/// nearest name.
Expected<std::string> machine_named(const std::filesystem::path& out, const std::string& name);

/// Sorted by name. A machine and its aliases are one entry.
Expected<std::vector<NamedMachine>> machines_in(const std::filesystem::path& out);

/// Returns names that may denote one machine and that no alias joins.
Expected<std::vector<Spelling>> spellings_in(const std::filesystem::path& out);

}  // namespace nonio::store
