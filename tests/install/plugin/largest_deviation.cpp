// SPDX-License-Identifier: Apache-2.0
// A whole plugin: the largest deviation of an axis in size, and a table of it; both with what the
// installed libraries have.
#include <algorithm>
#include <cmath>

#include "nonio/controllers/list.h"
#include "nonio/math/axis_test.h"
#include "nonio/sdk/check.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/plugin.h"

using namespace nonio;

static Expected<Evaluation> analyse(const AnalysisInput& in) {
  if (const auto sound = check(in.observations); !sound) return fail(sound.error());
  const auto test = math::AxisTest::arrange(in.observations);
  double largest = 0.0;
  for (const auto& r : test.readings()) largest = std::max(largest, std::fabs(r.deviation));
  Evaluation e;
  e.values.push_back({"largest", largest, deviation_of(test.rotary)});
  e.notes.push_back({.id = "largest", .english = fixed_text(largest * 1e6, 1) + " um"});
  return e;
}

static ControlTable declared() {
  ControlTable t;
  t.name = "elsewhere";
  t.sign = ControlTable::Sign::correction;
  t.facts = {{"sign", ControlTable::Confidence::documented, "Of this test."}};
  return t;
}

static Expected<std::vector<LoadedTable>> parse(const TableInput& in) {
  return controllers::parse_list(in, declared(), "elsewhere");
}

static Expected<OutputResult> write(const ControllerInput& in) {
  return controllers::write_tables(
      in, {.name = "elsewhere",
           .table = declared(),
           .keys = {"number:"},
           .files = [](const auto& s) { return controllers::list_file(s, "elsewhere"); },
           .parse = parse});
}

NONIO_PLUGIN(registry) {
  registry.add(Analysis{{"largest-deviation", "1", "The largest deviation in size", {}},
                        [](const Campaign&, const Measurement& m) { return m.kind == "axis"; },
                        analyse});
  registry.add(controllers::controller(
      {"elsewhere", "1", "A control of another house", {controllers::axes_option("number")}},
      declared(), write, parse));
}
