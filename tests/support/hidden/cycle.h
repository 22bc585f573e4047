// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <numbers>
#include <vector>

#include "hidden/generator.h"
#include "hidden/random.h"

namespace nonio::hidden {

inline constexpr double pi = std::numbers::pi;

/// What the axis does: for each reading, in order. True time, also where the file will have none.
struct Cycle {
  std::vector<double> targets;   ///< ascending, m or rad
  std::vector<double> position;  ///< of each reading
  std::vector<double> p;         ///< from the middle of the stretch
  std::vector<double> d, t;
  std::vector<double> since_turn;  ///< travel since the last reversal, m or rad
  std::vector<std::uint32_t> run;
  std::vector<double> material;  ///< degC
  double length = 0.0, duration = 0.0;
  std::size_t size() const { return position.size(); }
};

/// Pendulum: in each run all targets upwards, then downwards, with an overshoot at either end.
Cycle cycle_of(const Scenario& scenario);

struct Cause {
  std::vector<double> deviation;  ///< of each reading, m or rad; noiseless
  std::optional<double> at{};     ///< where it sits: a target (m or rad), a run, an instant (s)
};

/// `amplitude` (m or rad) is nearly proportional to its size.
Cause simulate(Source source, const Cycle& cycle, const Scenario& scenario, Random random,
               double amplitude);

/// The screw of a campaign: its time constant, s, and what its other properties are drawn from.
struct Screw {
  double tau;
  Random random;
};
Screw screw_of(const Scenario& scenario);

/// The same with the asked RMS, by repeated proportion: exact geometry is not quite linear.
Cause simulate_sized(Source source, const Cycle& cycle, const Scenario& scenario,
                     const Random& random, double rms);

/// Root mean square after the mean is taken out.
double rms_about_mean(const std::vector<double>& values);

/// Growth of a screw away from `fixed` (m from the middle of the stretch), heated evenly by its nut
/// from the first reading on: explicit finite differences of rho c T' = k T'' + q - h (4/D) T, with
/// weak conduction into the bearings. Gives for each reading the integral of T from `fixed` to the
/// reading's position, K m, of unit heating. `tau`: time constant of the loss to the air, s.
std::vector<double> heated_screw(const Cycle& cycle, double fixed, double tau, Random random);

/// Temperature of the first of two bodies, heated from t = 0: C1 T1' = 1 - g (T1 - T2) - T1 C1/tau,
/// C2 T2' = g (T1 - T2); at each time.
std::vector<double> two_bodies(const std::vector<double>& times, double tau, Random random);

/// Index of refraction of moist air at 633 nm less 1, at t degC, p and f (water vapour) in Pa.
/// Source: K. P. Birch, M. J. Downs, Metrologia 31 (1994) 315 (modified Edlen equation).
double air_refractivity(double t, double p, double f);

}  // namespace nonio::hidden
