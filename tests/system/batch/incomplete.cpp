// SPDX-License-Identifier: Apache-2.0
// A complete analysis, and an output without the function `applies`.
#include "nonio/sdk/plugin.h"

NONIO_PLUGIN(registry) {
  using namespace nonio;
  registry.add(Analysis{{"complete", "1", "Beside what is not", {}},
                        [](const Campaign&, const Measurement&) { return true; },
                        [](const AnalysisInput&) { return Expected<Evaluation>(); }});
  registry.add(Output{{"incomplete", "1", "Has no `applies`", {}}, nullptr, [](const OutputInput&) {
                        return Expected<OutputResult>();
                      }});
}
