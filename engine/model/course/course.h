// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/model/explain.h"

/// The model of displacements over time: how it is fitted, compared and searched. docs/model.md,
/// "Heat and time".
namespace nonio::model {

class CourseData;

/// Fits a model like `fit` of model/fit.h, but assumes noise that is correlated in time, for the
/// fit as well as for the uncertainties.
Expected<Fit> fit_course(const Part& part, const std::vector<Term>& terms);
Expected<Fit> fit_course(const CourseData& data, const std::vector<Term>& terms);
Comparison comparison_of_course(const Part& part, Fit fit);
Expected<Comparison> compare_course(const Part& part, const std::vector<Term>& model);
Expected<Explanation> explain_course(const Part& part, const std::vector<Term>& model,
                                     const std::vector<Term>& catalogue, std::uint64_t seed);

/// Returns the RMS of cross-validation over blocks of time, m: each block is predicted from the
/// other blocks and has a zero of its own. The shapes of the terms are those of the fit.
double left_out_rms(const Part& part, const std::vector<Term>& terms);

/// Returns which channels (sensors) a fit uses, and how much each contributes; none if no term
/// depends on a channel.
std::optional<Sensors> sensors_of(const Part& part, const Fit& fit);

}  // namespace nonio::model
