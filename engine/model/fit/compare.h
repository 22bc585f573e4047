// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "data/design.h"
#include "data/repeats.h"
#include "data/whitening.h"
#include "nonio/model/comparison.h"
#include "places.h"

namespace nonio::model {

std::vector<double> weights_without(std::size_t readings, const std::vector<Suspect>& suspects);

/// Properties of the readings of one table that do not depend on the model: which readings repeat
/// each other, which are suspect and have weight 0, and the correlation of their noise.
struct Ground {
  Repeats repeats;
  std::vector<Suspect> suspects{};
  std::vector<double> weight{};
  Noise noise{};
};

struct Groundwork::Found {
  Ground whole;
  /// For a long table: means of its readings, on which shapes and places are searched.
  std::optional<Part> thin{};
  std::optional<Ground> of_thin{};
};

/// Refers to `known` if it is not null; otherwise creates and owns a Groundwork.
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

/// Returns the comparison for an existing fit and these suspect readings.
Comparison comparison_of(const Part& part, const Repeats& repeats, Fit fit,
                         std::vector<Suspect> suspects);

/// Returns, for each term, whether its shapes are searched.
std::vector<char> searched_in(const std::vector<Term>& terms);

/// Returns the fit. If its residuals show a random zero, or another correlation of adjacent
/// readings than its noise, the fit is first repeated with the noise that they show.
Expected<Fit> with_its_zero(const Observations& o, Fit fitted, const std::vector<char>& searched);

/// Fits the model with the weights and noise of `ground` and compares it with the readings. For a
/// long table, shapes are searched on its means `thin`, and places are not tested.
Expected<Comparison> compare_on(const Part& part, const std::vector<Term>& model,
                                const Ground& ground, const Observations* thin = nullptr);

/// Tests of all places with a given noise, including its random zero, for residuals of a fit or of
/// simulated noise.
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

/// Returns at most three factors, or products of two factors, with which the residuals of the fit
/// of `comparison` vary (`seats_of`), without those with less than 2 % of the residual sum of
/// squares.
std::vector<Place> seats_in(const Part& part, const Repeats& repeats, const Comparison& comparison);

/// Returns the residual of each reading when its run is predicted from the others with the given
/// shapes (cross-validation), m or rad. NaN for readings of a run that the others do not determine,
/// or that is the only run of its line; empty if no line has two runs.
std::vector<double> cross_validated(const Observations& o, const std::vector<Term>& terms,
                                    const std::vector<double>& weight);
/// Returns the root of the weighted mean square of the finite residuals; none if no residual of
/// weight above 0 is finite.
std::optional<double> rms_of(const std::vector<double>& residual,
                             const std::vector<double>& weight);

}  // namespace nonio::model
