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

inline constexpr double alias_evidence = 6.0;  ///< 2 ln 20: one twentieth is no difference
// docs/dev/constants.md, M3.
inline constexpr double least_rms = 0.2;  ///< of the noise: smaller effects are not worth a name

// What is left in the same place, of what the candidate predicts: beyond, the candidate is not it.
// docs/dev/constants.md, M6.
inline constexpr double unexplained_share = 0.04;

/// What the search over all sets of effects has found in one part: candidates and the verdict are
/// read off it.
struct Finding {
  const Part& part;
  Repeats repeats;
  std::vector<Term> terms{};  ///< of the model, then the catalogue's others
  std::size_t in_model = 0;   ///< so many terms are the model's
  std::uint64_t seed = 0;
  std::vector<Term> descriptions{};  ///< of the catalogue, that the model does not have
  std::vector<Suspect> suspects{};
  std::vector<double> weight{};  ///< of each reading: 0 for suspects
  Noise noise{};                 ///< as the repeats show it
  std::optional<Workbench> bench{};
  /// Few readings without repeats: effects that with another reading suspected, or none, are nearly
  /// as good an explanation.
  std::vector<std::string> otherwise{};
  Workbench::State start{}, best{};  ///< the model; with what the best explanation adds
  Chance chance{};                   ///< what noise finds in this search
  Comparison of_model{}, of_best{};  ///< fits of both

  std::size_t index_of(const std::string& name) const;
  double dof(const Workbench::State& state) const;
  /// Of an effect of the best explanation, as p_of of a state; where zeros of passes are noise, what is
  /// nearly the same all through a pass has no more evidence than there are passes.
  double p_of(std::size_t effect) const;
  /// Standard deviation that the best explanation leaves.
  double left() const;
  /// Of these terms together.
  Expected<MatrixXd> columns_of(const std::vector<Term>& some) const;
  /// These terms with a zero that is not steady.
  Unsteady walk_with(const std::vector<Term>& some) const;
  /// What a zero that is not steady costs: one parameter, one name.
  double price_of_zero() const;
  /// What a state leaves, whitened.
  VectorXd residual(const Workbench::State& state) const;
};

Expected<Finding> find_best(const Part& part, const std::vector<Term>& model,
                            const std::vector<Term>& catalogue, std::uint64_t seed);

}  // namespace nonio::model
