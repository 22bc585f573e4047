// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "course_data.h"

/// Noise of displacements over time, which is correlated from bin to bin.
namespace nonio::model {

/// Noise that is the sum of a part with exponential correlation in time and of a part that is
/// independent in each bin.
struct CourseNoise {
  double correlation_time;  ///< correlation time of the correlated part, s
  double scatter = 0.0;     ///< variance of the independent part / variance of the correlated part
};

/// Returns the noise with which effects are fitted and searched: a correlation time of 1/24 of the
/// test, and scatter 0.
CourseNoise noise_of_fit(const CourseData& data);

/// Whitens columns for generalized least squares: the noise of the result is independent from bin
/// to bin, and an unknown constant (zero) in a column is eliminated. The result has the unit of the
/// column, and its noise has the same variance as the correlated part of the noise of the column.
/// Source: Kalman 1960; Harvey, Forecasting, structural time series models and the Kalman filter,
/// 3.4.
class CourseWhitening {
 public:
  CourseWhitening(const CourseData& data, const CourseNoise& noise);

  MatrixXd of(MatrixXd columns) const;
  /// Returns half the natural logarithm of the determinant of the noise covariance, including the
  /// term of the unknown zero.
  double half_log_determinant() const { return half_log_determinant_; }
  /// Returns the variance of the zero divided by that of the correlated part of the noise.
  double variance_of_zero() const { return variance_of_zero_; }

 private:
  /// for each bin: decay to the next bin, Kalman gain, 1 / standard deviation
  std::vector<double> follows_, gain_, scale_;
  VectorXd zero_;  ///< whitened column of ones, scaled to unit length
  double half_log_determinant_ = 0.0, variance_of_zero_ = 0.0;

  void filter(MatrixXd& columns) const;
};

/// Columns of a model, and the quantity of each coefficient.
struct CourseModel {
  MatrixXd columns;  ///< one row per bin
  std::vector<Quantity> of{};

  /// Appends the columns of a term; `quantities` are those of its coefficients, and the last one
  /// applies to all further columns.
  void add(const MatrixXd& more, const std::vector<Quantity>& quantities);
};

/// Returns which of the values in `CoursePool::scatters` gives the largest evidence for these
/// columns, as the value of `CourseNoise::scatter`.
double most_likely_scatter(const CourseData& data, const CourseNoise& noise,
                           const CourseModel& model);

/// Returns -ln of the evidence of these columns with the most likely noise, averaged over the
/// displacements.
double likely_cost(const CourseData& data, const CourseModel& model);

/// Uncertainties that remain after a fit of some columns.
struct CourseUncertainty {
  /// standard deviation of the part of the displacement that the columns do not explain, m
  double s = 0.0;
  double zero = 0.0;    ///< standard uncertainty of the zero, m
  MatrixXd covariance;  ///< covariance matrix of the coefficients
};

/// Returns the uncertainties with the noise that is most likely for the first displacement.
CourseUncertainty uncertainty_of(const CourseData& data, const CourseModel& model);

}  // namespace nonio::model
