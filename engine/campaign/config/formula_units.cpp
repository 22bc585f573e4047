// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/formula_units.h"

namespace nonio::config {

std::string known_units() {
  std::string text;
  for (const FormulaUnit& u : formula_units)
    text +=
        (text.empty() ? "" : ", ") + std::string(u.symbol()) + " (" + std::string(u.words) + ")";
  return text;
}

}  // namespace nonio::config
