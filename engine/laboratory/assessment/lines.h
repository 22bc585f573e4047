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

/// Input of the worklist.
struct Known {
  const LastRun& last_run;
  const std::vector<const Standing*>& machines;
  const std::map<std::string, std::string>& machine_of_campaign;
  const std::vector<store::Spelling>& spellings;
  const std::map<std::string, OfQuantity>& learned;
  /// Names that no campaign states, with the file that contains them.
  const std::vector<std::string>& unknown;
};

/// Returns the worklist, sorted by kind in the order of urgency, then new before known, sudden
/// before gradual, large before small changes. Each cause has one line.
std::vector<reports::WorkItem> lines_of(const Known& known);

/// Returns reversal, scale, curve, turn, cyclic, scatter, squareness, straightness, centre,
/// circular or parameter. The word lists `term.what` and `term.look` contain the texts.
std::string kind_of(const std::string& quantity);

/// Returns `axis`, or if it is empty the axis in the name of the quantity, such as X in
/// backlash:X.b.
std::string axis_of(const std::string& axis, const std::string& quantity);

}  // namespace nonio::assessment
