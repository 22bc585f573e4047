// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/reports/wording.h"
#include "nonio/sdk/results.h"

/// What every document states about a model in words and numbers; its pictures are in residuals.h.
namespace nonio::reports {

/// The host's analysis whose values are printed with the model, not with the measurement.
inline constexpr std::string_view model_analysis = "model-fit";

struct ParameterRow {
  std::string effect;   ///< empty below the first one of its effect
  std::string name;     ///< "b"
  std::string meaning;  ///< of effects that have words; a formula's has none
  std::string value, U, unit;
};
std::vector<ParameterRow> parameter_rows(const ModelFit&, const Templates&,
                                         const std::string& language);

/// "backlash:X b and periodic:X a (-0.95); ...": what the readings hardly separate; or nothing.
std::string correlated_parameters(const ModelFit&, const Wording&);

/// An effect that is not in the model, in words and printed numbers.
struct CandidateRow {
  std::string effect, evidence, rms, cv_rms, smallest;
  bool certain = false;
};
std::vector<CandidateRow> candidate_rows(const ModelFit&, const std::string& language);

/// Those without evidence in one sentence, with the size from which each would be seen; or nothing.
std::string no_sign(const ModelFit&, const Templates&, const std::string& language);

/// Readings, redundancy, largest residual, in sentences.
std::string fit_in_words(const ModelFit&, const Results&, const Wording&);

}  // namespace nonio::reports
