// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/math/rigid_body.h"
#include "nonio/sdk/plugin.h"

/// What the measurements of a campaign give to the fit of all errors.
namespace nonio::rigid_body {

/// A line of what a certificate states: of an artefact, or of a square.
struct Stated {
  std::size_t line = 0;
  std::string name, square;
};

struct Lines {
  std::vector<math::RigidLine> lines;
  std::vector<math::BudgetLine> budget;          ///< one for each line, readings in the same order
  std::vector<std::string> groups;               ///< kinds of measurements with readings
  std::vector<bool> angular;                     ///< of each group
  std::vector<std::string> used;                 ///< ids
  std::vector<const Observations*> tables;       ///< of these
  std::vector<std::string> left_out, centred;    ///< ids: of no use here; taken through the middle
  std::vector<std::size_t> measurement_of_line;  ///< into `used`
  std::vector<Stated> stated;
  std::vector<std::string> certificates;  ///< ids of measurements that state something
  std::vector<std::string> uncalibrated;  ///< artefacts without a certificate
  std::vector<std::string> free_slope;    ///< lines on a square whose error is not stated
  std::vector<Finding> findings;
  math::Corner low{}, high{};  ///< that holds all readings

  /// Number of a group of readings that have one scatter.
  std::size_t group_of(const std::string& kind, bool angle);
};

/// Whether a measurement is of linear axes, of a kind that the fit takes.
bool is_taken(const Campaign&, const Measurement&);
/// Whether with such a measurement the readings of its state can determine a squareness.
bool shows_squareness(const Campaign&, const Measurement&);
/// Of the same state as this one, or of every state.
Lines lines_of(const AnalysisInput&);

}  // namespace nonio::rigid_body
