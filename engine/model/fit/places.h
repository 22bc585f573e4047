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
  const VectorXd& residual;  ///< whitened
  const MatrixXd& basis;     ///< orthonormal columns of the model, without zeros of lines
  double dof;                ///< of the residual
  const std::optional<NoiseFloor>& floor;
};

/// The tests of every place that these readings can show, for one residual of a model or many.
class PlaceTests {
 public:
  /// `basis` of the model as in Leftover.
  PlaceTests(const Part&, const Repeats&, const Whitening& white, const MatrixXd& basis,
             double dof);
  /// With the share of what is left, largest first; only those whose rms is above `least`.
  std::vector<Place> operator()(const VectorXd& residual, const std::optional<NoiseFloor>& floor,
                                double least = -1.0) const;

 private:
  struct Tests;
  std::shared_ptr<const Tests> tests_;
};

/// The fewest places that hold what is left: one after the other, each with all that its factors
/// predict together ("direction x time" with what is constant in time), as long as the evidence
/// pays for their columns. For structure that no effect explains.
std::vector<Place> seats_of(const Residuals&);

/// What a term's part varies with (direction, position, direction x time, ...), by the share
/// of its sum of squares: those whose own share is at least a twentieth, or whose product with
/// another is.
class FactorsOf {
 public:
  FactorsOf(const Part& part, const Repeats& repeats, const Whitening& white);
  /// Of a whitened part.
  std::vector<Where> operator()(const VectorXd& signal) const;

 private:
  std::vector<Where> of_;
  std::vector<MatrixXd> bases_;
};

}  // namespace nonio::model
