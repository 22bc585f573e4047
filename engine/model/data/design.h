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

/// Line of a reading: readings of one line share one unknown zero.
inline std::uint32_t line_of(const Observations& o, std::size_t i) {
  return o.line.empty() ? 0 : o.line[i];
}
inline std::size_t lines_of(const Observations& o) { return o.line.empty() ? 1 : o.lines.size(); }

/// The effect's columns, n x k; an error if the plugin gave anything else.
Expected<MatrixXd> columns_of(const Observations& o, const Term& term,
                              const std::vector<double>& shape);

/// The model with one more term, which takes the place of the same effect without groups.
std::vector<Term> with_term(std::vector<Term> model, Term term);

/// What of the catalogue can be added to a model: with groups, as differences in addition to an
/// effect that it has without them.
std::vector<Term> offered_to(const std::vector<Term>& model, const std::vector<Term>& catalogue);

/// Of the size of a curve's columns: what the readings must show beyond the terms before it. In
/// space what they show more weakly would have to be 30 times as large as what is read of it: two
/// curves that cancel each other to their last digits.
// docs/dev/constants.md, M42.
inline constexpr double curve_threshold = 1e-4, weakest_of_curve = 0.03;

/// Whether a term may determine less together with earlier terms than alone: curves in space, and
/// descriptions.
bool may_lose(const Observations& o, const Term& term);

/// The columns of all terms. Of a curve in space that the readings do not separate completely from
/// the terms before it (the odd parts of two straightnesses on two diagonals) only the identifiable
/// combinations; `lost`: how many of each term are not.
Expected<std::vector<MatrixXd>> blocks_of(const Observations& o, const std::vector<Term>& terms,
                                          const VectorXd& root, std::vector<Index>* lost = nullptr);

/// All combinations of the grids of a term's shapes, one empty combination if it has none; a shape
/// that the term has already is kept. Empty if the readings cannot show the effect.
std::vector<std::vector<double>> shapes_of(const Observations& o, const Term& term);

/// The value of a term's shape that needs no evidence, if it has one.
std::optional<double> usual_of(const Term& term, std::size_t k);
/// Whether a shape of a term has that value; whether all that have such a value have it.
bool is_usual(const Term& term, const std::vector<double>& shape, std::size_t k);
bool are_usual(const Term& term, const std::vector<double>& shape);

/// Uncertainties of the readings as their readers stated them; a reading without one counts as one
/// of mean uncertainty. Empty where none was stated.
std::vector<double> stated_u(const Observations& o);

/// Square root of the weight of each reading: sqrt(weight) * (mean u)/u.
VectorXd root_weights(const Observations& o, const std::vector<double>& weight);

/// Takes from each column its weighted mean in every line: what an unknown zero of each line takes.
/// Rows come in multiplied by their root weights and stay so.
void take_out_zeros(const Observations& o, const VectorXd& root_weight, MatrixXd& columns);

/// The same columns, each of unit length.
inline MatrixXd of_unit_length(MatrixXd columns) {
  const VectorXd length = columns.colwise().norm().cwiseMax(1e-300).transpose();
  for (Index k = 0; k < columns.cols(); ++k) columns.col(k) *= 1.0 / length(k);
  return columns;
}

/// Quantity of a parameter on this axis.
inline Quantity quantity_of(const Effect::Parameter& p, const Axis& axis) {
  return axis.rotary ? p.rotary : p.quantity;
}

/// `fit` with shapes that are near their best already: `searched`: terms whose shapes are searched
/// between neighbours of their grids.
Expected<Fit> fit_near(const Observations& o, std::vector<Term> terms,
                       const std::vector<char>& searched, std::vector<double> weight,
                       const Noise& noise = {});

/// `fit_near` whose shapes are their best: `searched` are unknowns of the uncertainty only.
Expected<Fit> fit_at(const Observations& o, std::vector<Term> terms,
                     const std::vector<char>& searched, std::vector<double> weight,
                     const Noise& noise);

/// `rms` of a fit with shapes that are given, without the rest of it; infinite where there is none.
double rms_with(const Observations& o, const std::vector<Term>& terms,
                const std::vector<double>& weight);

}  // namespace nonio::model
