// SPDX-License-Identifier: Apache-2.0
// Center, direction and radius of a rotary axis from the centers of a ball that rotates with it.
#include "nonio/sdk/plugin.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "judge.h"
#include "nonio/math/budget.h"
#include "nonio/math/probed.h"

namespace nonio::rotary_kinematics {
namespace {

/// Derivatives of the fitted values with respect to the coordinates: x of every center, then y,
/// then z.
struct Derivatives {
  using Row = std::vector<double>;
  std::array<Row, 3> centre, direction;
  Row radius;
  std::vector<Row> radial, axial;  ///< for each center; empty above 500 centers
};

constexpr std::size_t most_residuals = 500;  // the derivatives grow with its square

Derivatives derivatives_of(const Judged& judged, bool use_angles) {
  constexpr double step = 1e-5;  // m: far above rounding, far below the radius
  const std::size_t n = judged.centres.size();
  Derivatives d;
  for (auto* rows : {&d.centre, &d.direction})
    for (auto& row : *rows) row.assign(3 * n, 0.0);
  d.radius.assign(3 * n, 0.0);
  if (n <= most_residuals) d.radial.assign(n, Derivatives::Row(3 * n, 0.0));
  d.axial = d.radial;
  auto centres = judged.centres;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t at = k * n + i;
      for (const double sign : {1.0, -1.0}) {
        centres[i].at[k] = judged.centres[i].at[k] + sign * step;
        const auto fit = math::fit_rotary(centres, use_angles);
        if (!fit) continue;
        const double by = sign / (2.0 * step);
        for (std::size_t c = 0; c < 3; ++c) {
          d.centre[c][at] += by * fit->centre[c];
          d.direction[c][at] += by * fit->direction[c];
        }
        d.radius[at] += by * fit->radius;
        for (std::size_t p = 0; p < d.radial.size(); ++p) {
          d.radial[p][at] += by * fit->radial[p];
          d.axial[p][at] += by * fit->axial[p];
        }
      }
      centres[i].at[k] = judged.centres[i].at[k];
    }
  return d;
}

/// Error model of the coordinates of one circle, or of several circles in one frame; its lines are
/// x, y and z. linear_axes: bound of squareness and scale difference, rad; absent if not stated.
math::ReadingModel coordinate_model(const Campaign& c, const Environment& e,
                                    const std::vector<const Judged*>& circles,
                                    std::optional<double> linear_axes) {
  math::ProbedPlaces places;
  places.linear_axes = linear_axes;
  places.linear_axes_key = "options.rotary-kinematics.linear_axes_urad";
  for (const Judged* j : circles) {
    for (const math::BallCentre& centre : j->centres) places.at.push_back(centre.at);
    for (std::size_t k = 0; k < 3; ++k)
      places.middle[k] += j->fit.centre[k] / static_cast<double>(circles.size());
    places.radius = std::max(places.radius, j->fit.radius);
  }
  return math::probed_model(c, e, places);
}

Derivatives::Row chain(const Derivatives& d, const std::array<double, 6>& by_line) {
  Derivatives::Row out(d.radius.size(), 0.0);
  for (std::size_t i = 0; i < out.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      out[i] += by_line[k] * d.centre[k][i] + by_line[3 + k] * d.direction[k][i];
  return out;
}

using math::RotaryFit;

constexpr double per_um = 1e-6, per_urad = 1e-6;

bool applies(const Campaign&, const Measurement& m) { return m.kind == "ball-centres"; }

/// Largest extent of the readings along one coordinate, m, for the length-dependent U of the
/// instrument.
double extent(const Observations& o) {
  double size = 0.0;
  for (std::size_t k = 1; k < o.axes.size(); ++k) {
    if (o.axes[k].rotary) continue;
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

struct Work {
  const AnalysisInput& in;
  Wish wish;
  math::HeldLimits limits;
  Judged own;
  Derivatives by;
  math::ReadingModel model;
  math::BudgetOf budget;
  Evaluation out;
};

std::string source_of(const Wish& wish, const Judged& j) {
  if (std::isfinite(j.dof) || j.sigma_of_centres) return "readings";
  return wish.sigma ? "options.rotary-kinematics.sigma_um" : "instrument.U_fixed_um";
}

/// Above this direction component, a center coordinate depends on the position of the ball.
constexpr double along_the_axis = 0.7;

void add_values(Work& w) {
  const RotaryFit& fit = w.own.fit;
  const auto value = [&](std::string name, double v, Quantity q, double u,
                         const std::vector<double>& by) {
    w.out.values.push_back(w.budget.value(std::move(name), v, q, u, w.model.shares(by)));
  };
  const auto follow = [&] {
    Value& last = w.out.values.back();
    last.followed = {last.name, w.in.measurement.axis};
  };
  for (std::size_t i = 0; i < 3; ++i) {
    value(std::string("centre_") + "xyz"[i], fit.centre[i], Quantity::length, w.own.u_centre(i),
          w.by.centre[i]);
    if (std::fabs(fit.direction[i]) <= along_the_axis) follow();
  }
  value("radius", fit.radius, Quantity::length, w.own.u_radius(), w.by.radius);
  for (std::size_t i = 0; i < 3; ++i) {
    value(std::string("direction_") + "ijk"[i], fit.direction[i], Quantity::number,
          w.own.u_direction(i), w.by.direction[i]);
    follow();
  }
  if (fit.dof == 0) return;
  // s and the run-outs include drift and form errors, which the U of the values does not contain.
  w.out.values.push_back({"s", fit.s, Quantity::deviation});
  w.out.values.push_back({"run_out_radial", range(fit.radial), Quantity::deviation});
  w.out.values.push_back({"run_out_axial", range(fit.axial), Quantity::deviation});
}

double repetition_in(const Judged& j, const std::vector<double>& by) {
  const std::size_t n = j.centres.size();
  double sum = 0.0;
  for (std::size_t i = 0; i < by.size(); ++i) sum += by[i] * by[i] / j.centres[i % n].weight;
  return j.sigma * std::sqrt(sum);
}

void add_curve(Work& w, const char* name, const std::vector<double>& angle,
               const std::vector<double>& value, const std::vector<Derivatives::Row>& by) {
  Series s{name, w.in.measurement.axis, Quantity::angle, Quantity::deviation, angle, value, {}};
  std::vector<double> u;
  std::vector<math::Shares> shares;
  for (const auto& row : by) {
    u.push_back(repetition_in(w.own, row));
    shares.push_back(w.model.shares(row));
  }
  if (w.own.fit.dof > 0 && !u.empty()) w.budget.put(s, u, shares);
  w.out.series.push_back(std::move(s));
}

void add_curves(Work& w) {
  const RotaryFit& fit = w.own.fit;
  std::vector<double> angle, x, y, z, n;
  for (const math::BallCentre& c : w.own.centres) {
    angle.push_back(c.angle);
    x.push_back(c.at[0]), y.push_back(c.at[1]), z.push_back(c.at[2]);
    n.push_back(c.weight);
  }
  w.out.points.columns = {{"target", Quantity::angle, angle},
                          {"x", Quantity::length, std::move(x)},
                          {"y", Quantity::length, std::move(y)},
                          {"z", Quantity::length, std::move(z)},
                          {"radial", Quantity::deviation, fit.radial},
                          {"axial", Quantity::deviation, fit.axial},
                          {"tangential", Quantity::deviation, fit.tangential},
                          {"n", Quantity::count, std::move(n)}};
  add_curve(w, "radial", angle, fit.radial, w.by.radial);
  add_curve(w, "axial", angle, fit.axial, w.by.axial);
}

std::vector<double> joined(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> out;
  const auto n = static_cast<std::ptrdiff_t>(a.size() / 3),
             m = static_cast<std::ptrdiff_t>(b.size() / 3);
  for (std::ptrdiff_t k = 0; k < 3; ++k) {
    out.insert(out.end(), a.begin() + k * n, a.begin() + (k + 1) * n);
    out.insert(out.end(), b.begin() + k * m, b.begin() + (k + 1) * m);
  }
  return out;
}

double joined_dof(double u_a, double dof_a, double u_b, double dof_b) {
  const double fourth = std::pow(u_a, 4) / dof_a + std::pow(u_b, 4) / dof_b;
  return fourth > 0.0 ? std::pow(std::hypot(u_a, u_b), 4) / fourth : INFINITY;
}

void add_relation(Work& w, const std::string& id, const Judged& j) {
  const auto r = math::relation_of(j.fit, j.sigma, w.own.fit, w.own.sigma);
  const auto a = math::relation_of(j.fit, j.sigma, w.own.fit, 0.0),
             b = math::relation_of(j.fit, 0.0, w.own.fit, w.own.sigma);
  const auto by = derivatives_of(j, w.wish.use_angles);
  // Both circles are in one frame, so a common error of the instrument cancels in the distance.
  const auto model =
      coordinate_model(w.in.campaign, w.limits.environment, {&j, &w.own}, w.wish.linear_axes);
  auto distance = model.shares(joined(chain(by, r.distance_by_a), chain(w.by, r.distance_by_b)));
  auto angle = model.shares(joined(chain(by, r.angle_by_a), chain(w.by, r.angle_by_b)));
  distance.dof = joined_dof(a.u_distance, j.dof, b.u_distance, w.own.dof);
  angle.dof = joined_dof(a.u_angle, j.dof, b.u_angle, w.own.dof);
  w.out.values.push_back(
      w.budget.value("distance_" + id, r.distance, Quantity::length, r.u_distance, distance));
  w.out.values.push_back(w.budget.value("angle_" + id, r.angle, Quantity::angle, r.u_angle, angle));
}

/// Compares with earlier rotary axes of the manifest if `same_reference` states a common reference
/// point.
void add_relations(Work& w) {
  const AnalysisInput& in = w.in;
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
    if (!math::other_turning_axis((*in.all)[i]).empty()) continue;
    if (!shares(other.id) || !shares(in.measurement.id)) {
      w.out.findings.push_back({.id = "rotary.reference-unknown",
                                .texts = {{"one", other.id}, {"other", in.measurement.id}}});
      continue;
    }
    const Judged j = judge((*in.all)[i], wish_of(in.campaign, (*in.all)[i], in.options));
    if (!j.given) continue;
    add_relation(w, other.id, j);
    w.out.uses.push_back(other.id);
    w.out.notes.push_back({"rotary.chain", {}, {{"one", other.id}, {"other", in.measurement.id}}});
  }
}

std::vector<const Observations*> observations_of(const AnalysisInput& in) {
  std::vector<const Observations*> out{&in.observations};
  for (std::size_t i = 0; in.all != nullptr && i < in.all->size(); ++i)
    if (in.campaign.measurements[i].kind == in.measurement.kind) out.push_back(&(*in.all)[i]);
  return out;
}

void show_residuals(math::ReadingModel& model, const Judged& j, const Derivatives& by) {
  const bool alike = std::all_of(j.centres.begin(), j.centres.end(),
                                 [&](const auto& c) { return c.weight == j.centres[0].weight; });
  if (!alike || j.fit.dof == 0 || by.radial.empty() || !std::isfinite(j.dof)) return;
  auto rows = by.radial;
  rows.insert(rows.end(), by.axial.begin(), by.axial.end());
  model.see_residuals(rows, j.fit.dof);
}

/// If another axis moved too, the centers are not on a circle.
Evaluation of_two_axes(const Measurement& m, const std::string& other) {
  Evaluation out;
  out.findings.push_back(
      {.id = "rotary.other-axis-turned", .texts = {{"axis", m.axis}, {"other", other}}});
  return out;
}

Evaluation without_U(Judged judged) {
  Evaluation e;
  e.findings = std::move(judged.findings);
  for (std::size_t i = 0; i < 3; ++i)
    e.values.push_back({std::string("centre_") + "xyz"[i], judged.fit.centre[i], Quantity::length});
  e.values.push_back({"radius", judged.fit.radius, Quantity::length});
  for (std::size_t i = 0; i < 3; ++i)
    e.values.push_back(
        {std::string("direction_") + "ijk"[i], judged.fit.direction[i], Quantity::number});
  return e;
}

Expected<Evaluation> analyse(const AnalysisInput& in) {
  if (const std::string other = math::other_turning_axis(in.observations); !other.empty())
    return of_two_axes(in.measurement, other);
  const Wish wish = wish_of(in.campaign, in.observations, in.options);
  Judged judged = judge(in.observations, wish);
  if (!judged.given) {
    Evaluation refused;
    refused.findings = std::move(judged.findings);
    return refused;
  }
  if (!judged.U_known) return without_U(std::move(judged));
  math::HeldLimits limits = math::limits_held(in.campaign, observations_of(in));
  math::ReadingModel model =
      coordinate_model(in.campaign, limits.environment, {&judged}, wish.linear_axes);
  Derivatives by = derivatives_of(judged, wish.use_angles);
  show_residuals(model, judged, by);
  math::BudgetOf budget(model, judged.sigma, judged.dof, Quantity::deviation,
                        source_of(wish, judged));
  Work w{in,
         wish,
         std::move(limits),
         std::move(judged),
         std::move(by),
         std::move(model),
         std::move(budget),
         {}};
  w.out.findings = std::move(w.own.findings);
  w.out.findings.insert(w.out.findings.end(), w.limits.findings.begin(), w.limits.findings.end());
  if (!w.model.missing.empty()) w.out.findings.push_back(math::missing_finding(w.model.missing));
  add_values(w);
  add_curves(w);
  add_relations(w);
  if (w.model.missing.empty()) w.out.budget = w.budget.budget();
  w.out.notes.push_back({w.own.k > 2.0 ? "method.rotary-residuals" : "method.rotary-sigma",
                         {{"sigma", w.own.sigma, Quantity::deviation},
                          {"k", w.own.k, Quantity::ratio},
                          {"dof", static_cast<double>(w.own.fit.dof), Quantity::count}}});
  if (w.own.fit.dof > 0) w.out.notes.push_back({"rotary.as-read"});
  return std::move(w.out);
}

std::vector<Option> options() {
  return {
      within(0.0, 1e4,
             {"sigma_um", 0.0, "um",
              "Standard uncertainty of one coordinate; 0: from the residuals."}),
      {"use_angles", false, "", "Trust the angles of the encoder: better on arcs."},
      within(1e-3, 1e6,
             {"tolerance_um", 50.0, "um",
              "Wanted U of the centre; an arc that misses it is refused."}),
      within(1e-3, 1e6, {"tolerance_urad", 100.0, "urad", "Wanted U of the direction."}),
      within(0.0, 1e4,
             {"linear_axes_urad", 0.0, "urad",
              "Bound of squareness and scale difference of the linear axes; 0: not known."}),
      within(1.0, 1e6,
             {"circle_limit", 10.0, "", "Residuals beyond this many sigma are not a circle."}),
      {"same_reference", std::vector<std::string>{}, "",
       "Measurements whose centres have one reference point, so that their axes may be compared."}};
}

}  // namespace

NONIO_PLUGIN(registry) {
  Analysis a;
  a.info = {"rotary-kinematics", "1.0.0",
            "Centre, direction and radius of a rotary axis from ball centres.", options()};
  a.applies = applies;
  a.analyse = analyse;
  a.states_followed = true;
  registry.add(std::move(a));
}

}  // namespace nonio::rotary_kinematics
