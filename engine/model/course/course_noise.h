// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "course_data.h"

namespace nonio::model {

/// Sum of a part with exponential correlation in time and a part that is independent in each bin.
struct CourseNoise {
  double correlation_time;  ///< correlation time of the correlated part, s
  double scatter = 0.0;     ///< variance of the independent part / variance of the correlated part
};

/// For the fit and the search: a correlation time of 1/24 of the test, and scatter 0.
CourseNoise noise_of_fit(const CourseData& data);

/// Whitens columns for generalized least squares, and eliminates an unknown constant (zero) of each
/// line. The noise of different lines is independent. The
/// result has the unit of the column, and noise with the variance of the correlated part. Source:
/// Kalman 1960; Harvey, Forecasting, structural time series models and the Kalman filter, 3.4.
class CourseWhitening {
 public:
  CourseWhitening(const CourseData& data, const CourseNoise& noise);

  MatrixXd of(MatrixXd columns) const;
  /// Half the log-determinant of the noise covariance, including the terms of the unknown zeros.
  double half_log_determinant() const { return half_log_determinant_; }
  /// Returns the variance of the last zero divided by that of the correlated part of the noise.
  double variance_of_zero() const { return variance_of_zero_; }

 private:
  /// for each bin: decay to the next bin, Kalman gain, 1 / standard deviation
  std::vector<double> follows_, gain_, scale_;
  /// whitened columns of ones in each line, scaled to unit length; 0 elsewhere
  VectorXd zeros_;
  std::vector<Index> lines_;  ///< first bin of each, and the end
  double half_log_determinant_ = 0.0, variance_of_zero_ = 0.0;

  void filter(MatrixXd& columns) const;
};

/// Columns of a model, and the quantity of each coefficient.
struct CourseModel {
  MatrixXd columns;  ///< one row per bin
  std::vector<Quantity> of{};

  /// `quantities`: of the coefficients; the last one applies to all further columns.
  void add(const MatrixXd& more, const std::vector<Quantity>& quantities);
};

/// Returns the value of `CoursePool::scatters` with the largest evidence for these columns.
double most_likely_scatter(const CourseData& data, const CourseNoise& noise,
                           const CourseModel& model);

/// -ln of the evidence with the most likely noise, averaged over the displacements.
double likely_cost(const CourseData& data, const CourseModel& model);

struct CourseUncertainty {
  double s = 0.0;                 ///< standard deviation of what the columns do not explain, m
  double correlated = 0.0;        ///< of its part that is correlated in time, m
  double correlation_time = 0.0;  ///< s
  double zero = 0.0;              ///< standard uncertainty of the zero, m
  MatrixXd covariance;
};

/// Returns the uncertainties with the noise that is most likely for the first displacement.
CourseUncertainty uncertainty_of(const CourseData& data, const CourseModel& model);

}  // namespace nonio::model
