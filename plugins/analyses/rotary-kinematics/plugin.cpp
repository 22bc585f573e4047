// SPDX-License-Identifier: Apache-2.0
//
// Centre, direction and radius of a rotary axis from the centres of a ball that turns with it.
#include "nonio/sdk/plugin.h"

#include <algorithm>
#include <cmath>

#include "judge.h"

namespace nonio {
namespace {

using math::RotaryFit;
using rotary::Judged;
using rotary::Wish;

constexpr double per_um = 1e-6, per_urad = 1e-6;

bool applies(const Campaign&, const Measurement& m) { return m.kind == "ball-centres"; }

/// The extent of the readings in one coordinate at most, for the instrument's part with the length.
double extent(const Observations& o) {
  double size = 0.0;
  for (std::size_t k = 1; k < o.axes.size(); ++k) {
    const auto [low, high] =
        std::minmax_element(o.axes[k].position.begin(), o.axes[k].position.end());
    if (low != high) size = std::max(size, *high - *low);
  }
  return size;
}

Wish wish_of(const Campaign& campaign, const Observations& o, const Settings& options) {
  Wish wish;
  wish.use_angles = options.flag("use_angles");
  if (const double s = options.number("sigma_um"); s > 0.0) wish.sigma = s * per_um;
  if (const double c = options.number("linear_axes_urad"); c > 0.0) wish.linear_axes = c * per_urad;
  if (const Instrument& i = campaign.instrument; i.U_fixed)
    wish.U_instrument = *i.U_fixed + i.U_per_length.value_or(0.0) * extent(o);
  wish.tolerance = options.number("tolerance_um") * per_um;
  wish.tolerance_direction = options.number("tolerance_urad") * per_urad;
  wish.circle_limit = options.number("circle_limit");
  return wish;
}

double range(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

void add_values(Evaluation& e, const Judged& j) {
  const RotaryFit& fit = j.fit;
  for (std::size_t i = 0; i < 3; ++i)
    e.values.push_back(
        {std::string("centre_") + "xyz"[i], fit.centre[i], Quantity::length, j.U_centre(i)});
  e.values.push_back({"radius", fit.radius, Quantity::length, j.U_radius()});
  for (std::size_t i = 0; i < 3; ++i)
    e.values.push_back({std::string("direction_") + "ijk"[i], fit.direction[i], Quantity::number,
                        j.U_direction(i)});
  if (fit.dof == 0) return;
  e.values.push_back({"s", fit.s, Quantity::deviation});
  e.values.push_back({"run_out_radial", range(fit.radial), Quantity::deviation});
  e.values.push_back({"run_out_axial", range(fit.axial), Quantity::deviation});
}

void add_curves(Evaluation& e, const Judged& j, const std::string& axis) {
  const RotaryFit& fit = j.fit;
  std::vector<double> angle, x, y, z, n;
  for (const math::BallCentre& c : j.centres) {
    angle.push_back(c.angle);
    x.push_back(c.at[0]), y.push_back(c.at[1]), z.push_back(c.at[2]);
    n.push_back(c.weight);
  }
  e.points.columns = {{"target", Quantity::angle, angle},
                      {"x", Quantity::length, std::move(x)},
                      {"y", Quantity::length, std::move(y)},
                      {"z", Quantity::length, std::move(z)},
                      {"radial", Quantity::deviation, fit.radial},
                      {"axial", Quantity::deviation, fit.axial},
                      {"tangential", Quantity::deviation, fit.tangential},
                      {"n", Quantity::count, std::move(n)}};
  for (const auto& [name, values] : {std::pair("radial", &fit.radial), {"axial", &fit.axial}})
    e.series.push_back({name, axis, Quantity::angle, Quantity::deviation, angle, *values, {}});
}

/// Against the axes that stand before this one in the manifest: only where the user says that their
/// centres have one reference point.
void add_relations(Evaluation& e, const Judged& own, const AnalysisInput& in) {
  if (in.all == nullptr) return;
  const auto& measurements = in.campaign.measurements;
  const std::vector<std::string> same = in.options.texts("same_reference");
  const auto shares = [&](const std::string& id) {
    return std::find(same.begin(), same.end(), id) != same.end();
  };
  for (std::size_t i = 0; i < std::min(measurements.size(), in.all->size()); ++i) {
    const Measurement& other = measurements[i];
    if (other.id == in.measurement.id) break;
    if (other.kind != in.measurement.kind || (*in.all)[i].size() == 0) continue;
    if (!shares(other.id) || !shares(in.measurement.id)) {
      e.findings.push_back({.id = "rotary.reference-unknown",
                            .texts = {{"one", other.id}, {"other", in.measurement.id}}});
      continue;
    }
    const Judged j = judge((*in.all)[i], wish_of(in.campaign, (*in.all)[i], in.options));
    if (!j.given) continue;  // its own findings say why
    // Each expanded by its own factor: U is then twice the combined uncertainty.
    const auto r = math::relation_of(j.fit, 0.5 * j.k * j.sigma, own.fit, 0.5 * own.k * own.sigma);
    e.values.push_back({"distance_" + other.id, r.distance, Quantity::length,
                        std::hypot(2.0 * r.u_distance, j.U_shear, own.U_shear)});
    e.values.push_back({"angle_" + other.id, r.angle, Quantity::angle, 2.0 * r.u_angle});
    e.uses.push_back(other.id);
    e.notes.push_back({"rotary.chain", {}, {{"one", other.id}, {"other", in.measurement.id}}});
  }
}

Expected<Evaluation> analyse(const AnalysisInput& in) {
  Judged judged = judge(in.observations, wish_of(in.campaign, in.observations, in.options));
  Evaluation e;
  e.findings = std::move(judged.findings);
  if (!judged.given) return e;
  add_values(e, judged);
  add_curves(e, judged, in.measurement.axis);
  add_relations(e, judged, in);
  e.notes.push_back({judged.k > 2.0 ? "method.rotary-residuals" : "method.rotary-sigma",
                     {{"sigma", judged.sigma, Quantity::deviation},
                      {"k", judged.k, Quantity::ratio},
                      {"dof", static_cast<double>(judged.fit.dof), Quantity::count}}});
  return e;
}

std::vector<Option> options() {
  return {
      {"sigma_um",
       0.0,
       "um",
       "Standard uncertainty of one coordinate; 0: from the residuals.",
       {},
       0.0,
       1e4},
      {"use_angles", false, "", "Trust the angles of the encoder: better on arcs."},
      {"tolerance_um",
       50.0,
       "um",
       "Wanted U of the centre; an arc that misses it is refused.",
       {},
       1e-3,
       1e6},
      {"tolerance_urad", 100.0, "urad", "Wanted U of the direction.", {}, 1e-3, 1e6},
      {"linear_axes_urad",
       0.0,
       "urad",
       "Bound of squareness and scale difference of the linear axes; 0: not known.",
       {},
       0.0,
       1e4},
      {"circle_limit",
       10.0,
       "",
       "Residuals beyond this many sigma are not a circle.",
       {},
       1.0,
       1e6},
      {"same_reference", std::vector<std::string>{}, "",
       "Measurements whose centres have one reference point, so that their axes may be compared."}};
}

}  // namespace
}  // namespace nonio

NONIO_PLUGIN(registry) {
  nonio::Analysis a;
  a.info = {"rotary-kinematics", "1.0.0",
            "Centre, direction and radius of a rotary axis from ball centres.", nonio::options()};
  a.applies = nonio::applies;
  a.analyse = nonio::analyse;
  registry.add(std::move(a));
}
