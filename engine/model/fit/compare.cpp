// SPDX-License-Identifier: Apache-2.0
#include "compare.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "data/thin.h"
#include "nonio/math/distributions.h"
#include "places.h"

namespace nonio::model {

bool Comparison::fails() const {
  return std::any_of(places.begin(), places.end(),
                     [](const Place& place) { return place.p < place_p; });
}

std::vector<double> weights_without(std::size_t readings, const std::vector<Suspect>& suspects) {
  std::vector<double> weight(readings, 1.0);
  for (const Suspect& s : suspects) weight[s.row] = 0.0;
  return weight;
}

std::vector<double> cross_validated(const Observations& o, const std::vector<Term>& terms,
                                    const std::vector<double>& weight) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Index>> runs;
  std::map<std::uint32_t, int> of_line;
  for (std::size_t i = 0; i < o.size(); ++i) {
    auto& rows = runs[{line_of(o, i), o.run.empty() ? 1 : o.run[i]}];
    if (rows.empty()) ++of_line[line_of(o, i)];
    rows.push_back(static_cast<Index>(i));
  }
  if (std::none_of(of_line.begin(), of_line.end(), [](const auto& l) { return l.second > 1; }))
    return {};
  const auto n = static_cast<Index>(o.size()), lines = static_cast<Index>(lines_of(o));
  auto made = blocks_of(o, terms, root_weights(o, weight));
  if (!made) return {};
  std::vector<MatrixXd> blocks = std::move(*made);
  Index columns = lines;
  for (const MatrixXd& block : blocks) columns += block.cols();
  MatrixXd a = MatrixXd::Zero(n, columns);
  for (Index i = 0; i < n; ++i)
    a(i, static_cast<Index>(line_of(o, static_cast<std::size_t>(i)))) = 1.0;
  Index first = lines;
  for (MatrixXd& block : blocks) {
    a.middleCols(first, block.cols()) = block;
    first += block.cols();
    block.resize(0, 0);
  }
  const VectorXd scale = a.colwise().norm().cwiseMax(1e-300).transpose();
  a *= scale.cwiseInverse().asDiagonal();
  const Eigen::Map<const VectorXd> y(o.deviation.data(), n);
  const VectorXd root = root_weights(o, weight);
  // Each run's share of the normal equations; it is left out by taking its share away.
  const auto share_of = [&](const std::vector<Index>& rows, MatrixXd& normal, VectorXd& right) {
    const MatrixXd here = root(rows).asDiagonal() * a(rows, Eigen::all);
    normal.noalias() = here.transpose() * here;
    right.noalias() = here.transpose() * root(rows).cwiseProduct(y(rows));
  };
  MatrixXd normal = MatrixXd::Zero(columns, columns), share;
  VectorXd right = VectorXd::Zero(columns), right_share;
  for (const auto& [run, rows] : runs) {
    share_of(rows, share, right_share);
    normal += share;
    right += right_share;
  }
  std::vector<double> out(o.size(), std::numeric_limits<double>::quiet_NaN());
  for (const auto& [run, rows] : runs) {
    if (of_line[run.first] < 2) continue;
    share_of(rows, share, right_share);
    const Eigen::LDLT<MatrixXd> ldlt(normal - share);
    if (ldlt.info() != Eigen::Success ||
        !(ldlt.vectorD().minCoeff() > 1e-10 * ldlt.vectorD().maxCoeff()))
      continue;
    const VectorXd x = ldlt.solve(right - right_share);
    for (const Index i : rows) out[static_cast<std::size_t>(i)] = y(i) - a.row(i).dot(x);
  }
  return out;
}

std::optional<double> rms_of(const std::vector<double>& residual,
                             const std::vector<double>& weight) {
  double sum = 0.0, weights = 0.0;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    if (!std::isfinite(residual[i])) continue;
    sum += weight[i] * residual[i] * residual[i];
    weights += weight[i];
  }
  if (!(weights > 0.0)) return std::nullopt;
  return std::sqrt(sum / weights);
}

