// SPDX-License-Identifier: Apache-2.0
// Claims a name that another plugin has.
#include "nonio/sdk/plugin.h"

NONIO_PLUGIN(registry) {
  registry.add(nonio::Analysis{
      {"iso230-2", "9", "A twin", {}},
      [](const nonio::Campaign&, const nonio::Measurement&) { return true; },
      [](const nonio::AnalysisInput&) { return nonio::Expected<nonio::Evaluation>(); }});
}
