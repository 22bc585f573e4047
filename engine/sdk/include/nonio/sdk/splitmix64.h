// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace nonio {

/// SplitMix64 (Steele, Lea, Flood, OOPSLA 2014): generates the same numbers on every machine.
class SplitMix64 {
 public:
  explicit constexpr SplitMix64(std::uint64_t seed) : state_(seed) {}

  /// Returns the output for state z; each bit of z influences all 64 bits of the output.
  static constexpr std::uint64_t mixed(std::uint64_t z) {
    z += step;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
  }

  constexpr std::uint64_t operator()() {
    const std::uint64_t number = mixed(state_);
    state_ += step;
    return number;
  }

  /// Uniform in [0, 1), from the upper 53 bits.
  constexpr double uniform() { return static_cast<double>((*this)() >> 11U) * 0x1p-53; }

 private:
  static constexpr std::uint64_t step = 0x9e3779b97f4a7c15U;
  std::uint64_t state_;
};

}  // namespace nonio
