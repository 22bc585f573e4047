// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "dense.h"
#include "nonio/model/fit.h"

namespace nonio::model {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The readings of one line share one unknown zero.
inline std::uint32_t line_of(const Observations& o, std::size_t i) {
  return o.line.empty() ? 0 : o.line[i];
}
inline std::size_t lines_of(const Observations& o) { return o.line.empty() ? 1 : o.lines.size(); }

/// One row per reading. In tables of several axes, the columns contain the component along the
/// direction of sensing; a term with groups has a block of columns for each group, a term with
/// given parameters has none. Error: the plugin fails or returns a wrong size or values that are
/// not finite.
Expected<MatrixXd> columns_of(const Observations& o, const Term& term,
                              const std::vector<double>& shape);

/// A term with groups replaces the term of the same effect without groups.
std::vector<Term> with_term(std::vector<Term> model, Term term);

/// An effect that the model has without groups can be added only as differences between groups.
std::vector<Term> offered_to(const std::vector<Term>& model, const std::vector<Term>& catalogue);

/// A combination of the columns of a curve is identifiable if this part of its size remains after
/// the earlier terms are removed, on an axis and in space. A weaker combination in space would need
/// coefficients 30 times as large as the readings: docs/dev/constants.md, M42.
inline constexpr double curve_threshold = 1e-4, weakest_of_curve = 0.03;

/// Returns whether earlier terms may determine combinations of the columns of the term: true for
/// curves in space, and for descriptions that are curves.
bool may_lose(const Observations& o, const Term& term);

/// Columns of all terms; of curves in space, and of descriptions that are curves, only the
/// identifiable combinations, or all columns if no combination is identifiable. `root`: root
/// weights of the readings; `lost`: number of removed combinations of each term.
Expected<std::vector<MatrixXd>> blocks_of(const Observations& o, const std::vector<Term>& terms,
                                          const VectorXd& root, std::vector<Index>* lost = nullptr);

/// Combinations of the grids, with stated values added; one empty combination without shapes. If
/// the term already has shapes, only these. Empty if the effect is not identifiable.
std::vector<std::vector<double>> shapes_of(const Observations& o, const Term& term);

/// The value that another measurement states, otherwise the usual value (`Effect::Shape::usual`).
std::optional<double> usual_of(const Term& term, std::size_t k);
/// Whether shape k, or every shape that has a usual value, has its usual value.
bool is_usual(const Term& term, const std::vector<double>& shape, std::size_t k);
bool are_usual(const Term& term, const std::vector<double>& shape);

/// A reading without a stated uncertainty gets the mean; empty if none was stated.
std::vector<double> stated_u(const Observations& o);

/// sqrt(weight) (mean u)/u of each reading. A factor whose values are not given is 1.
VectorXd root_weights(const Observations& o, const std::vector<double>& weight);

/// The zero of a line absorbs the weighted mean. `columns` are already multiplied by root weights.
void take_out_zeros(const Observations& o, const VectorXd& root_weight, MatrixXd& columns);

/// Columns of zeros remain zero.
inline MatrixXd of_unit_length(MatrixXd columns) {
  const VectorXd length = columns.colwise().norm().cwiseMax(1e-300).transpose();
  for (Index k = 0; k < columns.cols(); ++k) columns.col(k) *= 1.0 / length(k);
  return columns;
}

inline Quantity quantity_of(const Effect::Parameter& p, const Axis& axis) {
  return axis.rotary ? p.rotary : p.quantity;
}

/// Optimizes near-optimal shapes of the terms t with `searched[t]`: between adjacent grid values,
/// or with more than `thin_beyond` readings by at most two Gauss-Newton steps.
Expected<Fit> fit_near(const Observations& o, std::vector<Term> terms,
                       const std::vector<char>& searched, std::vector<double> weight,
                       const Noise& noise = {});

/// The shapes of the terms t with `searched[t]` are unknowns in the uncertainty only.
Expected<Fit> fit_at(const Observations& o, std::vector<Term> terms,
                     const std::vector<char>& searched, std::vector<double> weight,
                     const Noise& noise);

/// RMS of a fit with given shapes; infinite if the fit fails.
double rms_with(const Observations& o, const std::vector<Term>& terms,
                const std::vector<double>& weight);

}  // namespace nonio::model
