// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "nonio/sdk/results.h"

/// A model as the host hands it to documents, made without a fit: readings of an axis with lost
/// motion, an error once per turn of the screw, and a zero that drifts, each with its true size.
namespace nonio::fixtures {

struct MadeModel {
  bool rotary = false, minus = true, times = true, temperatures = true, period = true;
  int targets = 41, runs = 5;
  bool suspects = true;
  unsigned seed = 11;
};

/// What the model of `made` says of a reading: backlash, periodic, zero-drift.
struct Said {
  double b, p, z;
};

inline ModelFit made_model(const MadeModel& made = {}) {
  const double um = made.rotary ? 1.0 / arcsec_per_rad : 1e-6;
  const double length = made.rotary ? 2 * std::numbers::pi : 1.6;
  const double period = made.rotary ? 2 * std::numbers::pi / 120 : 0.012;
  const std::string axis = made.rotary ? "C" : "X";
  ModelFit f;
  f.part = f.axis = axis;
  f.measurements = {axis};
  f.rotary = f.angular = made.rotary;
  if (made.period) f.period = period;
  f.effects = {{"backlash:" + axis, true, {}},
               {"periodic:" + axis, true, {}},
               {"zero-drift:" + axis, false, {}}};
  std::mt19937 random(made.seed);
  const auto noise = [&] {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += static_cast<double>(random()) / 4294967296.0;
    return sum;
  };
  const double s = 0.6 * um;
  /// RMS and largest residual, as a fit states them
  const auto put_numbers = [&](auto& of, bool several) {
    double sum = 0.0, weights = 0.0;
    of.largest = 0.0;
    for (std::size_t i = 0; i < of.residual.size(); ++i) {
      sum += of.weight[i] * of.residual[i] * of.residual[i];
      weights += of.weight[i];
      if (of.weight[i] > 0.0 && std::fabs(of.residual[i]) > std::fabs(of.largest))
        of.largest = of.residual[i];
    }
    of.rms = std::sqrt(sum / weights);
    if (several) of.cv_rms = 1.04 * of.rms;
  };
  double time = 0, squares[4] = {0, 0, 0, 0};
  std::uint32_t line = 1;
  const auto readings = static_cast<std::size_t>(made.targets) *
                        static_cast<std::size_t>(made.runs) * (made.minus ? 2U : 1U);
  for (int run = 1; run <= made.runs; ++run)
    for (const int d : {1, -1})
      for (int k = 0; k < made.targets && (d > 0 || made.minus); ++k) {
        const int i = d > 0 ? k : made.targets - 1 - k;
        const double p = std::round(length * (i + 0.3 * std::fmod(i * 0.618, 1.0)) /
                                    std::max(1, made.targets - 1) * 1e4) /
                         1e4;
        const Said said{-6.1 * um * d / 2, 2.4 * um * std::sin(2 * std::numbers::pi * p / period),
                        0.002 * um * (time - 4.0 * static_cast<double>(readings))};
        const bool wrong = made.suspects && line == 77;
        const double e = s * noise() + (wrong ? 25 * um : 0.0);
        f.measurement.push_back(0);
        f.source_line.push_back(++line);
        f.run.push_back(static_cast<std::uint32_t>(run));
        f.target.push_back(p);
        f.direction.push_back(static_cast<std::int8_t>(d));
        if (made.times) f.time.push_back(time);
        if (made.temperatures) f.temperature.push_back(20.0 + 1.5 * (1 - std::exp(-time / 1800)));
        f.deviation.push_back(said.b + said.p + said.z + e);
        f.residual.push_back(e);
        if (made.runs > 1) f.cv_residual.push_back(1.03 * e);
        f.weight.push_back(wrong ? 0.0 : 1.0);
        if (wrong) f.suspects.push_back({f.size() - 1, 2.9 * um});
        f.effects[0].contribution.push_back(said.b);
        f.effects[1].contribution.push_back(said.p);
        f.effects[2].contribution.push_back(said.z);
        const double w = f.weight.back();
        const double left[4] = {e + said.b + said.p + said.z, e + said.p + said.z, e + said.z, e};
        for (int n = 0; n < 4; ++n) squares[n] += w * left[n] * left[n];
        time += 8;
      }
  const char* names[4] = {"", "backlash:", "periodic:", "zero-drift:"};
  for (int n = 0; n < 4; ++n) {
    const double rms = std::sqrt(squares[n] / static_cast<double>(f.size()));
    f.steps.push_back({n == 0 ? "" : names[n] + axis, rms, {}});
    if (made.runs > 1) f.steps.back().cv_rms = 1.04 * rms;
  }
  const Quantity q = deviation_of(made.rotary);
  f.parameters = {{"backlash:" + axis, "b", -6.1 * um, 0.06 * um, q},
                  {"periodic:" + axis, "a", 2.4 * um, 0.05 * um, q},
                  {"periodic:" + axis, "b", 0.02 * um, 0.05 * um, q},
                  {"periodic:" + axis, "P", period, {}, position_of(made.rotary), true},
                  {"zero-drift:" + axis, "z", 0.002 * um, 0.0001 * um,
                   made.rotary ? Quantity::angle_per_time : Quantity::deviation_per_time}};
  f.correlation.assign(5, std::vector<double>(5, 0.0));
  for (std::size_t i = 0; i < 5; ++i) f.correlation[i][i] = 1.0;
  f.correlation[1][0] = f.correlation[0][1] = -0.95;
  if (made.runs > 1) f.floor = 0.59 * um, f.floor_u = 0.03 * um;
  // Fitted again without the backlash, the drift would take some of it (made up: four fifths stay).
  put_numbers(f, made.runs > 1);
  ModelFit::Without without{"backlash:" + axis, 0.0,           {},      0.0,       f.residual,
                            f.weight,           f.cv_residual, f.floor, f.floor_u, f.suspects};
  for (std::size_t i = 0; i < f.size(); ++i) {
    without.residual[i] += 0.8 * f.effects[0].contribution[i];
    if (made.runs > 1) without.cv_residual[i] = 1.04 * without.residual[i];
  }
  put_numbers(without, made.runs > 1);
  f.without = {std::move(without)};
  Finding verdict;
  verdict.id = "model.nothing";
  verdict.advice = "The model is good down to the noise.";
  f.diagnosis = {verdict};
  return f;
}

/// The same with an effect that is missing, two that are not, and something to measure.
inline ModelFit with_candidates(ModelFit f) {
  const Quantity q = deviation_of(f.angular);
  f.candidates = {{"scale:" + f.axis, 81.5, 0.6e-6, 0.62e-6, 1e-12, 0.15e-6, {}, true}};
  f.no_sign = {
      {"no-sign.first", false, {{"size", 1.1e-6, q}}, {{"effect", "warm-up:" + f.axis}}},
      {"no-sign.other", false, {{"size", 0.25e-6, q}}, {{"effect", "temperature:" + f.axis}}}};
  f.next = {{"next.temperatures", false, {}, {}}};
  return f;
}

}  // namespace nonio::fixtures
