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

/// The data from which the worklist is made.
struct Known {
  const LastRun& last_run;
  const std::vector<const Standing*>& machines;
  const std::map<std::string, std::string>& machine_of_campaign;
  const std::vector<store::Spelling>& spellings;
  const std::map<std::string, OfQuantity>& learned;
  /// Names of machines in entries of people that no campaign states, each with its file.
  const std::vector<std::string>& unknown;
};

/// Returns the lines of the worklist. They are sorted by kind, beginning with the kind that is most
/// costly to ignore, then new before known, then sudden before gradual changes, then by size. One
/// cause is reported once.
std::vector<reports::WorkItem> lines_of(const Known& known);

/// Returns the kind of a quantity: reversal, scale, curve, turn, cyclic, scatter, squareness,
/// straightness, centre, circle or parameter. The texts for a kind are in the word lists
/// `term.what` and `term.look`.
std::string kind_of(const std::string& quantity);

/// Returns `axis`; if it is empty, the axis that the quantity contains (X in backlash:X.b).
std::string axis_of(const std::string& axis, const std::string& quantity);

}  // namespace nonio::assessment
