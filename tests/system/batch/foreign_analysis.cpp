// SPDX-License-Identifier: Apache-2.0
// An analysis of a third party that does not state which results are followed, and gives a length the
// name of a squareness.
#include "nonio/sdk/plugin.h"

using namespace nonio;

static Expected<Evaluation> analyse(const AnalysisInput& in) {
  Evaluation e;
  for (const char* name : {"first_deviation", "C0Y"})
    e.values.push_back({name, in.observations.deviation.front(), Quantity::deviation, 2e-7});
  e.values.push_back({"without_budget", 1e-6, Quantity::deviation});
  UncertaintyBudget b;
  b.contributions.push_back({.id = "repeatability", .u = 1e-7, .source = "readings"});
  for (const char* name : {"first_deviation", "C0Y"})
    b.results.push_back({.name = name, .quantity = Quantity::deviation, .u = {1e-7}});
  e.budget = b;
  return e;
}

NONIO_PLUGIN(registry) {
  Analysis a;
  a.info = {"foreign", "1.0.0", "The first deviation, and a length named like a squareness."};
  a.applies = [](const Campaign&, const Measurement& m) { return m.kind == "axis"; };
  a.analyse = analyse;
  registry.add(std::move(a));
}
