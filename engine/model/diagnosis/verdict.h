// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/model/explain.h"
#include "search/finding.h"

namespace nonio::model {

/// What is left counts against the verdict `nothing` below this p.
// docs/dev/constants.md, M5.
inline constexpr double serious_p = 0.005;

// docs/dev/constants.md, M4.
inline constexpr double least_left =
    0.25;  ///< of the noise: smaller structure is not worth a verdict
// docs/dev/constants.md, M35.
inline constexpr double lacks_fit_p = 1e-4;

/// More suspects than this, of the readings and in number: then they do not repeat.
inline constexpr double most_suspects = 0.06;
inline constexpr std::size_t few_suspects = 2;
inline bool too_many(std::size_t suspects, std::size_t readings) {
  return suspects > few_suspects &&
         static_cast<double>(suspects) > most_suspects * static_cast<double>(readings);
}

/// Verdict, where the model fails, and the plans for the verdict's aliases; the verdict's effect
/// comes to lead `out.candidates`.
void judge(const Finding& finding, Explanation& out);

}  // namespace nonio::model
