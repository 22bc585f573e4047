// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "search/finding.h"

namespace nonio::model {

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
