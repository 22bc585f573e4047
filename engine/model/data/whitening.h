// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "design.h"

namespace nonio::model {

/// Rows of a table times their root weights and, where the noise is not independent, less what the
/// rows before predict: what comes out is independent noise of one scatter. Each line by itself,
/// rows in their order; rows of weight 0 become 0. The filter of a first-order autoregression in
/// each line with a level: Durbin and Koopman, Time Series Analysis by State Space Methods, 4.3.
class Whitening {
 public:
  /// The noise as the repeats show it, which weights and tests have; a zero that walks or is
  /// another one in each run is in u only, and stays visible as a place.
  static Noise of_repeats(Noise noise);
  Whitening(const Observations& o, const std::vector<double>& weight, const Noise& noise);

  MatrixXd operator()(const MatrixXd& columns) const;
  /// Takes from whitened columns what an unknown zero of each line takes.
  void take_out_zeros(MatrixXd& whitened) const;
  /// Root weights; of independent noise all that is done to a row.
  const VectorXd& root() const { return root_; }
  bool independent() const { return step_.empty(); }
  /// ln of the determinant of the noise's correlations; with unknown zeros of the lines as of a
  /// diffuse start.
  double log_det() const { return log_det_; }

 private:
  struct Step {  // one row
    double gain_near = 0.0, gain_level = 0.0, over_root = 0.0;
    double keep_near = 0.0, keep_level = 0.0;  // from the row before on its line
    double loading = 0.0;
  };
  void filter(const Noise& noise, const Observations& o);

  const Observations& o_;
  VectorXd root_, zeros_;
  std::vector<Step> step_;
  double log_det_ = 0.0;
};

/// Covariance of the readings' noise over s^2, dense; 0 for rows of weight 0.
MatrixXd covariance_of(const Observations& o, const VectorXd& root, const Noise& noise);

}  // namespace nonio::model
