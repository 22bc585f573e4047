// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "nonio/model/comparison.h"

namespace nonio::model {

/// A fitted model applied to readings that it has not seen: only the zero may be new.
struct Prediction {
  std::vector<double> error;           ///< reading - prediction, of each reading, m or rad
  std::vector<double> u;               ///< its standard uncertainty, of each reading, m or rad
  double rms = 0.0;                    ///< of `error`, m or rad
  double sd = 0.0;                     ///< of the readings, m or rad: what no model would leave
  double inside = 0.0;                 ///< share of the readings with |error| <= 2 u
  std::optional<double> fails_from{};  ///< s: from here on the errors are larger than their U
  bool outside = false;  ///< a channel or an axis leaves the range that the model has seen
};

/// `zero_kept`: the zero is that of the fit, not a new unknown. `seen`: the part that the terms
/// were fitted to; `unseen`: the same displacement at another time. Uncertainty: from blocks of
/// `seen` that the fit has not seen, as far as `unseen` depends more on the parameters
/// (docs/model.md, "Heat and time").
Expected<Prediction> predict(const Part& seen, const std::vector<Term>& model, const Part& unseen,
                             bool zero_kept);

/// The same for readings at places (an axis, lines in space, a part): the zeros of the lines and the
/// `set_up` of the unseen readings (terms that are nuisances) are new unknowns. Uncertainty: of the
/// parameters, of the new unknowns and of one reading, from what the fit leaves. Errors: axes that
/// only one has, a model that the seen readings do not determine.
Expected<Prediction> predict_places(const Part& seen, const std::vector<Term>& model,
                                    const Part& unseen, const std::vector<Term>& set_up);

}  // namespace nonio::model
