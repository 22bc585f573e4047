// SPDX-License-Identifier: Apache-2.0
// A second symbol that everybody sees.
#include "nonio/sdk/plugin.h"

extern "C" __attribute__((visibility("default"))) int second_symbol() { return 2; }

NONIO_PLUGIN(registry) {
  nonio::Output o;
  o.info = {"exports-two", "1", "Wrong on purpose", {}};
  o.applies = [](const nonio::Campaign&) { return true; };
  o.write = [](const nonio::OutputInput&) -> nonio::Expected<nonio::OutputResult> {
    nonio::OutputResult r;
    r.artifacts.push_back({"a.txt", "a", false});
    return r;
  };
  registry.add(o);
}
