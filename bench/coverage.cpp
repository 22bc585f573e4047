// SPDX-License-Identifier: Apache-2.0
//
// How often U covers the truth: campaigns whose readings have errors drawn from the distributions
// that their manifest states (JCGM 101: propagation of distributions), evaluated by the plugins as
// they were built. The errors are drawn here as they come about, one line after the other; nothing
// of engine/math/budget.h is used.
//
//     nonio_coverage [--trials N] [--seed S] [--check]
//
// Prints the share of values within U of the truth; --check: status 1 if one is outside its limits.
#include <dlfcn.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <stdexcept>

#include "bench.h"
#include "nonio/math/iso230_2.h"
#include "nonio/math/uncertainty.h"
#include "nonio/math/vdi3441.h"
#include "nonio/sdk/plugin.h"
#include "table.h"
#include "workshop.h"

namespace nonio {
namespace {

constexpr double um = 1e-6, urad = 1e-6;

Analysis load(const char* path) {
  struct Taker final : Registry {
    Analysis analysis;
    void add(Reader) override {}
    void add(Effect) override {}
    void add(Analysis a) override { analysis = std::move(a); }
    void add(Output) override {}
  } taker;
  void* library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw std::runtime_error(dlerror());
  static_cast<const PluginEntry*>(dlsym(library, "nonio_plugin"))->add_to(taker);
  return taker.analysis;
}

/// What the manifests state: the sizes are such that no contribution hides the others.
Campaign stated() {
  Campaign c;
  c.machine.structure = "gantry";
  for (const char* name : {"X", "Y", "Z"}) {
    c.machine.axes.push_back(Axis{.name = name});
    c.machine.axes.back().expansion = 11.5e-6;
  }
  c.instrument.U_fixed = 1.0 * um;
  c.instrument.U_per_length = 0.6 * um;
  c.instrument.sphere = 1.5 * um;
  c.instrument.probe = 1.5 * um;
  c.environment.misalignment = 1e-3;
  c.environment.temperature_range = 0.1;
  c.environment.temperature_difference = 0.8;
  c.environment.expansion_range = 1.0 * um;
  c.environment.drift = 0.8 * um;
  return c;
}

/// Errors of the readings of one campaign.
class World {
 public:
  World(const Campaign& c, unsigned seed) : c_(c), rng_(seed) {
    scale_ = normal(*c.instrument.U_per_length / 2.0);
  }

  double normal(double sigma) { return sigma * normal_(rng_); }
  double uniform(double half) { return std::uniform_real_distribution<double>(-half, half)(rng_); }

  /// Of an interferometer at these distances from the line's first stop.
  std::vector<double> line(const std::vector<double>& at) {
    const Environment& e = c_.environment;
    const double L = at.back(), R = *e.misalignment;
    const double alpha = 11.5e-6;
    const double askew = -std::fabs(uniform(R * R / (2.0 * L * L)));
    const double warm = alpha * uniform(*e.temperature_range / 2.0);
    const double grown = *e.temperature_difference * uniform(*e.expansion_range / 2.0);
    const std::vector<double> drift = walk(at.size());
    std::vector<double> out;
    for (std::size_t i = 0; i < at.size(); ++i)
      out.push_back(normal(*c_.instrument.U_fixed / 2.0) + drift[i] +
                    (scale_ + askew + warm + grown) * at[i]);
    return out;
  }

  std::vector<double> walk(std::size_t n) {
    const double step =
        *c_.environment.drift / std::sqrt(3.0) / std::sqrt(static_cast<double>(n - 1));
    std::vector<double> out(n, 0.0);
    for (std::size_t i = 1; i < n; ++i) out[i] = out[i - 1] + normal(step);
    return out;
  }

  std::mt19937_64& rng() { return rng_; }

 private:
  const Campaign& c_;
  std::mt19937_64 rng_;
  std::normal_distribution<double> normal_;
  double scale_ = 0.0;
};

/// Shares of values within U, by name.
class Tally {
 public:
  explicit Tally(std::string method) : method_(std::move(method)) {}
  void put(const std::string& name, double error, double U, double weight = 1.0) {
    auto& of = shares_[name];
    of.first += std::fabs(error) <= U ? weight : 0.0;
    of.second += weight;
  }
  /// True if every share lies within the limits.
  bool print(double least, double most) const {
    bool good = true;
    std::string line = "| " + method_ + " |";
    for (const auto& [name, share] : shares_) {
      const double percent = 100.0 * share.first / share.second;
      char text[80];
      std::snprintf(text, sizeof text, " %s %.1f", name.c_str(), percent);
      line += std::string(line.back() == '|' ? "" : ",") + text;
      good = good && percent >= least && percent <= most;
    }
    std::printf("%s %% |%s\n", line.c_str(), good ? "" : "  <-- outside");
    std::fflush(stdout);
    return good;
  }

