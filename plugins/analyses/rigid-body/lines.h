// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/math/rigid_body.h"
#include "nonio/sdk/plugin.h"

/// What the measurements of a campaign give to the fit of all errors.
namespace nonio::rigid_body {

struct Lines {
  std::vector<math::RigidLine> lines;
  std::vector<math::BudgetLine> budget;        ///< one for each line, readings in the same order
  std::vector<std::string> groups;             ///< kinds of measurements with readings
  std::vector<bool> angular;                   ///< of each group
  std::vector<std::string> used;               ///< ids
  std::vector<const Observations*> tables;     ///< of these
  std::vector<std::string> left_out, centred;  ///< ids: of no use here; taken through the middle
  math::Corner low{}, high{};                  ///< that holds all readings
};

/// Whether a measurement is of linear axes, of a kind that the fit takes.
bool is_taken(const Campaign&, const Measurement&);
/// Of the same state as this one, or of every state.
Lines lines_of(const AnalysisInput&);

}  // namespace nonio::rigid_body
