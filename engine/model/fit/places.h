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
  double dof;
  const std::optional<NoiseFloor>& floor;
};

/// All places that these readings can show, prepared once for several residual vectors.
class PlaceTests {
 public:
  /// `basis`: orthonormal columns of the model, as in Residuals.
  PlaceTests(const Part&, const Repeats&, const Whitening& white, const MatrixXd& basis,
             double dof);
  /// Places with an rms above `least`, the largest share of the residual sum of squares first.
  std::vector<Place> operator()(const VectorXd& residual, const std::optional<NoiseFloor>& floor,
                                double least = -1.0) const;

 private:
  struct Tests;
  std::shared_ptr<const Tests> tests_;
};

/// The smallest set of at most three places that contains the residuals. Places are added, each
/// including the effect of its factors alone ("direction x time" includes "direction"), as long as
/// the evidence exceeds the cost of their columns.
std::vector<Place> seats_of(const Residuals&);

/// Factors, or products of two factors, with which a prediction varies.
class FactorsOf {
 public:
  FactorsOf(const Part& part, const Repeats& repeats, const Whitening& white);
  /// Factors with more than a twentieth of the sum of squares of a whitened prediction.
  std::vector<Where> operator()(const VectorXd& signal) const;

 private:
  std::vector<Where> of_;
  std::vector<MatrixXd> bases_;
};

/// Whether two places share a factor; run is time, screw phase and angle are position.
bool same_factor(const Where& a, const Where& b);

}  // namespace nonio::model