 private:
  std::string method_;
  std::map<std::string, std::pair<double, double>> shares_;
};

Settings defaults(const Analysis& a) {
  Settings s;
  for (const Option& o : a.info.options) s.values[o.name] = o.otherwise;
  return s;
}

Measurement named(const std::string& id, const std::string& kind, const std::string& axis) {
  Measurement m;
  m.id = id;
  m.kind = kind;
  m.axis = axis;
  return m;
}

/// A campaign as it is filled: the lines with their errors, `runs` times in each direction.
struct Campaigned {
  Campaign campaign = stated();
  std::vector<Observations> all;
  double noise = 0.3 * um;
  int runs = 3;

  void add(World& w, Measurement m, std::vector<Observations::AxisColumn> places,
           const std::vector<double>& mean, std::array<double, 3> sense,
           const std::vector<double>& distance) {
    Observations o;
    o.measurement = m.id;
    o.lines.push_back({m.id, sense});
    const std::vector<double> error = w.line(distance);
    o.axes = places;
    for (auto& a : o.axes) a.position.clear(), a.approach.clear();
    for (int run = 1; run <= runs; ++run)
      for (const int direction : {1, -1})
        for (std::size_t j = 0; j < mean.size(); ++j) {
          for (std::size_t k = 0; k < places.size(); ++k) {
            const bool rising = places[k].position.back() > places[k].position.front();
            o.axes[k].position.push_back(places[k].position[j]);
            o.axes[k].approach.push_back(static_cast<std::int8_t>(rising ? direction : -direction));
          }
          o.deviation.push_back(mean[j] + error[j] + w.normal(noise));
          o.run.push_back(static_cast<std::uint32_t>(run));
        }
    campaign.measurements.push_back(std::move(m));
    all.push_back(std::move(o));
  }

