// SPDX-License-Identifier: Apache-2.0
// A whole plugin: the largest deviation of an axis in size.
#include <algorithm>
#include <cmath>

#include "nonio/math/axis_test.h"
#include "nonio/sdk/plugin.h"

using namespace nonio;

static Expected<Evaluation> analyse(const AnalysisInput& in) {
  const auto test = math::AxisTest::arrange(in.observations);
  double largest = 0.0;
  for (const auto& r : test.readings()) largest = std::max(largest, std::fabs(r.deviation));
  Evaluation e;
  e.values.push_back({"largest", largest, deviation_of(test.rotary)});
  return e;
}

NONIO_PLUGIN(registry) {
  registry.add(Analysis{{"largest-deviation", "1", "The largest deviation in size", {}},
                        [](const Campaign&, const Measurement& m) { return m.kind == "axis"; },
                        analyse});
}
