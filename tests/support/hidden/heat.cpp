// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "cycle.h"

namespace nonio::hidden {
namespace {

constexpr double diffusivity = 1.25e-5;  // of steel, m2/s: 45 W/(m K) / (7850 kg/m3 * 460 J/(kg K))

/// Integral of T (cells of width dx, the first at -half) from `fixed` to p.
double integral_to(double p, double fixed, const std::vector<double>& T, double half, double dx) {
  double sum = 0.0;
  const double from = std::min(fixed, p), to = std::max(fixed, p);
  for (std::size_t i = 0; i < T.size(); ++i) {
    const double low = -half + static_cast<double>(i) * dx;
    sum += T[i] * std::max(0.0, std::min(to, low + dx) - std::max(from, low));
  }
  return p < fixed ? -sum : sum;
}

}  // namespace

std::vector<double> heated_screw(const Cycle& cycle, double fixed, double tau, Random random) {
  constexpr std::size_t cells = 60;
  // The bearings are a little outside the stretch.
  const double half = std::max(0.6 * cycle.length, std::fabs(fixed));
  const double dx = 2.0 * half / cells;
  const double bearing = random.uniform(0.01, 0.05) / tau;  // loss of an end cell, 1/s
  const double uneven = random.uniform(-0.02, 0.02);        // of the heating along the screw
  const double largest = std::min(tau / 50.0, 0.4 * dx * dx / diffusivity);
  std::vector<double> T(cells, 0.0), growth;
  double now = 0.0;
  for (std::size_t k = 0; k < cycle.size(); ++k) {
    const int steps = static_cast<int>(std::ceil((cycle.t[k] - now) / largest));
    const double dt = steps > 0 ? (cycle.t[k] - now) / steps : 0.0;
    for (int step = 0; step < steps; ++step) {
      const std::vector<double> old = T;
      for (std::size_t i = 0; i < cells; ++i) {
        const double x = (static_cast<double>(i) + 0.5) / cells - 0.5;
        const double left = i > 0 ? old[i - 1] : old[i];
        const double right = i + 1 < cells ? old[i + 1] : old[i];
        const double ends = i == 0 || i + 1 == cells ? bearing : 0.0;
        T[i] += dt * (diffusivity * (left - 2.0 * old[i] + right) / (dx * dx) + 1.0 + uneven * x -
                      old[i] / tau - ends * old[i]);
      }
    }
    now = cycle.t[k];
    growth.push_back(integral_to(cycle.p[k], fixed, T, half, dx));
  }
  return growth;
}

std::vector<double> two_bodies(const std::vector<double>& times, double tau, Random random) {
  const double exchange = random.uniform(0.2, 0.5) / tau;  // 1/s
  const double heavier = random.uniform(3.0, 10.0);        // C2/C1
  double T1 = 0.0, T2 = 0.0, now = 0.0;
  std::vector<double> out;
  for (const double t : times) {
    const int steps = static_cast<int>(std::ceil((t - now) / (tau / 500.0)));
    const double dt = steps > 0 ? (t - now) / steps : 0.0;
    for (int i = 0; i < steps; ++i) {
      const double flow = exchange * (T1 - T2);
      T1 += dt * (1.0 - flow - T1 / tau);
      T2 += dt * flow / heavier;
    }
    now = t;
    out.push_back(T1);
  }
  return out;
}

double air_refractivity(double t, double p, double f) {
  const double wave = 1.0 / (0.632991 * 0.632991);  // 1/um2
  const double standard = 1e-8 * (8342.54 + 2406147.0 / (130.0 - wave) + 15998.0 / (38.9 - wave));
  const double dry =
      p * standard / 96095.43 * (1.0 + 1e-8 * (0.601 - 0.00972 * t) * p) / (1.0 + 0.0036610 * t);
  return dry - f * (3.7345 - 0.0401 * wave) * 1e-10;
}

}  // namespace nonio::hidden