  Evaluation evaluated(const Analysis& analysis, std::size_t i, const Settings& settings) const {
    auto e = analysis.analyse({campaign, campaign.measurements[i], all[i], settings, &all});
    if (!e) throw std::runtime_error(e.error().message);
    return *e;
  }
};

const Value* find(const Evaluation& e, const std::string& name) {
  for (const Value& v : e.values)
    if (v.name == name && v.U) return &v;
  return nullptr;
}

bool diagonals(int trials, unsigned seed, bool third) {
  static const Analysis analysis = load(NONIO_DIAGONAL_PLUGIN);
  using namespace bench;
  const Rectangle rect{3.0, 2.0, 8};
  std::mt19937 rng(seed);
  const Errors errors = random_gantry(rng, rect, 10 * um);
  Tally tally(third ? "diagonals, third diagonal" : "diagonals, two lines of X");
  const auto distances = [&](const GridLine& l) {
    std::vector<double> out;
    for (std::size_t j = 0; j < l.ix.size(); ++j)
      out.push_back(
          std::hypot(rect.x(l.ix[j]) - rect.x(l.ix[0]), rect.y(l.iy[j]) - rect.y(l.iy[0])));
    return out;
  };
  std::vector<double> xs, ys;
  for (std::size_t i = 0; i <= rect.n; ++i) xs.push_back(rect.x(i)), ys.push_back(rect.y(i));
  for (int t = 0; t < trials; ++t) {
    Campaigned c;
    World w(c.campaign, seed + 1000U + static_cast<unsigned>(t));
    for (const double y : {0.2, 1.8}) {
      Measurement m = named(y < 1.0 ? "X1" : "X2", "axis", "X");
      m.at["Y"] = y;
      c.add(w, m, {{"X", false, xs, {}}}, pitch_x(errors, rect, y).mean, {1, 0, 0}, xs);
    }
    c.add(w, named("Y", "axis", "Y"), {{"Y", false, ys, {}}}, pitch_y(errors, rect).mean, {0, 1, 0},
          ys);
    std::vector<std::pair<std::string, GridLine>> lines{
        {"D1", line(errors, rect, count(rect.n), count(rect.n))},
        {"D2", line(errors, rect, count(rect.n), down(rect.n))}};
    if (third) lines.emplace_back("D3", half_diagonal(errors, rect));
    for (const auto& [id, l] : lines) {
      std::vector<Observations::AxisColumn> places{{"X", false, {}, {}}, {"Y", false, {}, {}}};
      for (const std::size_t i : l.ix) places[0].position.push_back(rect.x(i));
      for (const std::size_t i : l.iy) places[1].position.push_back(rect.y(i));
      Measurement m = named(id, "diagonal", {});
      m.from = {{"X", places[0].position.front()}, {"Y", places[1].position.front()}};
      m.to = {{"X", places[0].position.back()}, {"Y", places[1].position.back()}};
      c.add(w, m, places, l.mean, {l.cx, l.cy, 0}, distances(l));
    }
    const Evaluation e = c.evaluated(analysis, 3, defaults(analysis));
    if (const Value* v = find(e, "C0Y")) tally.put("C0Y", v->value - errors.C0Y, *v->U);
    for (const Series& s : e.series) {
      const bool f = s.name == (third ? "EYX" : "EYX_even"), g = s.name == "EXY";
      if ((!f && !g) || s.U.empty()) continue;
      const auto truth = [&](std::size_t i) {
        const double here = f ? errors.EYX(rect.x(i)) : errors.EXY(rect.y(i));
        return third ? here : (here + errors.EYX(rect.x(rect.n - i))) / 2.0;
      };
      for (std::size_t i = 1; i < rect.n; ++i) tally.put(s.name, s.value[i] - truth(i), s.U[i]);
    }
  }
  return tally.print(93.0, 98.5);
}

bool step_diagonals(int trials, unsigned seed, bool averaging) {
  static const Analysis analysis = load(NONIO_STEP_PLUGIN);
  using namespace steps;
  const Volume volume{{0.8, 0.6, 0.6}, 7};
  std::mt19937 rng(seed);
  const machine::Errors errors = random_errors(rng, volume, 5 * um);
  const StepDiagonals exact = measured(errors, volume);
  const auto square = true_squareness(errors, volume);
  Tally tally(averaging ? "step diagonals, averaging, mirror square"
                        : "step diagonals, least squares");
  Settings settings = defaults(analysis);
  if (averaging) {
    settings.values["method"] = std::string("averaging");
    settings.values["set_up_square"] = true;
  }
  static const char* const names[] = {"PPP", "NPP", "PNP", "PPN"};
  for (int t = 0; t < trials; ++t) {
    Campaigned c;
    World w(c.campaign, seed + 5000U + static_cast<unsigned>(t));
    Measurement m = named("SD", "step-diagonal", {});
    Observations o;
    o.measurement = "SD";
    o.axes = {{"X", false, {}, {}}, {"Y", false, {}, {}}, {"Z", false, {}, {}}};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string axis(1, "XYZ"[k]);
      m.from[axis] = 0.0;
      m.to[axis] = volume.travel[static_cast<Eigen::Index>(k)];
    }
    for (std::size_t p = 0; p < 4; ++p) {
      const auto& pass = exact.passes[p];
      const auto places = stops(exact, pass);
      Vector u = volume.travel.normalized();
      for (Eigen::Index k = 0; k < 3; ++k) u[k] *= pass.sign[static_cast<std::size_t>(k)];
      o.lines.push_back({names[p], {u[0], u[1], u[2]}});
      std::vector<double> distance;
      for (const Vector& place : places) distance.push_back((place - places[0]).dot(u));
      const auto error = w.line(distance);
      for (std::size_t i = 1; i < places.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k)
          o.axes[k].position.push_back(places[i][static_cast<Eigen::Index>(k)]);
        o.deviation.push_back(pass.reading[i - 1] + error[i] + w.normal(c.noise));
        o.line.push_back(static_cast<std::uint32_t>(p));
        o.run.push_back(1);
      }
    }
    c.campaign.measurements.push_back(m);
    c.all.push_back(std::move(o));
    if (!averaging)
      for (const auto& s : lengths(errors, volume, "XYZ")) {
        const std::string axis(1, "XYZ"[s.axis]);
        std::array<double, 3> sense{};
        sense[s.axis] = 1.0;
        c.add(w, named(axis, "axis", axis), {{axis, false, s.position, {}}}, s.deviation, sense,
              s.position);
      }
    const Evaluation e = c.evaluated(analysis, 0, settings);
    for (std::size_t k = 0; k < 3; ++k)
      if (const Value* v = find(e, std::array{"C0Y", "B0Z", "A0Z"}[k]))
        tally.put(v->name, v->value - square[k], *v->U);
    for (const Series& s : e.series) {
      if (s.U.empty() || s.name.size() != 3) continue;
      math::StepCurve curve;
      curve.name = s.name;
      curve.axis = static_cast<std::size_t>(s.name[2] - 'X');
      const auto exactly = truth(errors, volume, curve);
      const bool positioning = s.name[1] == s.name[2];
      for (std::size_t i = positioning ? 1 : 0; i < s.value.size(); ++i)
        tally.put(positioning ? "positioning" : "straightness", s.value[i] - exactly[i], s.U[i]);
    }
  }
  return tally.print(93.0, 98.5);
}

