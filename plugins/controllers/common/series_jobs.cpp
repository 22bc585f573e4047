// SPDX-License-Identifier: Apache-2.0
#include "series_jobs.h"

#include <algorithm>

#include "resolution.h"

namespace nonio::controllers {
namespace {

struct Positioning {
  bool is = false, shape = false;
};

Positioning positioning(std::string_view name) {
  Positioning p;
  p.shape = name.ends_with("_shape");
  if (p.shape) name.remove_suffix(6);
  p.is = name == "EXX" || name == "EYY" || name == "EZZ";
  return p;
}

/// Whether the axis has a positioning run, which gives a better table: one used for these step
/// diagonals, or one of the same state.
bool has_run(const ControllerInput& in, const Results::Analysed& a, const std::string& axis) {
  const auto& all = in.campaign.measurements;
  const auto of = std::find_if(all.begin(), all.end(),
                               [&](const Measurement& m) { return m.id == a.measurement; });
  const auto& uses = a.evaluation.uses;
  for (std::size_t i = 0; i < std::min(all.size(), in.observations.size()); ++i)
    if (all[i].kind == "axis" && all[i].axis == axis && in.observations[i].size() > 0 &&
        (std::find(uses.begin(), uses.end(), all[i].id) != uses.end() ||
         (of != all.end() && state_of(all[i]) == state_of(*of))))
      return true;
  return false;
}

}  // namespace

std::vector<AxisJob> series_jobs(const ControllerInput& in) {
  std::vector<AxisJob> jobs;
  for (const Results::Analysed& a : in.results.analyses)
    for (const Series& s : a.evaluation.series) {
      const Positioning p = positioning(s.name);
      if (!p.is || s.position.size() < 2 || has_run(in, a, s.over)) continue;
      AxisJob job;
      job.axis = s.over;
      job.measurement = a.measurement;
      job.from_diagonals = true;
      job.scale_known = !p.shape;
      job.curve.position = s.position;
      job.curve.mean = job.curve.plus = s.value;
      job.unresolved = unresolved_step(in, a.measurement, s.position, s.value);
      jobs.push_back(job);
      // Both gantry sides have the same error, because the diagonals measure the center of the
      // beam.
      const Axis* axis = in.campaign.machine.axis(s.over);
      if (axis == nullptr || axis->slave.empty()) continue;
      job.axis = axis->slave;
      jobs.push_back(std::move(job));
    }
  return jobs;
}

}  // namespace nonio::controllers
