// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "fit/workbench.h"

namespace nonio::model {

/// The best set of effects that contains those of `start`: several sets are grown side by side,
/// each step by the effect with its shape that lowers the criterion most; then effects are dropped
/// and exchanged until nothing improves. A plain forward selection keeps the compromise that it met
/// first; this does not.
Workbench::State best_explanation(const Workbench& bench, const Workbench::State& start);

/// What noise alone finds in this search when `complete` holds all that there is.
struct Chance {
  double trials = 1.0;  ///< independent tests that the search amounts to

  /// 1 - (1 - p)^trials
  double corrected(double p) const;
};

/// Noise made of `residual`: the signs of short stretches of its passes flipped at random (what
/// neighbours share within a pass stays), less its part in the zeros and a state's columns.
struct SignFlips {
  MatrixXd noise;        ///< a column for each shuffle
  MatrixXd products;     ///< a row for each shuffle: with all columns of the bench
  MatrixXd in_complete;  ///< of all columns, what they have in the directions of the state
  VectorXd squares;      ///< of each shuffle
};
// docs/dev/constants.md, M15.
inline constexpr std::size_t stretch_of_signs = 5;  ///< readings whose sign is flipped together
inline constexpr std::size_t whole_pass = static_cast<std::size_t>(-1);
SignFlips shuffled(const Workbench& bench, const Workbench::State& complete,
                   const VectorXd& residual, const std::vector<std::uint32_t>& pass,
                   std::uint64_t seed, std::size_t stretch = stretch_of_signs);

Chance measure_chance(const Workbench& bench, const Workbench::State& complete,
                      const SignFlips& shuffles);

/// Of each shuffle, whether an effect would be named.
std::vector<char> named_in(const Workbench& bench, const Workbench::State& complete,
                           const SignFlips& shuffles, const Chance& chance);

/// F-test of one effect of a state against the rest; not corrected for any search.
double p_of(const Workbench& bench, const Workbench::State& state, std::size_t effect);

/// An effect is named if noise would give such evidence in this search less often than this.
// docs/dev/constants.md, M2.
inline constexpr double named_below = 0.005;

}  // namespace nonio::model