bool rotary(int trials, unsigned seed, int points, bool sigma_stated) {
  static const Analysis analysis = load(NONIO_ROTARY_PLUGIN);
  using namespace turntable;
  const double bound = 3 * nonio::urad;
  char method[80];
  std::snprintf(method, sizeof method, "rotary axis, %d points, sigma %s", points,
                sigma_stated ? "stated" : "from the residuals");
  Tally tally(method);
  Settings settings = defaults(analysis);
  settings.values["linear_axes_urad"] = 3.0;
  settings.values["tolerance_um"] = 1e5;
  settings.values["tolerance_urad"] = 1e5;
  if (sigma_stated) settings.values["sigma_um"] = 1.0;
  for (int t = 0; t < trials; ++t) {
    Campaign c = stated();
    World w(c, seed + 9000U + static_cast<unsigned>(t));
    c.instrument.U_fixed = 2.0 * nonio::um;
    Table table;
    table.direction = Eigen::Vector3d(w.uniform(1.0), w.uniform(1.0), 1.0).normalized();
    table.phase = w.uniform(3.0);
    auto centres = table.at(full_turn(points));
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& centre : centres)
      mean += Eigen::Vector3d(centre.at[0], centre.at[1], centre.at[2]) / points;
    Eigen::Matrix3d shear = Eigen::Matrix3d::Zero();
    for (const auto& [i, k] : {std::pair{0, 1}, {0, 2}, {1, 2}, {0, 0}, {1, 1}, {2, 2}})
      shear(i, k) = w.uniform(bound);
    std::array<std::vector<double>, 3> drift;
    std::array<double, 3> shift{}, stretch{};
    for (std::size_t k = 0; k < 3; ++k) {
      drift[k] = w.walk(centres.size());
      shift[k] = w.normal(*c.instrument.U_fixed / 2.0) + w.uniform(*c.instrument.probe / 2.0);
      stretch[k] =
          w.normal(*c.instrument.U_per_length / 2.0) +
          11.5e-6 * w.uniform(*c.environment.temperature_range / 2.0) +
          *c.environment.temperature_difference * w.uniform(*c.environment.expansion_range / 2.0);
    }
    for (std::size_t i = 0; i < centres.size(); ++i) {
      const Eigen::Vector3d p(centres[i].at[0], centres[i].at[1], centres[i].at[2]);
      const Eigen::Vector3d sheared = shear * (p - mean);
      for (std::size_t k = 0; k < 3; ++k)
        centres[i].at[k] += shift[k] + stretch[k] * centres[i].at[k] + drift[k][i] +
                            sheared[static_cast<Eigen::Index>(k)] +
                            w.uniform(*c.instrument.sphere / 2.0) + w.normal(1.0 * nonio::um);
    }
    c.measurements.push_back(named("C", "ball-centres", "C"));
    const std::vector<Observations> all{observed(centres)};
    const auto e = analysis.analyse({c, c.measurements[0], all[0], settings, &all});
    if (!e) throw std::runtime_error(e.error().message);
    for (const Value& v : e->values) {
      if (!v.U) continue;
      const auto k = static_cast<Eigen::Index>(v.name.back() - 'x'),
                 d = static_cast<Eigen::Index>(v.name.back() - 'i');
      if (v.name.starts_with("centre")) tally.put("centre", v.value - table.centre[k], *v.U);
      if (v.name.starts_with("direction") && d < 2)
        tally.put("direction", v.value - table.direction[d], *v.U);
      if (v.name == "radius") tally.put("radius", v.value - table.radius, *v.U);
    }
  }
  return tally.print(93.0, 97.0);
}

