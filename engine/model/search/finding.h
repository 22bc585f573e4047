// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "data/noise.h"
#include "data/repeats.h"
#include "fit/workbench.h"
#include "nonio/model/comparison.h"
#include "search.h"

namespace nonio::model {

/// 2 ln 20: explanations are equally good unless the odds are more than 20 to 1
inline constexpr double alias_evidence = 6.0;
// Smallest RMS of a named effect, as a fraction of the noise: docs/dev/constants.md, M3.
inline constexpr double least_rms = 0.2;

// Residual at the places of a candidate, as a share of its contribution: docs/dev/constants.md, M6.
inline constexpr double unexplained_share = 0.04;

/// Result of the search over all sets of effects in one part.
struct Finding {
  const Part& part;
  Repeats repeats;
  std::vector<Term> terms{};  ///< terms of the model, then the other terms of the catalog
  std::size_t in_model = 0;   ///< number of terms of the model
  std::uint64_t seed = 0;
  /// descriptions of the catalog that the model does not contain
  std::vector<Term> descriptions{};
  std::vector<Suspect> suspects{};
  std::vector<double> weight{};  ///< weight of each reading: 0 for suspects
  /// noise of the search: estimated from the repeats, with random zeros of passes if these scatter
  Noise noise{};
  std::optional<Workbench> bench{};
  /// With few readings and no repeats: effects of nearly equal explanations with other suspects.
  std::vector<std::string> otherwise{};
  Workbench::State start{}, best{};  ///< the model alone; the best explanation
  Chance chance{};                   ///< for p/weight, which decides whether an effect is named
  Chance unweighted{};               ///< for printed p
  Comparison of_model{}, of_best{};

  std::size_t index_of(const std::string& name) const;
  double dof(const Workbench::State& state) const;
  /// Not corrected for the search. If zeros of passes are noise, an effect that is nearly constant
  /// within a pass has only as much evidence as the number of passes allows.
  double p_of(std::size_t effect) const;
  /// Returns p of an effect of the best explanation as the search decides with it: corrected, by
  /// its weight.
  double deciding_p(std::size_t effect) const;
  /// Standard deviation of a reading from the residuals of the best explanation, m or rad.
  double left() const;
  Expected<MatrixXd> columns_of(const std::vector<Term>& some) const;
  /// Returns the criterion of these terms together with a random zero, by kind of zero.
  Unsteady walk_with(const std::vector<Term>& some) const;
  /// Returns the cost of a random zero, as of an effect with one parameter.
  double price_of_zero() const;
  /// Returns the whitened residuals of a state.
  VectorXd residual(const Workbench::State& state) const;
};

Expected<Finding> find_best(const Part& part, const std::vector<Term>& model,
                            const std::vector<Term>& catalogue, std::uint64_t seed);

}  // namespace nonio::model
