// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "nonio/math/circle.h"

/// Circles of a machine, computed without the formulas of the decomposition. The two axes follow a
/// command as first-order lags follow a sine, return late by their play over an arc, stick at a
/// reversal, travel on an arc, are out of square, and have scale errors and waves of their drives.
/// A reading is the distance of the point from the place of the bar's ball.
namespace exact {

constexpr double pi = std::numbers::pi, deg = pi / 180.0;

struct Mill {
  double R = 0.15, F = 1.0 / 60.0, pitch = 0.01;  // m, m/s, m
  double squareness = 0.0;                        // C0Y
  struct Axis {
    double scale = 0.0, lag = 2e-3, play = 0.0, lateral = 0.0, stick = 0.0, wave = 0.0, phase = 0.0,
           sagitta = 0.0, zero = 0.0;
    double stick_deg = 0.35;  // of travel over which it lets go
  };
  std::array<Axis, 2> axis;
  std::array<double, 2> centre{0.4, 0.25};
};

struct Noise {
  double white = 0.0, slow = 0.0, rho = 0.0;  // m, m, correlation of readings half a degree apart
};

/// A machine with everything, of the sizes of workshops.
inline Mill any_mill(std::mt19937_64& random, double stick_deg = 0.35) {
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  Mill m;
  m.squareness = 40e-6 * u(random);
  for (auto& a : m.axis) {
    a.scale = 20e-6 * u(random), a.lag = 2e-3 + 0.4e-3 * u(random);
    a.play = 4e-6 * u(random), a.lateral = 2e-6 * u(random);
    a.stick = 3e-6 * std::fabs(u(random)), a.sagitta = 2e-6 * u(random);
    a.wave = 1.5e-6 * (0.6 + 0.4 * u(random)), a.phase = pi * u(random);
    a.zero = 20e-6 * u(random), a.stick_deg = stick_deg;
  }
  return m;
}

/// Where one axis is, from the centre of the circle, and +1 .. -1: which way it presses.
inline std::pair<double, double> place(const Mill& m, std::size_t k, double t, int d) {
  const Mill::Axis& a = m.axis[k];
  const double w = m.F / m.R, behind = t - d * std::atan(w * a.lag),
               turned = k == 0 ? 0.0 : pi / 2.0;
  double x =
      m.R / std::sqrt(1.0 + w * w * a.lag * a.lag) * (k == 0 ? std::cos(behind) : std::sin(behind));
  double way = d * (behind - turned);
  way -= pi * std::floor(way / pi);
  const double outside = std::cos(behind - d * way - turned) > 0.0 ? 1.0 : -1.0;
  const double taken = std::min(1.0, way / (1.5 * deg));
  x += a.scale * x + outside * a.play * (taken - 0.5) +
       outside * a.stick * std::exp(-way / (a.stick_deg * deg)) +
       a.wave * std::sin(2.0 * pi * (x + m.centre[k]) / m.pitch + a.phase);
  return {x, outside * (1.0 - 2.0 * taken)};
}

inline double radius(const Mill& m, double t, int d) {
  const auto [x, way_x] = place(m, 0, t, d);
  const auto [y, way_y] = place(m, 1, t, d);
  const double X = x - m.squareness * y + m.axis[1].lateral / 2.0 * way_y +
                   m.axis[1].sagitta * y * y / (m.R * m.R),
               Y = y + m.axis[0].lateral / 2.0 * way_x + m.axis[0].sagitta * x * x / (m.R * m.R);
  return std::hypot(X - m.axis[0].zero, Y - m.axis[1].zero);
}

/// One run in each direction of `directions`, a reading every half degree. Between the runs the bar
/// grows; `still`, if given, gets the same readings without noise.
inline std::vector<nonio::math::CircleReading> circle(
    const Mill& m, const Noise& noise, std::mt19937_64& random,
    std::vector<int> directions = {1, -1},
    std::vector<nonio::math::CircleReading>* still = nullptr) {
  constexpr int readings = 720;
  std::normal_distribution<double> g;
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  std::vector<nonio::math::CircleReading> out;
  for (const int d : directions) {
    const double grown = noise.white > 0.0 ? 0.5e-6 * u(random) : 0.0;
    double slow = g(random);
    for (int i = 0; i < readings; ++i) {
      const double s = 2.0 * pi * (i + 0.5) / readings, t = d > 0 ? s : 2.0 * pi - s;
      slow = noise.rho * slow + std::sqrt(1.0 - noise.rho * noise.rho) * g(random);
      const double r = radius(m, t, d) - m.R + grown;
      out.push_back({t, r + noise.white * g(random) + noise.slow * slow, d, 1});
      if (still != nullptr) still->push_back({t, r, d, 1});
    }
  }
  return out;
}

/// What the decomposition should say, by cause; NaN where it says nothing.
inline std::vector<std::pair<nonio::math::Cause, double>> truth(const Mill& m) {
  using nonio::math::Cause;
  const auto &x = m.axis[0], &y = m.axis[1];
  return {{Cause::scale_mismatch, x.scale - y.scale},
          {Cause::squareness, m.squareness},
          {Cause::servo_mismatch, m.F * (x.lag - y.lag)},
          {Cause::reversal_u, -x.play},
          {Cause::reversal_v, -y.play},
          {Cause::lateral_u, x.lateral},
          {Cause::lateral_v, y.lateral},
          {Cause::bow_u, x.sagitta},
          {Cause::bow_v, y.sagitta}};
}

inline nonio::math::CircleModel model(const Mill& m, bool both = true) {
  nonio::math::CircleModel out;
  out.R = m.R, out.centre = m.centre, out.pitch = {m.pitch, m.pitch};
  out.leave_out = 2.0 * deg;
  nonio::math::all_causes(out, both);
  return out;
}

/// Shares of causes within 2 u of the truth.
struct Coverage {
  int within = 0, all = 0;
  double squares = 0.0;  ///< of (found - true)/u
  double share() const { return 100.0 * within / all; }
  double rms() const { return std::sqrt(squares / all); }
  Coverage& operator+=(const Coverage& other) {
    within += other.within, all += other.all, squares += other.squares;
    return *this;
  }
};

/// Of so many circles, by cause; the amplitude of the wave of X last.
inline std::vector<Coverage> coverage(int circles, const Noise& noise, std::uint64_t seed,
                                      double stick_deg = 0.35) {
  std::mt19937_64 random(seed);
  std::vector<Coverage> out(truth({}).size() + 1);
  for (int i = 0; i < circles; ++i) {
    const Mill m = any_mill(random, stick_deg);
    auto asked = model(m);
    const auto fit =
        nonio::math::fit_causes_without_spikes(circle(m, noise, random), asked, 20.0 * deg);
    if (!fit) return {};
    const auto count = [&](std::size_t k, double found, double u, double wanted) {
      const double off = (found - wanted) / u;
      out[k] += {std::fabs(off) <= 2.0 ? 1 : 0, 1, off * off};
    };
    const auto wanted = truth(m);
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      const auto& v = fit->of[static_cast<std::size_t>(wanted[k].first)];
      count(k, v.value, v.u, wanted[k].second);
    }
    using nonio::math::Cause;
    const auto &a = fit->of[static_cast<std::size_t>(Cause::cyclic_u_sin)],
               &b = fit->of[static_cast<std::size_t>(Cause::cyclic_u_cos)];
    const double c = std::hypot(a.value, b.value);
    count(wanted.size(), c, std::hypot(a.value * a.u, b.value * b.u) / c, m.axis[0].wave);
  }
  return out;
}

