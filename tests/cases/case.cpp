// SPDX-License-Identifier: Apache-2.0
#include "case.h"

#include <cmath>
#include <cstdint>

#include "circle.h"
#include "expression.h"
#include "fine_motion.h"
#include "heat.h"
#include "nonio/math/axis_findings.h"
#include "nonio/math/iso230_2.h"
#include "nonio/math/positioning.h"
#include "nonio/math/reversal.h"
#include "nonio/math/uncertainty.h"
#include "nonio/math/vdi3441.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/units.h"

using namespace nonio;
using namespace nonio::math;

namespace {

double deviation_unit(const Case& c) { return unit_of(deviation_of(c.rotary())).per_si; }
double position_unit(const Case& c) { return unit_of(position_of(c.rotary())).per_si; }

std::string give_readings(Case& c, const std::vector<std::string>& words, double target) {
  const bool minus = words[2] == "-";
  if (!minus && words[2] != "+") return "expected direction + or -, found " + words[2];
  Observations& o = c.observations;
  for (std::size_t k = 3; k < words.size(); ++k) {
    if (words[k] == "x") {
      ++o.missing;
      continue;
    }
    const auto value = Expression::value(words[k]);
    if (!value) return "expected a number, found " + words[k];
    o.axes[0].position.push_back(target / position_unit(c));
    o.axes[0].approach.push_back(minus ? -1 : 1);
    o.deviation.push_back(*value / deviation_unit(c));
    o.u.push_back(0.0);
    o.run.push_back(static_cast<std::uint32_t>(k - 2));
    o.source_line.push_back(0);
  }
  return {};
}

// Keys of the manifest, each with its unit in its name.
std::string give_key(Case& c, const std::string& key, double v) {
  Axis& axis = c.campaign.machine.axes[0];
  Instrument& i = c.campaign.instrument;
  Environment& e = c.campaign.environment;
  if (key == "U_fixed_um")
    i.U_fixed = v * 1e-6;
  else if (key == "U_per_m_um")
    i.U_per_length = v * 1e-6;
  else if (key == "U_arcsec")
    i.U_angle = v / arcsec_per_rad;
  else if (key == "misalignment_mm")
    e.misalignment = v * 1e-3;
  else if (key == "temperature_range_K")
    e.temperature_range = v;
  else if (key == "temperature_difference_K")
    e.temperature_difference = v;
  else if (key == "expansion_range_um_per_m_K")
    e.expansion_range = v * 1e-6;
  else if (key == "drift_um")
    e.drift = v * 1e-6;
  else if (key == "drift_arcsec")
    e.drift_angle = v / arcsec_per_rad;
  else if (key == "expansion_um_per_m_K")
    axis.expansion = v * 1e-6;
  else if (key == "screw_pitch_mm")
    axis.screw_pitch = v * 1e-3;
  else if (key == "teeth")
    axis.teeth = static_cast<int>(v);
  else
    return "unknown key " + key;
  return {};
}

void put(Outcome& out, const std::string& name, double si, double unit) {
  out.values[name] = si * unit;
}

void evaluate_iso(const Case& c, const AxisTest& test, Outcome& out) {
  const auto edition = c.options.find("edition");
  const double k = edition != c.options.end() && edition->second == "1988" ? 3.0 : 2.0;
  const double um = deviation_unit(c);
  const Iso230Result r = evaluate_iso230_2(test, k);
  out.values["k"] = r.k;
  put(out, "A", r.A, um), put(out, "A+", r.A_plus, um), put(out, "A-", r.A_minus, um);
  put(out, "E", r.E, um), put(out, "E+", r.E_plus, um), put(out, "E-", r.E_minus, um);
  put(out, "R", r.R, um), put(out, "R+", r.R_plus, um), put(out, "R-", r.R_minus, um);
  put(out, "M", r.M, um), put(out, "B", r.B, um), put(out, "B_mean", r.B_mean, um);
  for (const auto& p : r.points) {
    const std::string at = "@" + evidence_text({"", p.target, position_of(c.rotary())});
    put(out, "mean+" + at, p.mean_plus, um), put(out, "mean-" + at, p.mean_minus, um);
    put(out, "mean" + at, p.mean, um), put(out, "B" + at, p.B, um);
    put(out, "s+" + at, p.s_plus, um), put(out, "s-" + at, p.s_minus, um);
    put(out, "R+" + at, p.R_plus, um), put(out, "R-" + at, p.R_minus, um);
    put(out, "R" + at, p.R, um);
    out.values["n+" + at] = static_cast<double>(p.n_plus);
    out.values["n-" + at] = static_cast<double>(p.n_minus);
  }
  auto of = uncertainty_budget(c.campaign, c.campaign.environment, "X", test);
  if (!of.budget) return;
  put(out, "U_DEV", of.budget->U_DEV, um), put(out, "U_MIS", of.budget->U_MIS, um);
  put(out, "U_M", of.budget->U_M, um), put(out, "U_E", of.budget->U_E, um);
  put(out, "U_EVE", of.budget->U_EVE, um);
  require_repetition(test, of.budget, "", out.findings);
  if (!of.budget) return;
  const auto U = iso230_2_uncertainty(*of.budget, approaches_per_mean(test), k);
  put(out, "U(A)", U.A, um), put(out, "U(A+)", U.A_plus, um), put(out, "U(A-)", U.A_minus, um);
  put(out, "U(E)", U.E, um), put(out, "U(E+)", U.E_plus, um), put(out, "U(E-)", U.E_minus, um);
  put(out, "U(R)", U.R, um), put(out, "U(R+)", U.R_plus, um), put(out, "U(R-)", U.R_minus, um);
  put(out, "U(M)", U.M, um), put(out, "U(B)", U.B, um), put(out, "U(B_mean)", U.B_mean, um);
}

void evaluate_vdi(const Case& c, const AxisTest& test, Outcome& out) {
  const double um = deviation_unit(c);
  const auto how = c.options.find("s");
  const VdiResult r = evaluate_vdi3441(test, how != c.options.end() && how->second == "from-range"
                                                 ? StandardDeviation::from_range
                                                 : StandardDeviation::direct);
  put(out, "P", r.P, um), put(out, "Pa", r.Pa, um), put(out, "PsU_max", r.PsU_max, um);
  put(out, "Ps_max", r.Ps_max, um), put(out, "Ps_mean", r.Ps_mean, um);
  put(out, "U_max", r.U_max, um), put(out, "U_mean", r.U_mean, um);
  put(out, "P+", r.P_plus, um), put(out, "P-", r.P_minus, um);
  put(out, "Pa+", r.Pa_plus, um), put(out, "Pa-", r.Pa_minus, um);
  put(out, "Ps_max+", r.Ps_max_plus, um), put(out, "Ps_max-", r.Ps_max_minus, um);
  for (const auto& p : r.points) {
    const std::string at = "@" + evidence_text({"", p.target, position_of(c.rotary())});
    put(out, "mean" + at, p.mean, um), put(out, "S" + at, p.S, um);
    put(out, "U" + at, p.U, um), put(out, "Ps" + at, p.Ps, um);
  }
  const auto of = uncertainty_budget(c.campaign, c.campaign.environment, "X", test);
  if (!of.budget) return;
  const auto U = vdi3441_uncertainty(*of.budget, approaches_per_mean(test));
  put(out, "U(P)", U.P, um), put(out, "U(Pa)", U.Pa, um), put(out, "U(Ps_max)", U.Ps_max, um);
  put(out, "U(Ps_mean)", U.Ps_mean, um), put(out, "U(U_max)", U.U_max, um);
  put(out, "U(U_mean)", U.U_mean, um);
}

void evaluate_positioning(const Case& c, const AxisTest& test, Outcome& out) {
  const double um = deviation_unit(c);
  const AxisStatistics axis = axis_statistics(test);
  Offset offset = Offset::mean_of_all;
  if (const auto it = c.options.find("offset"); it != c.options.end())
    offset = it->second == "first-target" ? Offset::first_target
             : it->second == "mid-range"  ? Offset::mid_range
                                          : Offset::mean_of_all;
  put(out, "offset", offset_of(axis, offset), um);
  const Slopes slopes = slopes_of(axis);
  const double slope_unit = unit_of(slope_of(c.rotary())).per_si;
  put(out, "slope", slopes.least_squares, slope_unit);
  put(out, "slope_ends", slopes.end_points, slope_unit);
  const auto of = uncertainty_budget(c.campaign, c.campaign.environment, "X", test);
  const std::size_t n = approaches_per_mean(test);
  if (of.budget) put(out, "U(slope)", slope_uncertainty(slope_budget(*of.budget), n), slope_unit);
  for (const PositioningRule& rule : positioning_rules())
    for (const RuleValue& v : evaluate_rule(rule, axis, offset)) {
      const std::string name = std::string(rule.name) + ":" + std::string(v.name);
      put(out, name, v.value, um);
      if (of.budget) put(out, "U(" + name + ")", rule_uncertainty(*of.budget, n, v.share), um);
    }
}

const char* kind_name(Reversal::Kind kind) {
  switch (kind) {
    case Reversal::Kind::unknown:
      return "unknown";
    case Reversal::Kind::none:
      return "none";
    case Reversal::Kind::lost_motion:
      return "lost-motion";
    case Reversal::Kind::over_compensated:
      return "over-compensated";
    case Reversal::Kind::not_constant:
      return "not-constant";
  }
  return "";
}

void evaluate_reversal(const Case& c, const AxisTest& test, Outcome& out) {
  const double um = deviation_unit(c);
  const Reversal r = assess_reversal(test);
  out.words["kind"] = kind_name(r.kind);
  out.words["opposed"] = r.opposed ? "yes" : "no";
  out.words["concordant"] = r.concordant ? "yes" : "no";
  put(out, "mean", r.mean, um), put(out, "u_mean", r.u_mean, um);
  put(out, "largest", r.largest, um), put(out, "largest_left", r.largest_left, um);
  put(out, "opposed_amplitude", r.opposed_amplitude, um);
  put(out, "concordant_amplitude", r.concordant_amplitude, um);
}

}  // namespace

