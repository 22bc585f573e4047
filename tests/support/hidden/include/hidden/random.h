// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace nonio::hidden {

/// The same numbers from the same seed with every standard library: std::mt19937_64 is specified to
/// the bit, the distributions of <random> are not, so the transformations are our own.
class Random {
 public:
  /// Streams of one seed do not depend on each other: a piece more does not change the others.
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0) : engine_(mixed(seed, stream)) {}

  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }  ///< in [0, 1)
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Uniform in the logarithm, for quantities that span decades.
  double spread(double low, double high) { return low * std::pow(high / low, uniform()); }
  std::size_t below(std::size_t n) {
    return static_cast<std::size_t>(uniform() * static_cast<double>(n));
  }
  std::size_t whole(std::size_t low, std::size_t high) { return low + below(high - low + 1); }
  bool flag(double probability) { return uniform() < probability; }
  double sign() { return flag(0.5) ? 1.0 : -1.0; }
  /// Standard normal, by Box and Muller; the second value is not kept.
  double normal() {
    const double r = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return r * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  /// splitmix64, so that neighbouring seeds give unrelated engines.
  static std::uint64_t mixed(std::uint64_t seed, std::uint64_t stream) {
    std::uint64_t z = seed + 0x9e3779b97f4a7c15ULL * (stream + 1);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }
  std::mt19937_64 engine_;
};

}  // namespace nonio::hidden
