// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "laboratory/assessment/changes.h"
#include "laboratory/assessment/last_run.h"
#include "laboratory/assessment/standing.h"
#include "laboratory/store/reader.h"
#include "nonio/reports/site.h"

namespace nonio::assessment {

/// All that lines are made from.
struct Known {
  const LastRun& last_run;
  const std::vector<const Standing*>& machines;
  const std::map<std::string, std::string>& machine_of_campaign;
  const std::vector<store::Spelling>& spellings;
  const std::map<std::string, OfQuantity>& learned;
  /// Names of machines that people use and no campaign has, each with its file.
  const std::vector<std::string>& unknown;
};

/// The actions that the last run requires, one line each: in the order of what ignoring them costs,
/// within that new before known, then the largest first. One cause is reported once.
std::vector<reports::WorkItem> lines_of(const Known& known);

/// Of a quantity: reversal, scale, curve, turn, cyclic, scatter, squareness, straightness, centre,
/// circle, parameter. Its words are `term.what` and `term.look`.
std::string kind_of(const std::string& quantity);

/// The axis of a series, out of its quantity (backlash:X.b) where it has none.
std::string axis_of(const std::string& axis, const std::string& quantity);

}  // namespace nonio::assessment
