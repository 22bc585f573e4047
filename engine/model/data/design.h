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

/// Returns the index of the line of a reading; the readings of one line share one unknown zero.
inline std::uint32_t line_of(const Observations& o, std::size_t i) {
  return o.line.empty() ? 0 : o.line[i];
}
inline std::size_t lines_of(const Observations& o) { return o.line.empty() ? 1 : o.lines.size(); }

/// Returns the effect's columns, n x k. Error: the plugin returned another size or values that are
/// not finite.
Expected<MatrixXd> columns_of(const Observations& o, const Term& term,
                              const std::vector<double>& shape);

/// Returns the model with the term added. A term with groups replaces the term of the same effect
/// without groups.
std::vector<Term> with_term(std::vector<Term> model, Term term);

/// Returns the terms of the catalogue that can be added to a model. An effect that the model has
/// without groups is offered with groups as differences between them.
std::vector<Term> offered_to(const std::vector<Term>& model, const std::vector<Term>& catalogue);

/// Smallest part of the size of a curve's columns that must remain after the earlier terms are
/// removed. In space, a weaker combination would need coefficients 30 times as large as the
/// readings: two curves that cancel nearly completely.
/// docs/dev/constants.md, M42.
inline constexpr double curve_threshold = 1e-4, weakest_of_curve = 0.03;

/// Whether some combinations of the term's columns may be removed because earlier terms determine
/// them: true for curves in space, and descriptions.
bool may_lose(const Observations& o, const Term& term);

/// Returns the columns of all terms. For a curve in space that the readings do not completely
/// separate from the earlier terms (the odd parts of two straightnesses on two diagonals), and for
/// a description, it returns only the identifiable combinations. `lost`: number of removed
/// combinations of each term.
Expected<std::vector<MatrixXd>> blocks_of(const Observations& o, const std::vector<Term>& terms,
                                          const VectorXd& root, std::vector<Index>* lost = nullptr);

/// Returns all combinations of the grids of a term's shapes; one empty combination if it has no
/// shape. A shape that the term already has is kept. Empty if the effect is not identifiable from
/// the readings.
std::vector<std::vector<double>> shapes_of(const Observations& o, const Term& term);

/// Returns the usual value of shape k of a term (`Effect::Shape::usual`), which needs no evidence;
/// none if it has none.
std::optional<double> usual_of(const Term& term, std::size_t k);
/// `is_usual` returns whether shape k has its usual value, `are_usual` whether all shapes that have
/// a usual value have it.
bool is_usual(const Term& term, const std::vector<double>& shape, std::size_t k);
bool are_usual(const Term& term, const std::vector<double>& shape);

/// Returns the uncertainties of the readings as their readers stated them; a reading without one
/// gets the mean. Empty if none was stated.
std::vector<double> stated_u(const Observations& o);

/// Returns the square root of the weight of each reading: sqrt(weight) * (mean u)/u.
VectorXd root_weights(const Observations& o, const std::vector<double>& weight);

/// Removes from each column its weighted mean in every line, because the unknown zero of the line
/// absorbs it. The rows of `columns` are already multiplied by their root weights.
void take_out_zeros(const Observations& o, const VectorXd& root_weight, MatrixXd& columns);

/// Scales each column to unit length.
inline MatrixXd of_unit_length(MatrixXd columns) {
  const VectorXd length = columns.colwise().norm().cwiseMax(1e-300).transpose();
  for (Index k = 0; k < columns.cols(); ++k) columns.col(k) *= 1.0 / length(k);
  return columns;
}

/// Returns the quantity of a parameter on this axis.
inline Quantity quantity_of(const Effect::Parameter& p, const Axis& axis) {
  return axis.rotary ? p.rotary : p.quantity;
}

/// Fits terms whose shapes are already near their optimum: the shapes of terms in `searched` are
/// optimized between adjacent values of their grids.
Expected<Fit> fit_near(const Observations& o, std::vector<Term> terms,
                       const std::vector<char>& searched, std::vector<double> weight,
                       const Noise& noise = {});

/// Fits terms whose shapes are optimal: the shapes of terms in `searched` are unknowns in the
/// uncertainty only.
Expected<Fit> fit_at(const Observations& o, std::vector<Term> terms,
                     const std::vector<char>& searched, std::vector<double> weight,
                     const Noise& noise);

/// Returns only the RMS of a fit with given shapes; infinite if the fit fails.
double rms_with(const Observations& o, const std::vector<Term>& terms,
                const std::vector<double>& weight);

}  // namespace nonio::model
