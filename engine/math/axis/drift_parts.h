// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "common/constants.h"
#include "nonio/math/axis_test.h"

namespace nonio::math {

/// The last result is kept, because analyses, uncertainties and the table of each control need it.
/// Results of long tests are not kept, to save memory.
template <auto compute>
auto kept(const AxisTest& test) {
  constexpr std::size_t most_readings = 10'000;
  if (test.readings().size() > most_readings) return compute(test);
  thread_local std::pair<AxisTest, decltype(compute(test))> last;
  if (last.first != test) last = {test, compute(test)};
  return last.second;
}

}  // namespace nonio::math
