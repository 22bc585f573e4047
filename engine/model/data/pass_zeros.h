// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "design.h"
#include "repeats.h"

namespace nonio::model {

/// Number of passes minus number of sides (line and direction).
double degrees_of_passes(const Repeats&);

/// Fraction of the sum of squares of columns, about their means, that is constant within each pass.
double share_of_passes(const Repeats&, const MatrixXd& columns);

/// Returns the fraction that is equal in all repeats of a cell.
double share_of_cells(const Repeats&, const MatrixXd& columns);

/// Mean residual of each pass, in the order in which the passes were made.
class ZerosOfPasses {
 public:
  ZerosOfPasses(const Part&, const Repeats&, const std::vector<double>& weight,
                const std::vector<double>& residual);

  /// p-value of the differences between passes of the same side, if readings scatter independently
  /// with standard deviation s; 1 if s is 0, or if no side has two passes.
  double p_of_differences(double s) const;
  /// Returns the sum of squares of the readings' zeros about the means of their sides.
  double squares() const;
  double degrees() const { return degrees_; }
  /// Whether the zeros of passes show no significant trend, step between two passes, or run that
  /// differs from the others, neither themselves nor in the reversal. Such an order indicates a
  /// cause other than scatter. False if there are too few passes for this test.
  bool unordered() const;

 private:
  struct Zero {
    double value = 0.0, way = 0.0, readings = 0.0;
    std::uint32_t side = 0, run = 0;
  };
  void centre(VectorXd& values) const;

  std::vector<Zero> zeros_;
  std::size_t sides_;
  double degrees_ = 0.0;
};

}  // namespace nonio::model
