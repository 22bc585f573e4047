// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "nonio/sdk/plugin.h"

/// The part of a model of displacements over time that a control can compensate.
namespace nonio::heat_compensation {

/// Displacement of the axis by one effect of recorded channels:
///
///     gain L(T, tau)      gain (L(T1, tau) - L(T2, tau))      gain L(|n/largest|^power, tau)
///
/// each relative to its value at the start of compensation or to `zero`; L: first-order lag (sdk/channels.h).
/// In runs of the axis a temperature also has a growth: (gain + growth (P - reference)) L(T, tau).
struct Term {
  enum class Kind { temperature, difference, source };
  Kind kind = Kind::temperature;
  std::vector<std::string> channels;  ///< names of one channel, or two for a difference
  double gain = 0.0;                  ///< m/K, or m for a source; positive towards plus of the axis
  double growth = 0.0;                ///< 1/K
  double tau = 0.0;                   ///< s
  int power = 1;
  double largest = 0.0;  ///< largest value of the channel, in its unit
  /// For `temperature`: mean temperature of this test, degC, which is also that of the tables.
  std::optional<double> zero{};
};

struct Law {
  std::string axis, displacement, measurement;
  std::vector<Term> terms;
  std::vector<std::string> effects;             ///< names in the model, one per term
  std::vector<std::string> left_out;            ///< effects that no control can compensate
  std::vector<Observations::Channel> channels;  ///< channels used by the terms
  double before = 0.0, after = 0.0;             ///< RMS without and with compensation, m
  bool of_runs = false;                         ///< whether positions of the axis were measured
  double reference = 0.0;      ///< P0, m: middle of the measured range; only with of_runs
  double largest_slope = 0.0;  ///< largest growth of all terms in this test, m/m
};

/// Law of each displacement, and of the runs of each axis, with a model; findings if there is no model or no axis. Option `axes`:
/// "displacement = axis", or "-axis" if the sensor is positive towards minus of the axis.
Expected<std::vector<Law>> laws(const OutputInput& in, std::vector<Finding>& findings);

/// Replaces all characters except letters, digits and "_" by "_".
std::string plain(const std::string& name);

}  // namespace nonio::heat_compensation
