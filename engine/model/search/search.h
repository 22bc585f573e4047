// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "fit/weights.h"
#include "fit/workbench.h"

namespace nonio::model {

/// Several sets are grown in parallel from `start`, each step by the effect that reduces the
/// criterion most; then effects are removed and exchanged, at most 20 times. A plain forward
/// selection would keep an early compromise.
Workbench::State best_explanation(const Workbench& bench, const Workbench::State& start);

/// Corrects p-values for a search in which noise alone can produce effects anywhere.
struct Chance {
  double trials = 1.0;  ///< number of independent tests that the search is equivalent to

  /// Returns p corrected for the search: 1 - (1 - p)^trials.
  double corrected(double p) const;
};

/// Copies of `residual` with randomly flipped signs of stretches of passes, which preserve the
/// correlation within a stretch, without the components in the zeros and in the columns of a state.
struct SignFlips {
  MatrixXd noise;     ///< residuals with flipped signs, one column per copy
  MatrixXd products;  ///< one row per copy: products with all columns of the bench
  /// for all columns: their products with the orthonormal directions of the state
  MatrixXd in_complete;
  VectorXd squares;  ///< sum of squares of each copy
};
// Readings whose sign is flipped together: docs/dev/constants.md, M15.
inline constexpr std::size_t stretch_of_signs = 5;
inline constexpr std::size_t whole_pass = static_cast<std::size_t>(-1);
SignFlips shuffled(const Workbench& bench, const Workbench::State& complete,
                   const VectorXd& residual, const std::vector<std::uint32_t>& pass,
                   std::uint64_t seed, std::size_t stretch = stretch_of_signs);

/// Returns what `shuffled` does for noise that is already drawn: one column per copy, with the
/// weights of the bench.
SignFlips drawn(const Workbench& bench, const Workbench::State& complete, MatrixXd noise);

/// Returns for each copy the smallest p of one more effect, of p/weight if `weighted`.
std::vector<double> least_p(const Workbench& bench, const Workbench::State& complete,
                            const SignFlips& shuffles, bool weighted);

Chance measure_chance(const Workbench& bench, const Workbench::State& complete,
                      const SignFlips& shuffles, bool weighted);

/// Returns, for each copy, whether some effect would be named (`named_below`) in this copy.
std::vector<char> named_in(const Workbench& bench, const Workbench::State& complete,
                           const SignFlips& shuffles, const Chance& chance);

/// Returns p of the F-test of one effect of a state; not corrected for the search.
double p_of(const Workbench& bench, const Workbench::State& state, std::size_t effect);

}  // namespace nonio::model
