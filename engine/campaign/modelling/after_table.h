// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "campaign/modelling/campaign_model.h"

namespace nonio::modelling {

/// What remains of the readings of a part if a table in the control compensates the compensable
/// effects of the model: RMS of all readings about the zero of their line, weighted as in the fit
/// (equal to the RMS of the fit if every effect is compensable and the readings are independent);
/// of each measurement of one axis E, A and R of ISO 230-2 with k = 2 (math/iso230_2.h), NaN where
/// the readings do not give them. A prediction: a control's table has points and steps, and
/// `nonio table predict` reads a real one.
struct AfterTable {
  struct Positioning {
    double E, A, R;  ///< m or rad
  };
  struct Test {
    std::string measurement;
    Positioning before, after;
  };
  std::vector<std::string> effects;    ///< those that are compensated; empty: none is compensable
  double rms_before = 0.0, rms = 0.0;  ///< m or rad
  std::vector<Test> tests;             ///< empty where no axis is measured along itself
};

AfterTable after_table(const PartModel& model, const model::Fit& fit);

}  // namespace nonio::modelling
