// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/model/explain.h"

/// The model of displacements over time: docs/model.md, "Heat and time".
namespace nonio::model {

class CourseData;

/// RMS ratio up to which two explanations are not separable: docs/dev/constants.md, M40.
inline constexpr double same_course_rms = 1.05;

/// Fits like `fit` of model/fit.h, but with noise that is correlated in time.
Expected<Fit> fit_course(const Part& part, const std::vector<Term>& terms);
Expected<Fit> fit_course(const CourseData& data, const std::vector<Term>& terms);
/// Subtracts the mean of each line from readings, and returns the means: 0 for a line without
/// readings.
std::vector<double> without_zeros(std::vector<double>& readings, const Observations& table);
/// From the median of the second differences of successive residuals: a smooth course nearly
/// vanishes in them, and outliers hardly affect their median. Nothing for fewer than 20 residuals.
std::optional<NoiseFloor> floor_of(const std::vector<double>& residual);
Comparison comparison_of_course(const Part& part, Fit fit);
Expected<Comparison> compare_course(const Part& part, const std::vector<Term>& model);
Expected<Explanation> explain_course(const Part& part, const std::vector<Term>& model,
                                     const std::vector<Term>& catalogue, std::uint64_t seed);

/// RMS of cross-validation, m, of this displacement and of those that are fitted together: each
/// block of time is predicted from the other blocks and has a zero of its own. The shapes of the
/// terms are those of the fit.
std::vector<double> left_out_rms(const CourseData& data, const std::vector<Term>& terms);

/// For each of these members of the best set and each of its aliases the shortest further test that
/// separates them, or a plan without readings if none that is tried does; `best`: the fit of this set.
std::vector<Plan> plans_of_course(const CourseData& data, const Fit& best,
                                  const std::vector<Candidate>& members,
                                  const std::vector<Term>& catalogue);

/// Channels of an effect: one, two for a difference of channels, none for other effects.
std::vector<std::string> channels_of(const Term& term, const Observations& o);

/// Returns std::nullopt if no term depends on a channel.
std::optional<Sensors> sensors_of(const Part& part, const Fit& fit);

}  // namespace nonio::model
