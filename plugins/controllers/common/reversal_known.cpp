// SPDX-License-Identifier: Apache-2.0
#include "reversal_known.h"

#include <algorithm>
#include <cmath>

#include "nonio/math/axis_findings.h"

namespace nonio::controllers {
namespace {

/// A table from a model with drift is free of drift.
bool is_drift_modelled(const Campaign& campaign, const std::string& axis) {
  return std::any_of(campaign.model.begin(), campaign.model.end(), [&](const std::string& e) {
    const bool drift = e.find("drift") != e.npos || e.starts_with("warm-up");
    return drift && e.substr(e.find(':') + 1) == axis;
  });
}

}  // namespace

void take_uncertainties(const ControllerInput& input, std::size_t index, AxisJob& job) {
  using Kind = math::Reversal::Kind;
  const bool of_model = input.measured != nullptr && index < input.measured->size();
  const Observations& o = of_model ? (*input.measured)[index] : input.observations[index];
  const math::AxisTest test = math::AxisTest::arrange(o);
  const Measurement& m = input.campaign.measurements[index];
  job.U = math::compensated_uncertainty(input.campaign, m, o, test,
                                        !of_model || !is_drift_modelled(input.campaign, m.axis));
  const double mean = job.curve.mean_reversal();
  if (!job.curve.bidirectional() || job.reversal.kind == Kind::not_constant ||
      job.reversal.kind == Kind::unknown || math::is_reversal_known(mean, job.U.B_mean))
    return;
  // The severity depends on the largest possible reversal.
  job.held = {
      mean, job.reversal.kind != Kind::none || math::matters(test, std::fabs(mean) + job.U.B_mean)};
  if (!job.measured) job.measured = job.curve;
  job.curve.plus = job.curve.minus = job.curve.mean;
}

void say_held(const AxisJob& job, OutputResult& result) {
  const Quantity q = deviation_of(job.rotary);
  result.findings.push_back(
      {"table.backlash-not-identifiable",
       job.held->attention,
       {{"mean", job.held->mean, q}, {"U", job.U.B_mean, q}},
       {{"axis", job.axis}},
       job.measurement,
       "The reversal is not known well enough: the backlash value stays as it was while the axis "
       "was measured."});
}

}  // namespace nonio::controllers
