// SPDX-License-Identifier: Apache-2.0
//
// Diagonals and step diagonals of a machine of exact transforms.
#include <cmath>

#include "bench.h"
#include "coverage.h"
#include "workshop.h"

namespace nonio::coverage {
namespace {

constexpr int runs = 3;

/// A campaign while it is measured, line after line.
struct Measured {
  Campaign campaign;
  std::vector<Observations> all;

  void add(Day& day, Measurement m, const std::vector<Observations::AxisColumn>& places,
           std::array<double, 3> sense, const Line& line) {
    Observations o;
    o.measurement = m.id;
    o.lines.push_back({m.id, sense});
    o.axes = places;
    for (auto& a : o.axes) a.position.clear();
    const auto visits = there_and_back(line.mean.size(), runs);
    for (const Visit& v : visits) {
      for (std::size_t k = 0; k < places.size(); ++k) {
        const auto& at = places[k].position;
        const int rises = at.back() > at.front() ? 1 : -1;
        o.axes[k].position.push_back(at[v.stop]);
        o.axes[k].approach.push_back(static_cast<std::int8_t>(rises * v.direction));
      }
      o.run.push_back(v.run);
    }
    for (const Reading& r : day.measured(line, visits)) o.deviation.push_back(r.seen);
    campaign.measurements.push_back(std::move(m));
    all.push_back(std::move(o));
  }
};

Line of(std::vector<double> distance, std::vector<double> mean) {
  return {std::move(distance), std::move(mean), 0.0};
}

/// True curves of a rectangle by the names of the results.
class Curves {
 public:
  Curves(const ::bench::Errors& e, const ::bench::Rectangle& r) : e_(e), r_(r) {
    for (std::size_t i = 0; i <= r.n; ++i) {
      f_.push_back(e.EYX(r.x(i)));
      g_.push_back(e.EXY(r.y(i)));
      yaw_.push_back(e.ECX(r.x(i)) - e.ECX(r.x(0)));
    }
  }

  std::vector<double> of(const std::string& name) const {
    if (name == "EYX") return f_;
    if (name == "EXY") return g_;
    if (name == "ECX") return yaw_;
    if (name == "EYX_LSQ") return steps::levelled(f_);
    if (name == "EXY_LSQ") return steps::levelled(g_);
    std::vector<double> out;
    for (std::size_t i = 0; i <= r_.n; ++i) {
      const std::size_t j = r_.n - i;
      out.push_back(name == "EYX_even"   ? (f_[i] + f_[j]) / 2.0
                    : name == "EXY_even" ? (g_[i] + g_[j]) / 2.0
                    : name == "q_odd" ? (r_.Ly * (f_[i] - f_[j]) + r_.Lx * (g_[i] - g_[j])) / 2.0 /
                                            std::hypot(r_.Lx, r_.Ly)
                                      : NAN);
    }
    return out;
  }

  double squareness_lsq() const {
    return e_.C0Y - steps::slope_of(f_) * static_cast<double>(r_.n) / r_.Lx -
           steps::slope_of(g_) * static_cast<double>(r_.n) / r_.Ly;
  }