Case begin_case(const std::vector<std::string>& operation) {
  Case c;
  if (operation.size() > 1) c.analysis = operation[1];
  for (std::size_t k = 2; k < operation.size(); ++k) {
    const auto equals = operation[k].find('=');
    c.options[operation[k].substr(0, equals)] =
        equals == std::string::npos ? "" : operation[k].substr(equals + 1);
  }
  Axis axis;
  axis.name = "X";
  axis.rotary = c.rotary();
  c.campaign.machine.axes.push_back(axis);
  c.observations.angular = c.rotary();
  c.observations.axes.push_back({"X", c.rotary(), {}, {}});
  return c;
}

std::string give(Case& c, const std::vector<std::string>& words) {
  if (c.analysis == "circle" && words.size() == 3) {
    const auto number = Expression::value(words[2]);
    if (!number) return "expected a number, found " + words[2];
    c.numbers[words[1]] = *number;
    return "";
  }
  if ((is_heat(c) || is_fine_motion(c)) && words.size() >= 3) {
    std::vector<double> list;
    for (std::size_t k = 2; k < words.size(); ++k) {
      const auto number = Expression::value(words[k]);
      if (!number) return "expected a number, found " + words[k];
      list.push_back(*number);
    }
    c.lists[words[1]].push_back(std::move(list));
    return "";
  }
  if (words.size() < 3) return "expected: given TARGET DIRECTION x x x, or: given KEY VALUE";
  if (const auto target = Expression::value(words[1])) return give_readings(c, words, *target);
  const auto value = Expression::value(words[2]);
  if (!value) return "expected a number, found " + words[2];
  return give_key(c, words[1], *value);
}

Outcome evaluate(const Case& c) {
  if (c.analysis == "circle") return evaluate_circle(c);
  if (is_heat(c)) return evaluate_heat(c);
  if (is_fine_motion(c)) return evaluate_fine_motion(c);
  Outcome out;
  const AxisTest all = AxisTest::arrange(c.observations);
  const bool leave_out = c.options.count("leave-out") > 0;
  const AxisTest test = choose_targets(all, leave_out, out.findings);
  if (c.analysis == "iso230-2") evaluate_iso(c, test, out);
  if (c.analysis == "vdi-dgq-3441") evaluate_vdi(c, test, out);
  if (c.analysis == "positioning") evaluate_positioning(c, test, out);
  if (c.analysis == "reversal") evaluate_reversal(c, test, out);
  if (c.analysis == "findings")
    for (auto& f : axis_findings(test, c.observations, &c.campaign.machine.axes[0]))
      out.findings.push_back(std::move(f));
  return out;
}
