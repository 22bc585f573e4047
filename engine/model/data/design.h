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

/// Returns the columns of a term, with one row per reading. In tables of several axes the columns
/// of an axis contain the component along the direction of sensing; a term with groups has a block
/// of columns for each group, and a term whose parameters are given has no columns. An error if the
/// plugin fails, or returns another size or values that are not finite.
Expected<MatrixXd> columns_of(const Observations& o, const Term& term,
                              const std::vector<double>& shape);

/// Returns the model with the term added. A term with groups replaces the term of the same effect
/// without groups.
std::vector<Term> with_term(std::vector<Term> model, Term term);

/// Returns the terms of the catalogue that can be added to a model. An effect that the model has
/// without groups can be added only with groups, as differences between the groups.
std::vector<Term> offered_to(const std::vector<Term>& model, const std::vector<Term>& catalogue);

/// A combination of the columns of a curve is identifiable if at least this part of their size
/// remains after the earlier terms are removed: `curve_threshold` on an axis, `weakest_of_curve` in
/// space. In space, a weaker combination would need coefficients 30 times as large as the readings:
/// two curves that cancel nearly completely. docs/dev/constants.md, M42.
inline constexpr double curve_threshold = 1e-4, weakest_of_curve = 0.03;

/// Returns whether some combinations of the term's columns may be removed because earlier terms
/// determine them: true for curves in space, and for descriptions that are curves.
bool may_lose(const Observations& o, const Term& term);

/// Returns the columns of all terms. For a curve in space that the readings do not completely
/// separate from the earlier terms (the odd parts of two straightnesses on two diagonals), and for
/// a description that is a curve, it returns only the identifiable combinations, or all columns if
/// none is identifiable. `root`: root weights of the readings; `lost`: number of removed
/// combinations of each term.
Expected<std::vector<MatrixXd>> blocks_of(const Observations& o, const std::vector<Term>& terms,
                                          const VectorXd& root, std::vector<Index>* lost = nullptr);

/// Returns all combinations of the grids of a term's shapes; one empty combination if it has no
/// shape. A stated value of a shape is added to its grid. If the term already has shapes, only
/// these are returned. Empty if the effect is not identifiable from the readings.
std::vector<std::vector<double>> shapes_of(const Observations& o, const Term& term);

/// Returns the value of shape k of a term that needs no evidence: the value that another
/// measurement states, otherwise the usual value (`Effect::Shape::usual`); none without either.
std::optional<double> usual_of(const Term& term, std::size_t k);
/// `is_usual` returns whether shape k has its usual value, `are_usual` whether all shapes that have
/// a usual value have it.
bool is_usual(const Term& term, const std::vector<double>& shape, std::size_t k);
bool are_usual(const Term& term, const std::vector<double>& shape);

/// Returns the uncertainties of the readings as their readers stated them; a reading without one
/// gets the mean. Empty if none was stated.
std::vector<double> stated_u(const Observations& o);

/// Returns the square root of the weight of each reading: sqrt(weight) * (mean u)/u. The factor
/// (mean u)/u is 1 if no u is stated, and sqrt(weight) is 1 if `weight` is empty.
VectorXd root_weights(const Observations& o, const std::vector<double>& weight);

/// Removes from each column its weighted mean in every line, because the unknown zero of the line
/// absorbs it. The rows of `columns` are already multiplied by their root weights.
void take_out_zeros(const Observations& o, const VectorXd& root_weight, MatrixXd& columns);

/// Returns the columns scaled to unit length; columns of zeros remain zero.
inline MatrixXd of_unit_length(MatrixXd columns) {
  const VectorXd length = columns.colwise().norm().cwiseMax(1e-300).transpose();
  for (Index k = 0; k < columns.cols(); ++k) columns.col(k) *= 1.0 / length(k);
  return columns;
}

/// Returns the quantity of a parameter, which differs between linear and rotary axes.
inline Quantity quantity_of(const Effect::Parameter& p, const Axis& axis) {
  return axis.rotary ? p.rotary : p.quantity;
}

/// Fits terms whose shapes are already near their optimum. The shapes of the terms t with
/// `searched[t]` are optimized: between adjacent values of their grids, or with more than
/// `thin_beyond` readings by at most two Gauss-Newton steps.
Expected<Fit> fit_near(const Observations& o, std::vector<Term> terms,
                       const std::vector<char>& searched, std::vector<double> weight,
                       const Noise& noise = {});

/// Fits terms whose shapes are optimal. The shapes of the terms t with `searched[t]` are unknowns
/// in the uncertainty only.
Expected<Fit> fit_at(const Observations& o, std::vector<Term> terms,
                     const std::vector<char>& searched, std::vector<double> weight,
                     const Noise& noise);

/// Returns only the RMS of a fit with given shapes; infinite if the fit fails.
double rms_with(const Observations& o, const std::vector<Term>& terms,
                const std::vector<double>& weight);

}  // namespace nonio::model
