// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "campaign/modelling/campaign_model.h"

namespace nonio::modelling {

/// Predicts what remains of the readings of a part if a table in the control compensates the
/// compensable effects of the model. `rms` is the RMS of all readings about the zero of their line,
/// weighted as in the fit; it equals the RMS of the fit if every effect is compensable and the
/// readings are independent. `tests` contains E, A and R of ISO 230-2 with k = 2 (math/iso230_2.h)
/// for each measurement of one axis, NaN if the readings do not determine them. `nonio table
/// predict` evaluates a real table, which has points and steps.
struct AfterTable {
  struct Positioning {
    double E, A, R;  ///< results according to ISO 230-2, m or rad
  };
  struct Test {
    std::string measurement;
    Positioning before, after;
  };
  std::vector<std::string> effects;    ///< the compensated effects; empty: none is compensable
  double rms_before = 0.0, rms = 0.0;  ///< RMS without and with the table, m or rad
  std::vector<Test> tests;  ///< results per measurement; empty if no axis is measured along itself
};

AfterTable after_table(const PartModel& model, const model::Fit& fit);

}  // namespace nonio::modelling
