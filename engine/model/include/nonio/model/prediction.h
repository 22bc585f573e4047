// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "nonio/model/comparison.h"

namespace nonio::model {

/// A fitted model applied to readings that were not used in the fit.
struct Prediction {
  std::vector<double> error;  ///< reading minus prediction, m or rad
  std::vector<double> u;      ///< standard uncertainty of each prediction, m or rad
  double rms = 0.0;
  double sd = 0.0;      ///< standard deviation of the readings, m or rad: the error without a model
  double inside = 0.0;  ///< share of the readings with |error| <= 2 u
  /// for a course: time, s, from which to the end the RMS of error/u exceeds 2, or until which it
  /// does from the beginning, in windows of a twentieth of the readings (at least 10)
  std::optional<double> fails_from{}, fails_until{};
  /// whether an axis leaves the range of the fit by more than 2 % of it, or a channel by 10 %
  bool outside = false;
  /// Readings outside the range of the curves of the model: in none of the other members.
  std::size_t left_out = 0;
};

/// `unseen`: the same displacement at another time; `zero_kept`: the zero is that of the fit, not a
/// new unknown. u combines the scatter that the terms leave in `seen`, the parameters and, if
/// `zero_kept`, the zero (docs/model.md, "Heat and time").
Expected<Prediction> predict(const Part& seen, const std::vector<Term>& model, const Part& unseen,
                             bool zero_kept);

/// Predicts readings of an axis or of lines in space. The zeros of the unseen lines and the
/// parameters of the effects `set_up` are new unknowns. u combines the parameters, the new unknowns
/// and one reading. Errors: the parts have different axes or no lines, one has lengths and the
/// other angles, the seen readings do not determine the model or leave no degree of freedom, or the
/// unseen readings are outside the range of its curves.
Expected<Prediction> predict_places(const Part& seen, const std::vector<Term>& model,
                                    const Part& unseen, const std::vector<Term>& set_up);

}  // namespace nonio::model
