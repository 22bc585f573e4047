// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/sdk/plugin.h"

/// What a control can compensate of a model of displacements over time.
namespace nonio::heat_compensation {

/// One effect of recorded channels: what it moves the axis by is
///
///     gain L(T, tau)      gain (L(T1, tau) - L(T2, tau))      gain L(|n/largest|^power, tau)
///
/// each less its value when the compensation begins; L: first-order lag (sdk/channels.h).
struct Term {
  enum class Kind { temperature, difference, source };
  Kind kind = Kind::temperature;
  std::vector<std::string> channels;  ///< one; of a difference two
  double gain = 0.0;                  ///< m/K; of a source m. In the direction of the axis
  double tau = 0.0;                   ///< s
  int power = 1;
  double largest = 0.0;  ///< of the channel, in its unit
};

struct Law {
  std::string axis, displacement, measurement;
  std::vector<Term> terms;
  std::vector<std::string> effects;             ///< as the model names them, one for each term
  std::vector<std::string> left_out;            ///< effects of the model that no control can follow
  std::vector<Observations::Channel> channels;  ///< of the terms
  double before = 0.0, after = 0.0;             ///< RMS about the mean, m
};

/// Law of each displacement that has a model, and findings for those that have none or no axis.
/// Option `axes`: "displacement = axis", "-axis" where the sensor counts against the axis.
Expected<std::vector<Law>> laws(const OutputInput& in, std::vector<Finding>& findings);

/// Name that any control accepts: letters, digits and "_".
std::string plain(const std::string& name);

}  // namespace nonio::heat_compensation
