// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/model/explain.h"

/// The model of displacements over time: how it is fitted, compared and searched. docs/model.md,
/// "Heat and time".
namespace nonio::model {

class CourseData;

/// Fits a model like `fit` of model/fit.h, but with noise that is correlated in time, so that u
/// follows from the number of independent residuals.
Expected<Fit> fit_course(const Part& part, const std::vector<Term>& terms);
Expected<Fit> fit_course(const CourseData& data, const std::vector<Term>& terms);
Comparison comparison_of_course(const Part& part, Fit fit);
Expected<Comparison> compare_course(const Part& part, const std::vector<Term>& model);
Expected<Explanation> explain_course(const Part& part, const std::vector<Term>& model,
                                     const std::vector<Term>& catalogue, std::uint64_t seed);

/// Cross-validation: RMS over blocks of time, each predicted from the other blocks and with a zero
/// of its own; the shapes of the terms are those of the fit. m
double left_out_rms(const Part& part, const std::vector<Term>& terms);

/// Which channels (sensors) a fit uses, and how much each contributes; none if no term follows a
/// channel.
std::optional<Sensors> sensors_of(const Part& part, const Fit& fit);

}  // namespace nonio::model
