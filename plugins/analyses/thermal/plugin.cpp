// SPDX-License-Identifier: Apache-2.0
// Thermal tests (ISO 230-3): a machine at rest (ETVE), a rotating spindle, or a cycling axis.
#include "nonio/sdk/plugin.h"

#include <algorithm>
#include <cmath>

#include "nonio/math/differences.h"
#include "worked.h"

namespace nonio::thermal {
namespace {

bool applies(const Campaign&, const Measurement& m) { return m.kind == "thermal"; }

/// Proposes environment.drift for the budgets of other campaigns from a machine at rest.
void propose_drift(const AnalysisInput& in, const Worked& worked, const Wish& wish,
                   Evaluation& out) {
  if (!(worked.drift > 0.0)) return;
  constexpr double of_range = 0.6;  // docs/dev/constants.md, A7
  Finding f{.id = "thermal.drift-proposal",
            .attention = false,
            .evidence = {{"drift", worked.drift, Quantity::deviation},
                         {"window_min", wish.window / 60.0, Quantity::number},
                         {"U_EVE", of_range * worked.drift, Quantity::deviation}},
            .texts = {{"sensor", worked.drift_sensor}, {"serial", in.campaign.machine.serial}}};
  const auto& stated = in.campaign.environment.drift;
  if (stated && worked.drift > *stated) {
    f.id = "thermal.drift-above-stated";
    f.attention = true;
    f.evidence.push_back({"stated", *stated, Quantity::deviation});
  }
  out.findings.push_back(std::move(f));
}

Expected<Evaluation> analyse(const AnalysisInput& in) {
  const Observations& o = in.observations;
  if (o.time.size() != o.size() ||
      !std::all_of(o.time.begin(), o.time.end(), [](double t) { return std::isfinite(t); }))
    return fail("measurement \"" + in.measurement.id + "\": expected a time with each reading");
  const Wish wish{in.options.number("window_min", 60.0) * 60.0,
                  in.options.number("remaining_um", 1.0) * 1e-6};
  const Tracks tracks = tracks_of(in.measurement, o);
  Worked worked = work(tracks, in.measurement, wish);
  Evaluation out;
  out.findings = std::move(worked.findings);
  math::put_differences(in.campaign, worked.items, out);
  out.series = std::move(worked.series);
  out.points = std::move(worked.points);
  propose_drift(in, worked, wish, out);
  const char* id = tracks.test == Test::etve      ? "method.thermal-etve"
                   : tracks.test == Test::loaded  ? "method.thermal-loaded"
                   : tracks.test == Test::spindle ? "method.thermal-spindle"
                                                  : "method.thermal-axis";
  out.notes.push_back({id, {{"window_min", wish.window / 60.0, Quantity::number}}});
  return out;
}

std::vector<Option> options() {
  return {within(0.1, 1e5,
                 {"window_min", 60.0, "min",
                  "Length of the windows in which ranges are taken: the time that a run of other "
                  "campaigns takes."}),
          within(0.001, 1e4,
                 {"remaining_um", 1.0, "um",
                  "Change that may remain after the warm-up that is proposed."})};
}

}  // namespace

NONIO_PLUGIN(registry) {
  Analysis a;
  a.info = {"thermal", "1.0.0",
            "Thermal tests (ISO 230-3): ranges in windows, time constants, growth, proposals.",
            options()};
  a.applies = applies;
  a.analyse = analyse;
  a.states_followed = true;
  registry.add(std::move(a));
}

}  // namespace nonio::thermal
