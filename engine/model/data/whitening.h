// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "design.h"

namespace nonio::model {

/// Multiplies the rows by their root weights and, if the noise is correlated, subtracts the
/// prediction from earlier rows of the line, so that the noise becomes independent with equal
/// standard deviation. Rows of weight 0 become 0. Filter of a first-order autoregression with a
/// level in each line (Durbin and Koopman, Time Series Analysis by State Space Methods, 4.3).
class Whitening {
 public:
  /// Noise for weights and tests, without the random zero: that enters only u, because otherwise it
  /// would no longer be visible as a place of the residuals.
  static Noise of_repeats(Noise noise);
  Whitening(const Observations& o, const std::vector<double>& weight, const Noise& noise);

  MatrixXd operator()(const MatrixXd& columns) const;
  /// Removes from whitened columns the component that the unknown zero of each line absorbs.
  void take_out_zeros(MatrixXd& whitened) const;
  /// For independent noise, whitening only multiplies by these root weights.
  const VectorXd& root() const { return root_; }
  bool independent() const { return step_.empty(); }
  /// ln of the determinant of the noise correlation; zeros of lines have a diffuse prior.
  double log_det() const { return log_det_; }

 private:
  struct Step {
    double gain_near = 0.0, gain_level = 0.0, over_root = 0.0;
    // factors for the state of the previous row on the line
    double keep_near = 0.0, keep_level = 0.0;
    double loading = 0.0;
  };
  void filter(const Noise& noise, const Observations& o);

  const Observations& o_;
  VectorXd root_, zeros_;
  std::vector<Step> step_;
  double log_det_ = 0.0;
};

/// Returns the covariance matrix of the readings' noise divided by s^2; 0 for rows of weight 0.
MatrixXd covariance_of(const Observations& o, const VectorXd& root, const Noise& noise);

}  // namespace nonio::model
