// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "nonio/sdk/splitmix64.h"

namespace nonio::storage {

/// Gives the same numbers with every standard library, because the distributions of <random> are
/// not specified.
class Random {
 public:
  /// Streams of the same seed are independent of each other.
  Random(std::uint64_t seed, std::uint64_t stream)
      : engine_(SplitMix64::mixed(SplitMix64::mixed(seed) + stream)) {}

  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Standard normal (Box-Muller method).
  double normal() {
    const double r = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return r * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace nonio::storage
