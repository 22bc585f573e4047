// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cycle.h"

/// The equations of the catalogue, used here only to state the truth and to see what a campaign
/// can show; no cause is made from them.
namespace nonio::hidden {

using Columns = std::vector<std::vector<double>>;

struct Projection {
  std::vector<double> coefficient;  ///< of each column; 0 of one that depends on those before it
  std::vector<double> left;
};
/// Least squares by Gram and Schmidt, twice.
Projection project(std::vector<double> signal, const Columns& columns);

/// Times as the file will give them: true ones, or the order of the readings.
std::vector<double> file_times(const Cycle& cycle, const Scenario& scenario);

/// Columns of an effect, its shape chosen to fit `signal` best together with a constant.
Columns best_columns(const std::string& kind, const std::vector<double>& signal, const Cycle& cycle,
                     const Scenario& scenario);

/// Names of the linear parameters, as many as columns; empty for a curve and where a search makes
/// the value depend on the shape.
std::vector<std::string> parameters_of(const std::string& kind);

/// Whether the readings can show every cause, and tell it from what looks like it.
bool shown(const Scenario& scenario);

}  // namespace nonio::hidden
