// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "campaign/modelling/campaign_model.h"

namespace nonio::modelling {

/// Predicts the readings of a part when a table compensates the compensable effects of its model.
/// `rms`: about the zero of each line, weighted as in the fit. `tests`: E, A and R of ISO 230-2
/// with k = 2 for each measurement of one axis, NaN if not determined.
struct AfterTable {
  struct Positioning {
    double E, A, R;  ///< ISO 230-2, m or rad
  };
  struct Test {
    std::string measurement;
    Positioning before, after;
  };
  std::vector<std::string> effects;    ///< compensated effects; may be empty
  double rms_before = 0.0, rms = 0.0;  ///< without and with the table, m or rad
  std::vector<Test> tests;  ///< one per measurement; empty if no axis is measured along itself
};

AfterTable after_table(const PartModel& model, const model::Fit& fit);

}  // namespace nonio::modelling