 private:
  const ::bench::Errors& e_;
  const ::bench::Rectangle& r_;
  std::vector<double> f_, g_, yaw_;
};

std::vector<double> along(const std::vector<Observations::AxisColumn>& places) {
  std::vector<double> out;
  for (std::size_t j = 0; j < places[0].position.size(); ++j)
    out.push_back(std::hypot(places[0].position[j] - places[0].position[0],
                             places[1].position[j] - places[1].position[0]));
  return out;
}

void diagonals(const Scenario& s, unsigned seed, double size, Tally& tally, bool third) {
  static const Analysis analysis = loaded_analysis(NONIO_ANALYSES, "diagonal-straightness");
  const ::bench::Rectangle rect{s.size, s.size * 2.0 / 3.0, 8};
  std::mt19937 rng(20261122);  // the machine is the same in all campaigns
  const ::bench::Errors errors = ::bench::random_gantry(rng, rect, 3 * um * s.size);
  Day day(s, seed, size);
  Measured c{stated(s), {}};
  std::vector<double> xs, ys;
  for (std::size_t i = 0; i <= rect.n; ++i) xs.push_back(rect.x(i)), ys.push_back(rect.y(i));
  for (const double part : {0.1, 0.9}) {
    Measurement m = named(part < 0.5 ? "X1" : "X2", "axis", "X");
    const double y = part * rect.Ly;
    m.at["Y"] = y;
    c.add(day, m, {{"X", false, xs, {}}}, {1, 0, 0}, of(xs, pitch_x(errors, rect, y).mean));
  }
  c.add(day, named("Y", "axis", "Y"), {{"Y", false, ys, {}}}, {0, 1, 0},
        of(ys, pitch_y(errors, rect).mean));
  std::vector<std::pair<std::string, ::bench::GridLine>> lines{
      {"D1", line(errors, rect, ::bench::count(rect.n), ::bench::count(rect.n))},
      {"D2", line(errors, rect, ::bench::count(rect.n), ::bench::down(rect.n))}};
  if (third) lines.emplace_back("D3", half_diagonal(errors, rect));
  for (const auto& [id, l] : lines) {
    std::vector<Observations::AxisColumn> places{{"X", false, {}, {}}, {"Y", false, {}, {}}};
    for (const std::size_t i : l.ix) places[0].position.push_back(rect.x(i));
    for (const std::size_t i : l.iy) places[1].position.push_back(rect.y(i));
    Measurement m = named(id, "diagonal", {});
    m.from = {{"X", places[0].position.front()}, {"Y", places[1].position.front()}};
    m.to = {{"X", places[0].position.back()}, {"Y", places[1].position.back()}};
    c.add(day, m, places, {l.cx, l.cy, 0}, of(along(places), l.mean));
  }
  const Evaluation e = evaluated(analysis, c.campaign, 3, c.all, defaults(analysis));
  const Curves truth(errors, rect);
  const double apart = 0.8 * rect.Ly;
  for (const Value& v : e.values) {
    if (!v.U) continue;
    if (v.name == "C0Y") tally.put(v.name, v.value - errors.C0Y, *v.U);
    if (v.name == "C0Y_LSQ") tally.put(v.name, v.value - truth.squareness_lsq(), *v.U);
    if (v.name == "slave_shift") tally.put(v.name, v.value - apart * errors.C0Y, *v.U);
  }
  for (const Series& curve : e.series) {
    const auto exact = truth.of(curve.name);
    for (std::size_t i = 0; i < curve.U.size(); ++i)
      if (curve.U[i] > 0.0 && std::isfinite(exact[i]))
        tally.put(curve.name, curve.value[i] - exact[i], curve.U[i]);
  }
}

void two_lines(const Scenario& s, unsigned seed, double size, Tally& t) {
  diagonals(s, seed, size, t, false);
}
void third_diagonal(const Scenario& s, unsigned seed, double size, Tally& t) {
  diagonals(s, seed, size, t, true);
}

Observations passes(Day& day, const steps::Volume& volume, const steps::StepDiagonals& exact) {
  static const char* const names[] = {"PPP", "NPP", "PNP", "PPN"};
  Observations o;
  o.measurement = "SD";
  o.axes = {{"X", false, {}, {}}, {"Y", false, {}, {}}, {"Z", false, {}, {}}};
  for (std::size_t p = 0; p < 4; ++p) {
    const auto& pass = exact.passes[p];
    const auto places = steps::stops(exact, pass);
    steps::Vector u = volume.travel.normalized();
    for (Eigen::Index k = 0; k < 3; ++k) u[k] *= pass.sign[static_cast<std::size_t>(k)];
    o.lines.push_back({names[p], {u[0], u[1], u[2]}});
    Line line{{0.0}, {0.0}, 0.0};
    for (std::size_t i = 1; i < places.size(); ++i) {
      line.distance.push_back((places[i] - places[0]).dot(u));
      line.mean.push_back(pass.reading[i - 1]);
    }
    auto visits = once(places.size());
    visits.erase(visits.begin());  // the display is preset there
    const auto readings = day.measured(line, visits);
    for (std::size_t i = 1; i < places.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k)
        o.axes[k].position.push_back(places[i][static_cast<Eigen::Index>(k)]);
      o.deviation.push_back(readings[i - 1].seen);
      o.line.push_back(static_cast<std::uint32_t>(p));
      o.run.push_back(1);
    }
  }
  return o;
}

/// Yaw and pitch of each axis, a mixture of a line and a parabola over its travel.
void turn_axes(machine::Errors& e, Day& day, const steps::Volume& v, double bound) {
  e.y_ref = v.travel.y() / 2.0;
  e.z_ref = v.travel.z() / 2.0;
  for (const char* name : {"EBX", "ECX", "EAY", "ECY", "EAZ", "EBZ"}) {
    const double size = day.uniform(bound), mixture = day.uniform(std::numbers::pi),
                 travel = v.travel[name[2] - 'X'];
    e[name] = [=](double p) {
      const double t = 2.0 * p / travel - 1.0;
      return size * (std::cos(mixture) * t + std::sin(mixture) * (2.0 * t * t - 1.0));
    };
  }
}

void step_diagonals(const Scenario& s, unsigned seed, double size, Tally& tally, bool averaging,
                    double angle = 0.0) {
  static const Analysis analysis = loaded_analysis(NONIO_ANALYSES, "step-diagonal");
  const steps::Volume volume{{s.size, 0.75 * s.size, 0.75 * s.size}, 7};
  std::mt19937 rng(20261122);
  Day day(s, seed, size);
  machine::Errors errors = steps::random_errors(rng, volume, 3 * um * s.size);
  if (angle > 0.0) turn_axes(errors, day, volume, angle);
  const steps::StepDiagonals exact = steps::measured(errors, volume);
  Settings settings = defaults(analysis);
  if (averaging) {
    settings.values["method"] = std::string("averaging");
    settings.values["set_up_square"] = true;
  }
  settings.values["angle_urad"] = angle / urad;
  Measured c{stated(s), {}};
  Measurement m = named("SD", "step-diagonal", {});
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string axis(1, "XYZ"[k]);
    m.from[axis] = 0.0;
    m.to[axis] = volume.travel[static_cast<Eigen::Index>(k)];
  }
  c.campaign.measurements.push_back(m);
  c.all.push_back(passes(day, volume, exact));
  if (!averaging)
    for (const auto& length : steps::lengths(errors, volume, "XYZ")) {
      const std::string axis(1, "XYZ"[length.axis]);
      std::array<double, 3> sense{};
      sense[length.axis] = 1.0;
      c.add(day, named(axis, "axis", axis), {{axis, false, length.position, {}}}, sense,
            of(length.position, length.deviation));
    }
  const Evaluation e = evaluated(analysis, c.campaign, 0, c.all, settings);
  const auto square = steps::true_squareness(errors, volume);
  for (const Value& v : e.values)
    for (std::size_t k = 0; k < 3; ++k)
      if (v.U && v.name == std::array{"C0Y", "B0Z", "A0Z"}[k])
        tally.put("squareness", v.value - square[k], *v.U);
  for (const Series& found : e.series) {
    if (found.U.empty() || found.name.size() != 3) continue;
    math::StepCurve curve;
    curve.name = found.name;
    curve.axis = static_cast<std::size_t>(found.name[2] - 'X');
    const auto truth = steps::truth(errors, volume, curve);
    const bool positioning = found.name[1] == found.name[2];
    for (std::size_t i = positioning ? 1 : 0; i < found.value.size(); ++i)
      tally.put(positioning ? "positioning" : "straightness", found.value[i] - truth[i],
                found.U[i]);
  }
}

void least_squares(const Scenario& s, unsigned seed, double size, Tally& t) {
  step_diagonals(s, seed, size, t, false);
}
void averaging(const Scenario& s, unsigned seed, double size, Tally& t) {
  step_diagonals(s, seed, size, t, true);
}
void with_angles(const Scenario& s, unsigned seed, double size, Tally& t) {
  step_diagonals(s, seed, size, t, false, 10.0 * urad);
}
void averaging_with_angles(const Scenario& s, unsigned seed, double size, Tally& t) {
  step_diagonals(s, seed, size, t, true, 10.0 * urad);
}

}  // namespace

const std::vector<Method> line_methods{
    {"diagonals, two lines of X", two_lines},
    {"diagonals, third diagonal", third_diagonal},
    {"step diagonals, least squares", least_squares, 4},
    {"step diagonals, averaging", averaging},
    {"step diagonals, least squares, yaw and pitch", with_angles, 4},
    {"step diagonals, averaging, yaw and pitch", averaging_with_angles}};

}  // namespace nonio::coverage
