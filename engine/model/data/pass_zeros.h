// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "design.h"
#include "repeats.h"

namespace nonio::model {

/// Passes of the same side less the mean of their side: how many are independent.
double degrees_of_passes(const Repeats&);

/// Share of the sum of squares of columns (less their means) that is the same all through a pass.
double share_of_passes(const Repeats&, const MatrixXd& columns);

/// Means of what is left of each pass, in the order in which the passes were made.
class ZerosOfPasses {
 public:
  ZerosOfPasses(const Part&, const Repeats&, const std::vector<double>& weight,
                const std::vector<double>& residual);

  /// Chance that passes of the same side differ so much, if readings of standard deviation s are all
  /// that differs.
  double p_of_differences(double s) const;
  /// Whether they come in any order. A step between two passes, a trend, one run that differs, or any of
  /// these of the reversal is a cause and no scatter. Few passes do not show it.
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
