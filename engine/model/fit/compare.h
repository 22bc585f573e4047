// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "data/design.h"
#include "data/repeats.h"
#include "data/whitening.h"
#include "nonio/model/comparison.h"
#include "places.h"

namespace nonio::model {

std::vector<double> weights_without(std::size_t readings, const std::vector<Suspect>& suspects);

/// Does not depend on the model. Suspect readings have weight 0.
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

Comparison comparison_of(const Part& part, const Repeats& repeats, Fit fit,
                         std::vector<Suspect> suspects);

std::vector<char> searched_in(const std::vector<Term>& terms);

/// If the residuals show a random zero or another correlation, the fit is repeated with this noise.
Expected<Fit> with_its_zero(const Observations& o, Fit fitted, const std::vector<char>& searched);

/// For a long table, shapes are searched on its means `thin`, and places are not tested.
Expected<Comparison> compare_on(const Part& part, const std::vector<Term>& model,
                                const Ground& ground, const Observations* thin = nullptr);

/// The noise includes a random zero; the residuals are those of a fit or of simulated noise.
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

/// At most three factors, or products of two, with which the residuals vary (`seats_of`), each with
/// at least 2 % of the residual sum of squares.
std::vector<Place> seats_in(const Part& part, const Repeats& repeats, const Comparison& comparison);

/// Residuals, m or rad, if each run is predicted from the others with the given shapes. NaN for a
/// run that the others do not determine, or that is alone on its line; empty if all are alone.
std::vector<double> cross_validated(const Observations& o, const std::vector<Term>& terms,
                                    const std::vector<double>& weight);
/// Returns the RMS of the finite residuals; std::nullopt if all of them have the weight 0.
std::optional<double> rms_of(const std::vector<double>& residual,
                             const std::vector<double>& weight);

}  // namespace nonio::model
