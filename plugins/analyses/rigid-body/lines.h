// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/math/rigid_body.h"
#include "nonio/sdk/plugin.h"

/// Input of the fit of all errors from the measurements of a campaign.
namespace nonio::rigid_body {

/// A line with the certified values of an artefact or a square.
struct Stated {
  std::size_t line = 0;
  std::string name, square;
};

struct Lines {
  std::vector<math::RigidLine> lines;
  std::vector<math::BudgetLine> budget;          ///< one for each line, readings in the same order
  std::vector<std::string> groups;               ///< kinds of measurements with readings
  std::vector<bool> angular;                     ///< per group: whether readings are angles
  std::vector<std::string> used;                 ///< ids of the measurements used
  std::vector<const Observations*> tables;       ///< readings of each measurement in `used`
  std::vector<std::string> left_out, centred;    ///< ids of measurements that are not usable, and
                                                 ///< of those assumed at the center
  std::vector<std::size_t> measurement_of_line;  ///< index into `used`
  std::vector<Stated> stated;
  std::vector<std::string> certificates;  ///< ids of measurements with certified values
  std::vector<std::string> uncalibrated;  ///< artefacts without a certificate
  std::vector<std::string> free_slope;    ///< ids of lines on squares without a stated error
  std::vector<Finding> findings;
  math::Corner low{}, high{};  ///< box that contains all readings, m

  /// Index of the group of readings with a common scatter; a new group is added.
  std::size_t group_of(const std::string& kind, bool angle);
};

/// Whether the fit accepts this measurement: linear axes and a supported kind.
bool is_taken(const Campaign&, const Measurement&);
/// Whether a measurement like this one makes a squareness of its state identifiable.
bool shows_squareness(const Campaign&, const Measurement&);
/// Measurements of the same state as the input, or without a state.
Lines lines_of(const AnalysisInput&);

}  // namespace nonio::rigid_body
