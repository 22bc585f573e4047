// SPDX-License-Identifier: Apache-2.0
#include "series_jobs.h"

#include <algorithm>

namespace nonio::controllers {

std::vector<AxisJob> series_jobs(const ControllerInput& in) {
  std::vector<AxisJob> jobs;
  const auto measured = [&](const Evaluation& e, const std::string& axis) {
    return std::any_of(in.campaign.measurements.begin(), in.campaign.measurements.end(),
                       [&](const Measurement& m) {
                         return m.kind == "axis" && m.axis == axis &&
                                std::find(e.uses.begin(), e.uses.end(), m.id) != e.uses.end();
                       });
  };
  for (const Results::Analysed& a : in.results.analyses)
    for (const Series& s : a.evaluation.series) {
      const bool positioning = s.name == "EXX" || s.name == "EYY" || s.name == "EZZ";
      if (!positioning || s.position.size() < 2 || measured(a.evaluation, s.over)) continue;
      AxisJob job;
      job.axis = s.over;
      job.measurement = a.measurement;
      job.from_diagonals = true;
      job.curve.position = s.position;
      job.curve.mean = job.curve.plus = s.value;
      jobs.push_back(std::move(job));
    }
  return jobs;
}

}  // namespace nonio::controllers
