// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "nonio/controllers/axis_job.h"
#include "nonio/controllers/text.h"
#include "nonio/math/distributions.h"
#include "nonio/sdk/format.h"

namespace nonio::controllers {

bool refused(const AxisJob& job, Columns columns, OutputResult& result) {
  if (job.reversal.kind != math::Reversal::Kind::not_constant || columns == Columns::both)
    return false;
  const auto [low, high] = std::minmax_element(job.curve.mean.begin(), job.curve.mean.end());
  if (low == job.curve.mean.end() || job.reversal.largest_left < *high - *low) return false;
  const Quantity q = deviation_of(job.rotary);
  result.findings.push_back(
      {"table.refused-reversal",
       true,
       {{"mean", job.reversal.mean, q}, {"max", job.reversal.largest, q}},
       {{"axis", job.axis}},
       job.measurement,
       "The reversal changes along the axis: no single backlash value removes it. Look at the "
       "mechanics first; tables for each direction (directions = true) are a palliative."});
  return true;
}

namespace {

std::string drift_warning(const AxisJob& job, OutputResult& result) {
  const std::string ids = joined(job.drift, ", ");
  result.findings.push_back({"table.unstable-axis",
                             true,
                             {},
                             {{"axis", job.axis}, {"drift", ids}},
                             job.measurement,
                             "Do not compensate yet: the axis was not stable while it was "
                             "measured. Measure it again."});
  return "WARNING: the axis drifted while it was measured (" + ids +
         "); do not load this table before the cause is found";
}

std::string suspect_warning(const AxisJob& job, OutputResult& result) {
  const std::string readings = joined(job.suspects, "; ");
  result.findings.push_back(
      {"table.suspect-reading",
       true,
       {{"readings", static_cast<double>(job.suspects.size()), Quantity::count}},
       {{"axis", job.axis}, {"which", readings}},
       job.measurement,
       "The table follows readings that do not belong to the others: look at the record of the "
       "test before this table is loaded."});
  return "WARNING: the table contains suspect readings at " + readings +
         "; do not load this table before they are explained";
}

// The F test shows a varying reversal, and a single value would leave more than a quarter of it.
void doubt_uneven_reversal(const AxisJob& job, OutputResult& result) {
  constexpr double level = 0.01, share = 0.25;
  const math::Reversal& r = job.reversal;
  if (!math::significant(r.p_varies, level) || !(r.largest_left > share * r.largest)) return;
  const Quantity q = deviation_of(job.rotary);
  result.findings.push_back({"table.uneven-reversal",
                             true,
                             {{"mean", r.mean, q}, {"left", r.largest_left, q}},
                             {{"axis", job.axis}},
                             job.measurement,
                             "The reversal varies along the axis more than the readings scatter: "
                             "the single backlash value leaves a part of it."});
}

}  // namespace

std::vector<std::string> warnings(const AxisJob& job, OutputResult& result) {
  std::vector<std::string> lines;
  if (!job.drift.empty()) lines.push_back(drift_warning(job, result));
  if (!job.suspects.empty()) lines.push_back(suspect_warning(job, result));
  return lines;
}

std::string reversal_words(const AxisJob& job, Columns columns) {
  if (job.from_diagonals)
    return "from the step diagonals of " + plain(job.measurement) + ": no backlash value" +
           (job.scale_known ? ""
                            : "; NOT in the table: the scale of the axis, which they do not know");
  if (!job.curve.bidirectional()) return "measured from one direction only: no backlash value";
  const std::string mean = deviation_words(job, job.mean_reversal());
  if (job.held)
    return "mean reversal B = " + mean + ", U = " + deviation_words(job, job.U.B_mean) +
           ": not identifiable, so it is not in the table; backlash parameter = " +
           with_unit(job, job.present_backlash(), 6) + ", as while it was measured";
  if (columns == Columns::both)
    return "mean reversal B = " + mean +
           ": contained in the two directions of the table; backlash parameter = " +
           with_unit(job, job.present_backlash(), 6) + ", as while it was measured";
  if (!job.one_value_helps())
    return "mean reversal B = " + mean +
           ": one value would not make it smaller; backlash parameter = " +
           with_unit(job, job.present_backlash(), 6) + ", as while it was measured";
  return "mean reversal B = " + mean +
         ": backlash parameter = " + with_unit(job, job.backlash(), 6) +
         " (opposite sign, lost motion is positive)";
}

void doubt_backlash(const AxisJob& job, OutputResult& result) {
  if (job.held) return;
  const Quantity q = deviation_of(job.rotary);
  if (job.reversal.kind == math::Reversal::Kind::not_constant) {
    result.findings.push_back(
        {"table.backlash-not-constant",
         true,
         {{"mean", job.reversal.mean, q}, {"left", job.reversal.largest_left, q}},
         {{"axis", job.axis}},
         job.measurement,
         "The pitch table is right for itself; the backlash value stays as it was."});
    return;
  }
  if (!job.one_value_helps()) {
    result.findings.push_back({"table.backlash-no-gain",
                               false,
                               {{"mean", job.reversal.mean, q},
                                {"before", job.reversal.largest, q},
                                {"after", job.reversal.largest_left, q}},
                               {{"axis", job.axis}},
                               job.measurement,
                               "The backlash value stays as it was while the axis was measured."});
    return;
  }
  doubt_uneven_reversal(job, result);
  if (job.reversal.kind != math::Reversal::Kind::over_compensated ||
      job.settings.count("backlash_mm") || job.settings.count("backlash_deg"))
    return;
  result.findings.push_back(
      {"table.positive-reversal",
       true,
       {{"mean", job.reversal.mean, deviation_of(job.rotary)}},
       {{"axis", job.axis}, {"setting", job.rotary ? "backlash_deg" : "backlash_mm"}},
       job.measurement,
       "Clearances and friction cause this, or a backlash value that is active. State the active "
       "value (" +
           std::string(job.rotary ? "backlash_deg" : "backlash_mm") + " = ... under axes." +
           job.axis +
           " in the options of this control), so that the new value is the present one less the "
           "excess."});
}

void predict(const AxisJob& job, const math::Correction& whole, OutputResult& result) {
  const double present = job.present_backlash();
  const math::Correction correction = [&](double x, int direction) {
    return whole(x, direction) - (direction > 0 ? present / 2.0 : -present / 2.0);
  };
  const math::ErrorCurve& curve = job.measured ? *job.measured : job.curve;
  const math::MeanDeviations was = math::before(curve);
  const math::MeanDeviations will = math::after(curve, correction);
  const Quantity q = deviation_of(job.rotary);
  const auto add = [&](const char* name, double before, double after) {
    if (std::isfinite(before) && std::isfinite(after))
      result.predictions.push_back({job.measurement, name, before, after, q});
  };
  const bool both = curve.bidirectional();
  const double U_B =
      job.held ? 0.0 : math::reversal_uncertainty(curve, correction, job.U.B, job.U.B_mean);
  const double B_after = math::predicted_after(was.B(), will.B(), U_B);
  const double E_after = math::predicted_E_after(was.E(), will.E(), job.U.E, U_B, B_after);
  // Without a known scale, the curve is not the axis error, and predictions are made for the
  // diagonals instead.
  // Without all targets, the values of the axis are not known before compensation either.
  if (job.scale_known && curve.left_out == 0) {
    add(both ? "E" : job.from_diagonals ? "M" : curve.plus.empty() ? "E-" : "E+", was.E(), E_after);
    add("B", was.B(), B_after);
    const double M_after = math::predicted_after(was.M(), will.M(), job.U.M);
    add("M", was.M(), M_after);
    if (will.E() < was.E() && M_after > was.M())
      result.findings.push_back({"table.worse-mean",
                                 true,
                                 {{"before", was.M(), q}, {"after", M_after, q}},
                                 {{"axis", job.axis}},
                                 job.measurement,
                                 "Load only the backlash value."});
  }
  if (job.drifted > 0.0)
    result.notes.emplace_back(remark(job, "table.drifted")).evidence = {{"drift", job.drifted, q}};
  if (std::isnan(job.U.E) && will.E() < was.E()) {
    Remark& note = result.notes.emplace_back(remark(job, "table.at-least"));
    note.texts.emplace_back("id", job.measurement);
  }
  if (!(will.E() < was.E()))
    result.findings.push_back({"table.no-gain",
                               true,
                               {{"before", was.E(), q}, {"after", will.E(), q}},
                               {{"axis", job.axis}},
                               job.measurement,
                               "This table would not make the axis better."});
}

}  // namespace nonio::controllers
