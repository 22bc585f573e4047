// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "data/design.h"
#include "data/repeats.h"
#include "data/whitening.h"
#include "nonio/model/comparison.h"

namespace nonio::model {

struct Residuals {
  const Part& part;
  const Repeats& repeats;
  const Whitening& white;
  const VectorXd& residual;  ///< whitened residuals
  const MatrixXd& basis;     ///< orthonormal columns of the model, without zeros of lines
  double dof;                ///< degrees of freedom of the residual
  const std::optional<NoiseFloor>& floor;
};

/// Tests of all places that these readings can show. They are prepared once and applied to one or
/// more residual vectors of a model.
class PlaceTests {
 public:
  /// `basis`: orthonormal columns of the model, as in Residuals.
  PlaceTests(const Part&, const Repeats&, const Whitening& white, const MatrixXd& basis,
             double dof);
  /// Returns the places by their share of the residual sum of squares, largest first; only those
  /// whose rms is above `least`.
  std::vector<Place> operator()(const VectorXd& residual, const std::optional<NoiseFloor>& floor,
                                double least = -1.0) const;

 private:
  struct Tests;
  std::shared_ptr<const Tests> tests_;
};

/// Returns the smallest set of at most three places that contains the residuals of a model, for
/// structure that no effect explains. It adds places one after the other, each including the effect
/// of its factors alone ("direction x time" includes "direction"), as long as the evidence exceeds
/// the cost of their columns.
std::vector<Place> seats_of(const Residuals&);

/// Finds the factors, or products of two factors, with which a term's prediction varies (direction,
/// position, direction x time, ...).
class FactorsOf {
 public:
  FactorsOf(const Part& part, const Repeats& repeats, const Whitening& white);
  /// Returns the factors whose share of the sum of squares of a whitened prediction exceeds a
  /// twentieth.
  std::vector<Where> operator()(const VectorXd& signal) const;

 private:
  std::vector<Where> of_;
  std::vector<MatrixXd> bases_;
};

}  // namespace nonio::model