/// Largest values of a path: what it would have without noise is the truth, and what noise adds to a
/// largest value is an error of it. `names` in the order of the result.
constexpr const char* largest_names[] = {"spike", "spike above 6 u", "G_ccw", "G_b", "H"};
inline std::vector<Coverage> largest_coverage(int circles, const Noise& noise, std::uint64_t seed,
                                              double stick_deg = 0.35) {
  using nonio::math::Spike;
  std::mt19937_64 random(seed);
  std::vector<Coverage> out(std::size(largest_names));
  const auto worst = [](const std::vector<Spike>& all, bool of_v) {
    Spike w;
    for (const Spike& s : all)
      if (s.of_v == of_v && std::fabs(s.height) > std::fabs(w.height)) w = s;
    return w;
  };
  const auto one_way = [](std::vector<nonio::math::CircleReading> path) {
    std::erase_if(path, [](const auto& r) { return r.direction < 0; });
    return path;
  };
  for (int i = 0; i < circles; ++i) {
    const Mill m = any_mill(random, stick_deg);
    std::vector<nonio::math::CircleReading> still;
    const auto read = circle(m, noise, random, {1, -1}, &still);
    const auto wanted = nonio::math::fit_causes(still, model(m)),
               fit = nonio::math::fit_causes(read, model(m));
    if (!wanted || !fit) return {};
    const auto count = [&](std::size_t k, double off, double u) {
      out[k] += {std::fabs(off) <= 2.0 * u ? 1 : 0, 1, off * off / (u * u)};
    };
    const auto true_spikes = nonio::math::reversal_spikes(still, model(m), *wanted),
               spikes = nonio::math::reversal_spikes(read, model(m), *fit);
    const nonio::math::CircleNoise again(read, model(m), *fit);
    for (const bool of_v : {false, true}) {
      const Spike found = worst(spikes, of_v), truth = worst(true_spikes, of_v);
      const double adds = again.adds([&](const auto& path) {
        return std::fabs(worst(nonio::math::reversal_spikes(path, model(m), *fit), of_v).height);
      });
      const double off = std::fabs(found.height) - std::fabs(truth.height),
                   u = std::hypot(found.u, adds);
      count(0, off, u);
      if (std::fabs(truth.height) > 6.0 * found.u) count(1, off, u);
    }
    const double s = std::sqrt(2.0) * fit->s_reading;
    const auto zone = [&](const auto& path) { return nonio::math::minimum_zone(path, m.R); };
    const auto width = [&](const auto& path) {
      return nonio::math::least_squares_circle(path, m.R).width();
    };
    count(2, zone(one_way(read)).width() - zone(one_way(still)).width(),
          std::hypot(s, again.adds([&](const auto& path) { return width(one_way(path)); })));
    const auto both = zone(read), true_both = zone(still);
    count(3, both.width() - true_both.width(), std::hypot(s, again.adds(width)));
    const auto h_of = [&](const auto& path, const auto& centre) {
      const auto h = nonio::math::circular_hysteresis(path, m.R, centre, 1.0 * deg);
      return h ? h->H : 0.0;
    };
    count(4, h_of(read, both.centre) - h_of(still, true_both.centre),
          std::hypot(s, again.adds([&](const auto& path) { return h_of(path, both.centre); })));
  }
  return out;
}

/// The scenarios that the documents state.
struct Scenario {
  const char* name;
  Noise noise;
  double stick_deg = 0.35;
};
constexpr Scenario scenarios[] = {{"white", {0.2e-6, 0.0, 0.0}},
                                  {"correlated over 5 deg", {0.05e-6, 0.3e-6, 0.9}},
                                  {"both", {0.15e-6, 0.15e-6, 0.9}}};
/// Beyond what is left out of the fit on both sides of a reversal (2 deg).
constexpr Scenario wide_spikes = {"white, spikes of 2 deg", {0.2e-6, 0.0, 0.0}, 2.0};

}  // namespace exact