/// The forms of ISO 230-2's annex, for what was read: the truth is the same evaluation of the same
/// approaches without the errors of the measurement.
bool axis(int trials, unsigned seed) {
  Tally iso("ISO 230-2, n = 5 (forms of the annex: upper bounds)"), vdi("VDI/DGQ 3441, n = 5");
  const Campaign c = stated();
  const double L = 1.0, n = 11.0;
  for (int t = 0; t < trials; ++t) {
    World w(c, seed + 13000U + static_cast<unsigned>(t));
    Observations real, seen;
    for (Observations* o : {&real, &seen})
      o->axes = {{"X", false, {}, {}}}, o->lines = {{"X", {1, 0, 0}}};
    const Environment& e = c.environment;
    const double slope = w.normal((*c.instrument.U_fixed + *c.instrument.U_per_length * L) / 2.0) +
                         11.5e-6 * w.uniform(*e.temperature_range / 2.0) +
                         *e.temperature_difference * w.uniform(*e.expansion_range / 2.0) +
                         w.uniform(*e.misalignment * *e.misalignment / 4.0);
    for (std::uint32_t run = 1; run <= 5; ++run)
      for (const int direction : {1, -1})
        for (double i = 0; i < n; ++i) {
          const double p = L * i / (n - 1.0);
          const double x = 6e-6 * p + direction * 1e-6 + w.normal(0.5 * um);
          for (Observations* o : {&real, &seen}) {
            o->axes[0].position.push_back(p);
            o->axes[0].approach.push_back(static_cast<std::int8_t>(direction));
            o->run.push_back(run);
          }
          real.deviation.push_back(x);
          seen.deviation.push_back(x + slope * p + w.normal(0.3 * *e.drift));
        }
    const auto a = math::AxisTest::arrange(real), b = math::AxisTest::arrange(seen);
    const auto budget = math::uncertainty_budget(c, c.environment, "X", b);
    const auto U = math::iso230_2_uncertainty(*budget.budget, 5, 2.0);
    const auto truth = math::evaluate_iso230_2(a, 2.0), found = math::evaluate_iso230_2(b, 2.0);
    iso.put("A", found.A - truth.A, U.A);
    iso.put("E", found.E - truth.E, U.E);
    iso.put("M", found.M - truth.M, U.M);
    iso.put("R", found.R - truth.R, U.R);
    iso.put("B", found.B - truth.B, U.B);
    const auto V = math::vdi3441_uncertainty(*budget.budget, 5);
    const auto real_v = math::evaluate_vdi3441(a, math::StandardDeviation::direct),
               seen_v = math::evaluate_vdi3441(b, math::StandardDeviation::direct);
    vdi.put("P", seen_v.P - real_v.P, V.P);
    vdi.put("Pa", seen_v.Pa - real_v.Pa, V.Pa);
    vdi.put("U_max", seen_v.U_max - real_v.U_max, V.U_max);
    vdi.put("Ps_max", seen_v.Ps_max - real_v.Ps_max, V.Ps_max);
  }
  const bool good = iso.print(93.0, 100.0);
  return vdi.print(93.0, 100.0) && good;
}

}  // namespace
}  // namespace nonio

int main(int argc, char** argv) {
  int trials = 4000;
  unsigned seed = 20261122;
  bool check = false;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--check") == 0) check = true;
    if (std::strcmp(argv[i], "--trials") == 0 && i + 1 < argc) trials = std::atoi(argv[++i]);
    if (std::strcmp(argv[i], "--seed") == 0 && i + 1 < argc)
      seed = static_cast<unsigned>(std::atoi(argv[++i]));
  }
  std::printf("seed %u, %d campaigns each\n", seed, trials);
  bool good = true;
  for (const bool third : {false, true}) good = nonio::diagonals(trials, seed, third) && good;
  for (const bool averaging : {false, true})
    good = nonio::step_diagonals(trials, seed, averaging) && good;
  good = nonio::rotary(trials, seed, 8, false) && good;
  good = nonio::rotary(trials, seed, 4, false) && good;
  good = nonio::rotary(trials, seed, 8, true) && good;
  good = nonio::axis(trials, seed) && good;
  return check && !good ? 1 : 0;
}
