// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/model/explain.h"

/// The model of displacements over time: how it is fitted, compared and searched. docs/model.md,
/// "Heat and time".
namespace nonio::model {

class CourseData;

/// As `fit` of model/fit.h, with noise that is correlated in time: u from the number of independent
/// residuals.
Expected<Fit> fit_course(const Part& part, const std::vector<Term>& terms);
Expected<Fit> fit_course(const CourseData& data, const std::vector<Term>& terms);
Comparison comparison_of_course(const Part& part, Fit fit);
Expected<Comparison> compare_course(const Part& part, const std::vector<Term>& model);
Expected<Explanation> explain_course(const Part& part, const std::vector<Term>& model,
                                     const std::vector<Term>& catalogue, std::uint64_t seed);

/// RMS of blocks in time that are left out one after the other, each with a zero of its own; the
/// shapes of the terms are those of the fit. m
double left_out_rms(const Part& part, const std::vector<Term>& terms);

/// Of a fit whose terms follow channels; none where no term does.
std::optional<Sensors> sensors_of(const Part& part, const Fit& fit);

}  // namespace nonio::model