namespace {

std::optional<LackOfFit> lack_of_fit(const Fit& fit, const Saturated& repeats, double squares) {
  if (!(repeats.dof >= 3.0)) return std::nullopt;
  LackOfFit out;
  out.dof1 = static_cast<double>(fit.redundancy) - repeats.dof;
  out.dof2 = repeats.dof;
  if (!(out.dof1 >= 1.0)) return std::nullopt;
  out.F = math::test_ratio((squares - repeats.squares) / out.dof1, repeats.squares / repeats.dof);
  out.p = math::f_upper(out.F, out.dof1, out.dof2);
  return out;
}

/// Orthonormal columns of a fit, with root weights and without the zeros of lines.
MatrixXd basis_of(const Observations& o, const std::vector<Term>& terms, const VectorXd& root) {
  MatrixXd a(static_cast<Index>(o.size()), 0);
  const auto blocks = blocks_of(o, terms, root);
  if (!blocks) return a;
  for (const MatrixXd& block : *blocks) {
    a.conservativeResize(Eigen::NoChange, a.cols() + block.cols());
    a.rightCols(block.cols()) = root.asDiagonal() * block;
  }
  if (a.cols() == 0) return a;
  take_out_zeros(o, root, a);
  a = a * a.colwise().norm().cwiseMax(1e-300).cwiseInverse().asDiagonal();
  const Eigen::HouseholderQR<MatrixXd> qr(a);
  return qr.householderQ() * MatrixXd::Identity(a.rows(), a.cols());
}

}  // namespace

Comparison comparison_of(const Part& part, const Repeats& repeats, Fit fit,
                         std::vector<Suspect> suspects) {
  const Observations& o = part.table;
  Comparison out;
  out.suspects = std::move(suspects);
  double squares = 0.0;
  for (std::size_t i = 0; i < o.size(); ++i) {
    squares += fit.weight[i] * fit.residual[i] * fit.residual[i];
    if (fit.weight[i] > 0.0 && std::fabs(fit.residual[i]) > std::fabs(out.largest)) {
      out.largest = fit.residual[i];
      out.largest_row = i;
    }
  }
  const Saturated saturated = saturate(repeats, fit.residual, fit.weight);
  out.floor = noise_floor(saturated);
  out.lack_of_fit = lack_of_fit(fit, saturated, squares);
  out.cv_residual = cross_validated(o, fit.terms, fit.weight);
  out.cv_rms = rms_of(out.cv_residual, fit.weight);
  const VectorXd root = root_weights(o, fit.weight);
  const VectorXd residual = root.cwiseProduct(
      Eigen::Map<const VectorXd>(fit.residual.data(), static_cast<Index>(o.size())));
  if (o.size() <= thin_beyond || !can_be_thinned(o)) {
    const MatrixXd basis = basis_of(o, fit.terms, root);
    out.places = PlaceTests(part, repeats, root, basis, static_cast<double>(fit.redundancy))(
        residual, out.floor);
  }
  out.fit = std::move(fit);
  return out;
}

std::vector<Place> seats_in(const Part& part, const Repeats& repeats,
                            const Comparison& comparison) {
  constexpr double least_share = 0.02;
  const Fit& fit = comparison.fit;
  const VectorXd root = root_weights(part.table, fit.weight);
  const VectorXd residual = root.cwiseProduct(
      Eigen::Map<const VectorXd>(fit.residual.data(), static_cast<Index>(fit.residual.size())));
  const MatrixXd basis = basis_of(part.table, fit.terms, root);
  auto seats = seats_of({part, repeats, root, residual, basis, static_cast<double>(fit.redundancy),
                         comparison.floor});
  for (Place& seat : seats) seat.together = seat.where.find(" x ") != std::string::npos;
  std::erase_if(seats, [](const Place& place) { return !(place.share >= least_share); });
  return seats;
}

Expected<Comparison> compare_without(const Part& part, const std::vector<Term>& model,
                                     const Repeats& repeats, std::vector<Suspect> suspects) {
  auto weight = weights_without(part.table.size(), suspects);
  auto fitted = fit(part.table, model, std::move(weight));
  if (!fitted) return fail(fitted.error());
  return comparison_of(part, repeats, std::move(*fitted), std::move(suspects));
}

Expected<Comparison> compare(const Part& part, const std::vector<Term>& model) {
  if (part.table.size() == 0) return fail("there are no readings of an axis to compare with");
  const Repeats repeats(part.table);
  auto out = compare_without(part, model, repeats, suspects_of(part.table, repeats, model));
  if (!out) return out;
  if (part.table.size() <= thin_beyond || !can_be_thinned(part.table)) {
    if (out->fails()) out->seats = seats_in(part, repeats, *out);
    return out;
  }
  const Part thin = thinned(part, out->fit.weight);
  const Repeats of_thin(thin.table);
  auto of_means = compare_without(thin, out->fit.terms, of_thin, {});
  if (!of_means) return fail(of_means.error());
  if (of_means->fails()) out->seats = seats_in(thin, of_thin, *of_means);
  out->places = std::move(of_means->places);
  out->means = thin.table.size();
  return out;
}

}  // namespace nonio::model
