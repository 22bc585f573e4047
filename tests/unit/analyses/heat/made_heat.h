// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "heat_plugins.h"

/// A second generator: bodies whose heat is stepped through time (Runge-Kutta), bearings whose parts
/// turn with frequencies of their own, gauges with errors that their certificate covers. It shares no
/// formula with the analyses.
namespace heat {

using Random = std::mt19937_64;

inline double uniform(Random& r, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(r);
}

/// Energy balance of a lump, C dT/dt = P - G (T - T_air): growth is proportional to T.
struct Lump {
  double C = 0.0, G = 0.0, P = 0.0, T = 0.0;
  double slope(double T_now, double power) const { return (power - G * T_now) / C; }
  void step(double dt, double power) {
    const double a = slope(T, power), b = slope(T + dt / 2.0 * a, power),
                 c = slope(T + dt / 2.0 * b, power), d = slope(T + dt * c, power);
    T += dt / 6.0 * (a + 2.0 * b + 2.0 * c + d);
  }
};

struct Coverage {
  int within = 0, all = 0;
  void add(bool in) { ++all, within += in ? 1 : 0; }
  double share() const { return all > 0 ? 100.0 * within / all : 0.0; }
};
using Coverages = std::map<std::string, Coverage>;

inline void begin(Made& t, const char* kind) {
  nonio::Measurement m;
  m.id = "M", m.kind = kind, m.file = "m.csv";
  t.campaign.measurements = {m};
  t.campaign.instrument.U_fixed = 0.2e-6, t.campaign.instrument.U_per_length = 0.0;
  t.campaign.machine.serial = "S";
  t.o.measurement = "M";
}

/// A spindle test of one sensor along Z: the truth of what was put in.
struct MadeSpindle {
  Made test;
  double tau = 0.0, end = 0.0, range = 0.0, c = 0.0;
};

/// White noise, and correlated motions of the machine that the air causes.
inline MadeSpindle warming(Random& r, double noise, double wander, int readings = 241,
                           double step = 60.0) {
  MadeSpindle out;
  begin(out.test, "thermal");
  Lump body{uniform(r, 2e4, 6e4), uniform(r, 14.0, 24.0), uniform(r, 150.0, 400.0)};
  const double per_K = 1.3e-6;  // m of growth
  out.tau = body.C / body.G;
  out.c = per_K * body.P / body.G;
  auto& o = out.test.o;
  o.axes = {{"S", true, {}, {}}};
  o.lines = {{"Z", {0.0, 0.0, 1.0}}};
  std::normal_distribution<double> N;
  double air = 0.0, low = 0.0, high = 0.0, first = 0.0;
  // The gain of the instrument, as its certificate has it, reaches U_fixed at the largest reading.
  const double gain = 1.0 + 0.1e-6 * N(r) / out.c;
  for (int i = 0; i < readings; ++i) {
    if (i > 0)
      for (int q = 0; q < 20; ++q) body.step(step / 20.0, body.P);
    air = 0.8 * air + 0.6 * wander * N(r);
    const double d = per_K * body.T;
    // What the air does is a motion of the machine, and no noise of the sensor.
    if (i == 0) first = air;
    const double moved = d + air - first;
    low = std::min(low, moved), high = std::max(high, moved), out.end = moved;
    o.axes[0].position.push_back(500.0 * step * i);
    o.axes[0].approach.push_back(1);
    o.time.push_back(step * i);
    o.deviation.push_back(gain * d + air + noise * N(r));
    o.line.push_back(0);
  }
  out.range = high - low;
  return out;
}

inline void hold(Coverages& c, const nonio::Evaluation& e, const std::string& name, double truth) {
  const auto* v = value(e, name);
  if (v != nullptr && v->U) c[name].add(std::fabs(v->value - truth) <= *v->U);
}

inline Coverages thermal_coverage(int count, std::uint64_t seed) {
  Coverages out;
  Random r(seed);
  for (int i = 0; i < count; ++i) {
    const bool wandering = i % 2 == 1;
    const MadeSpindle m = warming(r, uniform(r, 0.05e-6, 0.3e-6), wandering ? 0.1e-6 : 0.0);
    const auto e = evaluated(thermal(), m.test);
    hold(out, e, "tau_Z", m.tau), hold(out, e, "c_Z", m.c), hold(out, e, "end_Z", m.end);
    hold(out, e, "range_Z", m.range);
    if (const auto* f = finding(e, "thermal.warm-up-time"))
      out["warm-up"].add(std::fabs(evidence(*f, "time_min") * 60.0 -
                                   m.tau * std::log(m.c / 1e-6)) <= evidence(*f, "U_min") * 60.0);
    if (finding(e, "thermal.warm-up-time") == nullptr || value(e, "tau2_Z") != nullptr)
      ++out["not one constant"].within;
    ++out["not one constant"].all;
  }
  return out;
}

/// A bearing: journal and race turn with the spindle, cage and balls with parts of its speed.
struct MadeTurns {
  Made test;
  double synchronous = 0.0, eccentricity = 0.0;
};

inline MadeTurns turning(Random& r, double noise, double cage_size, int turns = 32, int n = 256) {
  MadeTurns out;
  begin(out.test, "spindle");
  out.test.campaign.instrument.sphere = 1e-12;
  std::normal_distribution<double> N;
  const double full = 2.0 * std::numbers::pi, e = uniform(r, 2e-6, 12e-6), at = uniform(r, 0, full);
  out.eccentricity = e;
  std::vector<std::array<double, 3>> waves;
  for (const int k : {2, 3, 5, 8})
    waves.push_back({static_cast<double>(k), uniform(r, 0.1e-6, 1.2e-6) / k, uniform(r, 0, full)});
  const double cage = uniform(r, 0.36, 0.44), pass = uniform(r, 5.2, 8.8);
  auto& o = out.test.o;
  o.axes = {{"S", true, {}, {}}, {"ball", true, {}, {}}, {"sensor", true, {}, {}}};
  o.lines = {{"X ball 0 sensor 0", {1.0, 0.0, 0.0}}};
  double low = INFINITY, high = -INFINITY;
  const double gain = 1.0 + 0.1e-6 * N(r) / e;
  const double phase = uniform(r, 0, full);
  for (int i = 0; i < turns * n; ++i) {
    const double t = full * i / n;
    double sync = 0.0;
    for (const auto& w : waves) sync += w[1] * std::cos(w[0] * t + w[2]);
    if (i < n) low = std::min(low, sync), high = std::max(high, sync);
    const double x = e * std::cos(t + at) + sync + cage_size * std::cos(cage * t + phase) +
                     0.3 * cage_size * std::sin(pass * t + phase);
    o.axes[0].position.push_back(t), o.axes[1].position.push_back(0.0);
    o.axes[2].position.push_back(0.0);
    o.deviation.push_back(gain * x + noise * N(r));
    o.line.push_back(0);
  }
  out.synchronous = high - low;
  return out;
}

inline Coverages spindle_coverage(int count, std::uint64_t seed) {
  Coverages out;
  Random r(seed);
  for (int i = 0; i < count; ++i) {
    const MadeTurns m =
        turning(r, uniform(r, 0.02e-6, 0.2e-6), i % 2 == 1 ? 0.15e-6 : 0.02e-6, 32, 128);
    const auto e = evaluated(spindle(), m.test);
    hold(out, e, "sync_X", m.synchronous), hold(out, e, "eccentricity_X", m.eccentricity);
  }
  return out;
}

/// A gauge of five lengths in seven positions on a machine with errors of its own.
struct MadeLengths {
  Made test;
  std::vector<double> error;  ///< of the machine, of each reading
};

inline MadeLengths gauging(Random& r, double scale, int positions = 7, int lengths = 5,
                           int repeats = 3) {
  MadeLengths out;
  begin(out.test, "lengths");
  auto& c = out.test.campaign;
  c.instrument.U_fixed = 0.3e-6, c.instrument.U_per_length = 0.8e-6;
  c.environment.misalignment = 0.4e-3;
  std::normal_distribution<double> N;
  auto& o = out.test.o;
  o.axes = {{"length", false, {}, {}}};
  const double gauge = 0.4e-6 * N(r);  // of the scale of its certificate
  double of_length[6];                 // of the calibration of each length
  for (double& one : of_length) one = 0.15e-6 * N(r);
  for (int p = 0; p < positions; ++p) {
    o.lines.push_back({"E0 " + std::to_string(p + 1), {}});
    const double own = scale * uniform(r, -1.0, 1.0);
    // The far end is up to 0.4 mm off the line: each length is short by the same share.
    const double aside = uniform(r, 0.0, 0.4e-3), longest = 0.1 * lengths;
    for (int l = 1; l <= lengths; ++l)
      for (int k = 1; k <= repeats; ++k) {
        const double L = 0.1 * l, error = own * L + 0.2e-6 * N(r);
        out.error.push_back(error);
        o.axes[0].position.push_back(L);
        o.deviation.push_back(error + of_length[l] + gauge * L +
                              L * aside * aside / (2.0 * longest * longest));
        o.run.push_back(static_cast<std::uint32_t>(k));
        o.line.push_back(static_cast<std::uint32_t>(p));
      }
  }
  return out;
}

inline Coverages lengths_coverage(int count, std::uint64_t seed) {
  Coverages out;
  Random r(seed);
  for (int i = 0; i < count; ++i) {
    const MadeLengths one = gauging(r, 3e-6, 1, 1, 1);
    const auto alone = evaluated(lengths(), one.test);
    if (const auto* v = value(alone, "E0_max"); v != nullptr && v->U)
      out["one error"].add(std::fabs(v->value - one.error.front()) <= *v->U);
    const MadeLengths m = gauging(r, 3e-6);
    const auto e = evaluated(lengths(), m.test, {{"mpe_E0_um", 1.7}, {"mpe_E0_divisor", 333.0}});
    for (const char* name : {"E0_max", "E0_min", "E0"}) {
      const auto* v = value(e, name);
      if (v == nullptr || !v->U) continue;
      for (std::size_t k = 0; k < m.error.size(); ++k)
        if (m.test.o.deviation[k] == v->value) {
          out[name].add(std::fabs(v->value - m.error[k]) <= *v->U);
          break;
        }
    }
  }
  return out;
}

}  // namespace heat
