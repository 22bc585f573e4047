// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "course_data.h"

/// Noise of displacements over time: what no channel explains repeats itself from bin to bin.
namespace nonio::model {

/// Wandering with an exponential correlation in time, and scatter that is new in each bin.
struct CourseNoise {
  double correlation_time;  ///< of the wandering, s
  double scatter = 0.0;     ///< variance of the scatter / variance of the wandering
};

/// The noise with which effects are fitted and searched, but for its scatter.
CourseNoise noise_of_fit(const CourseData& data);

/// Generalised least squares: after it the noise of a column is independent from bin to bin, and the
/// column has nothing of an unknown zero. Unit: that of the column, for wandering of variance 1.
/// Source: Kalman 1960; Harvey, Forecasting, structural time series models and the Kalman filter, 3.4.
class CourseWhitening {
 public:
  CourseWhitening(const CourseData& data, const CourseNoise& noise);

  MatrixXd of(MatrixXd columns) const;
  /// Half the logarithm of the determinant of the covariance.
  double half_log_determinant() const { return half_log_determinant_; }
  /// Variance of the zero / variance of the wandering.
  double variance_of_zero() const { return variance_of_zero_; }

 private:
  std::vector<double> follows_, gain_, scale_;  ///< of each bin
  VectorXd zero_;                               ///< direction of a zero, unit length
  double half_log_determinant_ = 0.0, variance_of_zero_ = 0.0;

  void filter(MatrixXd& columns) const;
};

/// Columns and what the coefficient of each is.
struct CourseModel {
  MatrixXd columns;  ///< bins x k
  std::vector<Quantity> of{};

  /// Adds columns of a term whose coefficients are these; the last one is that of all further ones.
  void add(const MatrixXd& more, const std::vector<Quantity>& quantities);
};

/// The scatter with most evidence in addition to these columns.
double most_likely_scatter(const CourseData& data, const CourseNoise& noise,
                           const CourseModel& model);

/// - ln of the evidence of these columns with the most likely noise, in the mean over displacements.
double likely_cost(const CourseData& data, const CourseModel& model);

/// What the fit of some columns does not know.
struct CourseUncertainty {
  double s = 0.0;       ///< standard deviation of a displacement that the columns do not explain, m
  double zero = 0.0;    ///< standard uncertainty of the zero, m
  MatrixXd covariance;  ///< of the coefficients of the columns
};

/// With the most likely noise of this part's displacement.
CourseUncertainty uncertainty_of(const CourseData& data, const CourseModel& model);

}  // namespace nonio::model
