// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/plugin.h"

namespace nonio::model {

/// An effect on one axis, with its shape parameters fixed.
struct Term {
  const Effect* effect = nullptr;
  Axis axis;
  std::vector<double> shape{};
};

struct Parameter {
  std::string name;  ///< "backlash:X b"
  double value = 0.0;
  double u = 0.0;  ///< standard uncertainty, from the residuals unless the readings carry their own
  Quantity quantity = Quantity::number;
};

struct Fit {
  std::vector<Parameter> parameters;
  std::vector<std::vector<double>> correlation;
  std::vector<double> zero;      ///< of each line, m or rad
  std::vector<double> residual;  ///< of each reading, m or rad
  double rms = 0.0;              ///< of the residuals
  std::size_t redundancy = 0;    ///< readings less unknowns
};

/// Weighted least squares by column-pivoted QR: deviation = zero of the line + sum of columns *
/// parameters. Columns are scaled to unit length before the rank is judged. Parameters that the
/// readings cannot tell apart are an error that names them; there is no minimum-norm guess.
Expected<Fit> fit(const Observations& observations, const std::vector<Term>& terms);

}  // namespace nonio::model
