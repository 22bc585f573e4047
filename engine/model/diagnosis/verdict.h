// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/model/explain.h"
#include "search/finding.h"

namespace nonio::model {

/// A residual structure with p below this contradicts the verdict `nothing`.
/// docs/dev/constants.md, M5.
inline constexpr double serious_p = 0.005;

// docs/dev/constants.md, M4.
inline constexpr double least_left =
    0.25;  ///< fraction of the noise; smaller structure does not change the verdict
// docs/dev/constants.md, M35.
inline constexpr double lacks_fit_p = 1e-4;

/// The verdict is `unrepeatable` if more than this share of the readings, and more than
/// `few_suspects` readings, are suspect.
inline constexpr double most_suspects = 0.06;
inline constexpr std::size_t few_suspects = 2;
inline bool too_many(std::size_t suspects, std::size_t readings) {
  return suspects > few_suspects &&
         static_cast<double>(suspects) > most_suspects * static_cast<double>(readings);
}

/// Sets the verdict with its rate of false alarms, the significant and the canceling effects, the
/// places where the model fails, and the plans that separate the verdict's effect from its aliases.
/// Moves the verdict's effect to the front of `out.candidates`.
void judge(const Finding& finding, Explanation& out);

}  // namespace nonio::model
