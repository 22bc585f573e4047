// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/observations.h"
#include "nonio/sdk/plugin.h"

namespace nonio::model {

/// An effect on one axis, or of what an effect in space is of (then `axis` has only that name).
struct Term {
  const Effect* effect = nullptr;
  Axis axis;
  std::vector<double> shape{};  ///< empty: searched, if the effect has shapes

  std::string name() const { return effect->info.name + ":" + axis.name; }
};

struct Parameter {
  std::string effect;  ///< "backlash:X"
  std::string name;    ///< "b"
  double value = 0.0;
  double u = 0.0;  ///< standard uncertainty; NaN for a shape that takes only discrete values
  Quantity quantity = Quantity::number;
  bool shape = false;
};

struct Fit {
  std::vector<Term> terms;                       ///< with the shapes that were found
  std::vector<Parameter> parameters;             ///< term by term: linear ones, then shapes
  std::vector<std::vector<double>> correlation;  ///< of `parameters`
  std::vector<double> zero;                      ///< of each line, m or rad
  std::vector<double> residual;                  ///< of each reading, m or rad
  std::vector<double> weight;  ///< of each reading, 0..1: small where it is a suspected misreading
  std::vector<std::vector<double>> part;  ///< what each term says of each reading, m or rad
  /// Of each term: columns of a curve that these readings cannot tell from the terms before it
  /// (the odd part of a second straightness on two diagonals). They are counted to those.
  std::vector<std::size_t> lost{};
  double rms = 0.0;            ///< of the weighted residuals, m or rad
  double s = 0.0;              ///< standard deviation of a reading, from residuals and redundancy
  std::size_t redundancy = 0;  ///< readings less unknowns
};

/// Weighted least squares: deviation = zero of its line + sum of columns * parameters + e, by QR
/// with pivoting on columns of unit length. Shapes that are not given are searched on their grids,
/// one after the other until nothing improves, then between the grid's values; their uncertainty is
/// that of the linearised problem. `weight` (0..1 a reading, or empty) is for suspected
/// misreadings. Parameters that the readings cannot tell apart are an error that names them; there
/// is no minimum-norm guess. Source: GUM-6:2020 9 for the covariance.
Expected<Fit> fit(const Observations& observations, std::vector<Term> terms,
                  std::vector<double> weight = {});

}  // namespace nonio::model
