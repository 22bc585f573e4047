// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "data/design.h"
#include "data/repeats.h"
#include "data/whitening.h"
#include "nonio/model/comparison.h"
#include "places.h"

namespace nonio::model {

std::vector<double> weights_without(std::size_t readings, const std::vector<Suspect>& suspects);

/// The inputs of a comparison with one table.
struct Ground {
  Repeats repeats;
  std::vector<Suspect> suspects{};
  std::vector<double> weight{};
  Noise noise{};
};

struct Groundwork::Found {
  Ground whole;
  /// Of a long table its means, which places are searched in and shapes are searched on.
  std::optional<Part> thin{};
  std::optional<Ground> of_thin{};
};

/// `known`, or made and held here.
class GroundworkOf {
 public:
  GroundworkOf(const Part& part, const std::vector<Term>& model, const Groundwork* known) {
    if (known == nullptr) known = &made_.emplace(part, model);
    found_ = &known->found();
  }
  const Groundwork::Found& operator*() const { return *found_; }
  const Groundwork::Found* operator->() const { return found_; }

 private:
  std::optional<Groundwork> made_;
  const Groundwork::Found* found_;
};

/// The comparison with these readings suspected, around a fit that exists already.
Comparison comparison_of(const Part& part, const Repeats& repeats, Fit fit,
                         std::vector<Suspect> suspects);

/// Of each term whether its shapes are searched.
std::vector<char> searched_in(const std::vector<Term>& terms);

/// The fit repeated, where the zero is a random walk or differs from run to run.
Expected<Fit> with_its_zero(const Observations& o, Fit fitted, const std::vector<char>& searched);

/// The comparison with these readings suspected; no places of a long table, whose shapes are
/// searched on `thin`.
Expected<Comparison> compare_on(const Part& part, const std::vector<Term>& model,
                                const Ground& ground, const Observations* thin = nullptr);

/// The tests of places with one noise, its zero included, for what a fit leaves or noise like it.
class PlacesLeft {
 public:
  PlacesLeft(const Part&, const Repeats&, const Fit&, const Noise&);
  std::vector<Place> operator()(const std::vector<double>& residual,
                                const std::optional<NoiseFloor>& floor, double least = -1.0) const;

 private:
  Whitening white_;
  MatrixXd basis_;
  PlaceTests tests_;
};

/// Where what a fit leaves sits.
std::vector<Place> seats_in(const Part& part, const Repeats& repeats, const Comparison& comparison);

/// Each run left out in turn: what the others, with the shapes as they are, predict of it. NaN for
/// readings of a run that the others cannot predict; empty with one run.
std::vector<double> cross_validated(const Observations& o, const std::vector<Term>& terms,
                                    const std::vector<double>& weight);
/// Root of the weighted mean square of what can be predicted.
std::optional<double> rms_of(const std::vector<double>& residual,
                             const std::vector<double>& weight);

}  // namespace nonio::model
