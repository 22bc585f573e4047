// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/reports/wording.h"
#include "nonio/sdk/results.h"

/// Texts and numbers about a model for all documents; residuals.h has the figures.
namespace nonio::reports {

/// Analysis of the host whose values are printed with the model.
inline constexpr std::string_view model_analysis = "model-fit";

struct ParameterRow {
  std::string effect;   ///< empty if equal to the row above
  std::string name;     ///< symbol, such as "b"
  std::string meaning;  ///< empty for effects without texts (formulas)
  std::string value, U, unit;
};
std::vector<ParameterRow> parameter_rows(const ModelFit&, const Templates&,
                                         const std::string& language);

/// Barely separable parameters, such as "backlash:X b and periodic:X a (-0.95); ..."; empty if
/// there are none.
std::string correlated_parameters(const ModelFit&, const Wording&);

/// An effect that is not in the model.
struct CandidateRow {
  std::string effect, evidence, rms, cv_rms, smallest;
  bool certain = false;
};
std::vector<CandidateRow> candidate_rows(const ModelFit&, const std::string& language);

/// A sentence on effects without evidence, with their detection limits; empty if there are none.
std::string no_sign(const ModelFit&, const Templates&, const std::string& language);

/// Sentences about readings, redundancy and largest residual.
std::string fit_in_words(const ModelFit&, const Results&, const Wording&);

}  // namespace nonio::reports
