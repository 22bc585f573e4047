// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/model/explain.h"
#include "search/finding.h"

namespace nonio::model {

/// p below which residual structure contradicts the verdict `nothing`: docs/dev/constants.md, M5.
inline constexpr double serious_p = 0.005;

// Fraction of the noise below which structure changes no verdict: docs/dev/constants.md, M4.
inline constexpr double least_left = 0.25;
// docs/dev/constants.md, M35.
inline constexpr double lacks_fit_p = 1e-4;

/// The verdict is `unrepeatable` above both: share and number of suspect readings.
inline constexpr double most_suspects = 0.06;
inline constexpr std::size_t few_suspects = 2;
inline bool too_many(std::size_t suspects, std::size_t readings) {
  return suspects > few_suspects &&
         static_cast<double>(suspects) > most_suspects * static_cast<double>(readings);
}

/// Sets the verdict, its rate of false alarms, significant and canceling effects, places and plans.
/// Moves the effect of the verdict to the front of `out.candidates`. `rms_of_model`: RMS with the
/// weights of the RMS of the candidates, m or rad.
void judge(const Finding& finding, double rms_of_model, Explanation& out);

}  // namespace nonio::model
