// SPDX-License-Identifier: Apache-2.0
#include "compare.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "course/course.h"
#include "data/noise.h"
#include "data/thin.h"
#include "nonio/math/distributions.h"

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
  // Computes the contribution of a run to the normal equations; subtracting it omits the run.
  const auto share_of = [&](const std::vector<Index>& rows, MatrixXd& normal, VectorXd& right) {
    const MatrixXd here = root(rows).asDiagonal() * a(rows, Eigen::all);
    normal = math::transposed_product(here, here);
    right = math::transposed_times(here, root(rows).cwiseProduct(y(rows)));
  };
  MatrixXd normal = MatrixXd::Zero(columns, columns), share;
  VectorXd right = VectorXd::Zero(columns), right_share;
  for (const auto& [run, rows] : runs) {
    share_of(rows, share, right_share);
    normal += share;
    right += right_share;
  }
  // Least ratio of the smallest to the largest pivot, for columns of unit length: if the other runs
  // hardly determine a direction, their prediction is noise, amplified hundreds of times.
  constexpr double predicts = 1e-5;
  std::vector<double> out(o.size(), std::numeric_limits<double>::quiet_NaN());
  for (const auto& [run, rows] : runs) {
    if (of_line[run.first] < 2) continue;
    share_of(rows, share, right_share);
    const Eigen::LDLT<MatrixXd> ldlt(MatrixXd(normal - share));
    if (ldlt.info() != Eigen::Success ||
        !(ldlt.vectorD().minCoeff() > predicts * ldlt.vectorD().maxCoeff()))
      continue;
    const VectorXd x = math::solution(ldlt, right - right_share);
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

/// `squares`: sum over the whitened residuals; `repeats`: degrees of freedom of the repeats.
/// Returns std::nullopt without a floor or a degree of freedom.
std::optional<LackOfFit> lack_of_fit(const Fit& fit, const std::optional<NoiseFloor>& floor,
                                     double repeats, double squares) {
  if (!floor) return std::nullopt;
  LackOfFit out;
  out.dof1 = static_cast<double>(fit.redundancy) - repeats;
  out.dof2 = floor->dof;
  if (!(out.dof1 >= 1.0)) return std::nullopt;
  const double s2 = floor->s * floor->s;
  out.F = math::test_ratio(std::max(squares - s2 * repeats, 0.0) / out.dof1, s2);
  out.p = math::f_upper(out.F, out.dof1, out.dof2);
  return out;
}

/// Returns orthonormal columns of a fit, whitened and without the zeros of lines.
MatrixXd basis_of(const Observations& o, const std::vector<Term>& terms, const Whitening& white) {
  MatrixXd a(static_cast<Index>(o.size()), 0);
  const auto blocks = blocks_of(o, terms, white.root());
  if (!blocks) return a;
  for (const MatrixXd& block : *blocks) {
    a.conservativeResize(Eigen::NoChange, a.cols() + block.cols());
    a.rightCols(block.cols()) = white(block);
  }
  if (a.cols() == 0) return a;
  white.take_out_zeros(a);
  a = of_unit_length(std::move(a));
  const Eigen::HouseholderQR<MatrixXd> qr(a);
  return math::orthonormal(qr, a.cols());
}

VectorXd white_residual(const Fit& fit, const Whitening& white) {
  return white(
      Eigen::Map<const VectorXd>(fit.residual.data(), static_cast<Index>(fit.residual.size())));
}

}  // namespace

PlacesLeft::PlacesLeft(const Part& part, const Repeats& repeats, const Fit& fit, const Noise& noise)
    : white_(part.table, fit.weight, noise),
      basis_(basis_of(part.table, fit.terms, white_)),
      tests_(part, repeats, white_, basis_, static_cast<double>(fit.redundancy)) {}

std::vector<Place> PlacesLeft::operator()(const std::vector<double>& residual,
                                          const std::optional<NoiseFloor>& floor,
                                          double least) const {
  VectorXd e =
      white_(Eigen::Map<const VectorXd>(residual.data(), static_cast<Index>(residual.size())));
  MatrixXd free = e;
  white_.take_out_zeros(free);
  if (basis_.cols() > 0) math::take_out(basis_, free);
  return tests_(free.col(0), floor, least);
}

namespace {

/// If adjacent readings are correlated and some place is significant, p is the largest one for
/// three correlations: the estimate, none, and the estimate plus twice its standard uncertainty,
/// because few readings determine the correlation poorly.
std::vector<Place> places_left(const Part& part, const Repeats& repeats, const Fit& fit,
                               const Saturated& saturated, const std::vector<double>& weight) {
  const auto tested = [&](const Noise& noise) {
    const Whitening white(part.table, fit.weight, noise);
    const MatrixXd basis = basis_of(part.table, fit.terms, white);
    const PlaceTests tests(part, repeats, white, basis, static_cast<double>(fit.redundancy));
    return tests(white_residual(fit, white), noise_floor(repeats, saturated, weight, noise));
  };
  Noise noise = Whitening::of_repeats(fit.noise);
  std::vector<Place> places = tested(noise);
  if (noise.independent() || std::none_of(places.begin(), places.end(),
                                          [](const Place& place) { return place.p < place_p; }))
    return places;
  constexpr double largest = 0.95;
  const double high = std::min(noise.in_repeats + 2.0 * noise.u_neighbours, largest);
  for (const double rho : {0.0, high}) {
    noise.neighbours = noise.in_repeats = rho;
    const std::vector<Place> others = tested(noise);
    for (Place& place : places)
      for (const Place& other : others)
        if (other.where == place.where && other.line == place.line)
          place.p = std::max(place.p, other.p);
  }
  return places;
}

}  // namespace

Comparison comparison_of(const Part& part, const Repeats& repeats, Fit fit,
                         std::vector<Suspect> suspects) {
  const Observations& o = part.table;
  Comparison out;
  out.suspects = std::move(suspects);
  for (std::size_t i = 0; i < o.size(); ++i) {
    if (fit.weight[i] > 0.0 && std::fabs(fit.residual[i]) > std::fabs(out.largest)) {
      out.largest = fit.residual[i];
      out.largest_row = i;
    }
  }
  const std::vector<double> weight = with_scatter(fit.weight, fit.noise);
  const Saturated saturated = saturate(repeats, fit.residual, weight);
  out.floor = noise_floor(repeats, saturated, weight, fit.noise);
  out.cv_residual = cross_validated(o, fit.terms, fit.weight);
  out.cv_rms = rms_of(out.cv_residual, fit.weight);
  const bool placed = o.size() <= thin_beyond || !can_be_thinned(o);
  const Whitening white(o, fit.weight, Whitening::of_repeats(fit.noise));
  out.lack_of_fit =
      lack_of_fit(fit, out.floor, saturated.dof, white_residual(fit, white).squaredNorm());
  if (placed) out.places = places_left(part, repeats, fit, saturated, weight);
  out.fit = std::move(fit);
  return out;
}

std::vector<Place> seats_in(const Part& part, const Repeats& repeats,
                            const Comparison& comparison) {
  // docs/dev/constants.md, M20.
  constexpr double least_share = 0.02;
  const Fit& fit = comparison.fit;
  const Whitening white(part.table, fit.weight, Whitening::of_repeats(fit.noise));
  const MatrixXd basis = basis_of(part.table, fit.terms, white);
  const VectorXd residual = white_residual(fit, white);
  auto seats = seats_of({part, repeats, white, residual, basis, static_cast<double>(fit.redundancy),
                         comparison.floor});
  for (Place& seat : seats) seat.together = seat.where.second.has_value();
  std::erase_if(seats, [](const Place& place) { return !(place.share >= least_share); });
  return seats;
}

std::vector<char> searched_in(const std::vector<Term>& terms) {
  std::vector<char> out;
  for (const Term& term : terms) out.push_back(term.shape.empty() && !term.effect->shapes.empty());
  return out;
}

Expected<Fit> with_its_zero(const Observations& o, Fit fitted, const std::vector<char>& searched) {
  const Noise noise = with_zero(o, fitted.terms, fitted.weight, fitted.noise);
  if (noise.zero == Noise::Zero::steady && noise.neighbours == fitted.noise.neighbours)
    return fitted;
  auto again = fit_at(o, fitted.terms, searched, fitted.weight, noise);
  if (!again) return fitted;
  return again;
}

namespace {

Ground ground_of(const Part& part, Repeats repeats, std::vector<Suspect> suspects) {
  Ground out{std::move(repeats), std::move(suspects)};
  out.weight = weights_without(part.table.size(), out.suspects);
  out.noise = noise_of(part, out.repeats, out.weight);
  return out;
}

Groundwork::Found found_in(const Part& part, const std::vector<Term>& model) {
  // In a course, successive readings replace repeats.
  if (part.kind == Part::Kind::course) return {Ground{Repeats(Observations{})}};
  Repeats repeats(part.table);
  auto suspects = suspects_of(part.table, repeats, model);
  Groundwork::Found out{ground_of(part, std::move(repeats), std::move(suspects))};
  if (part.table.size() <= thin_beyond || !can_be_thinned(part.table)) return out;
  out.thin = thinned(part, out.whole.weight);
  out.of_thin = ground_of(*out.thin, Repeats(out.thin->table), {});
  return out;
}

}  // namespace

Groundwork::Groundwork(const Part& part, const std::vector<Term>& model)
    : found_(std::make_unique<const Found>(found_in(part, model))) {}
Groundwork::Groundwork(Groundwork&&) noexcept = default;
Groundwork::~Groundwork() = default;

Expected<Comparison> compare_on(const Part& part, const std::vector<Term>& model,
                                const Ground& ground, const Observations* thin) {
  auto fitted = fit(part.table, model, ground.weight, ground.noise, thin);
  if (!fitted) return fail(fitted.error());
  fitted = with_its_zero(part.table, std::move(*fitted), searched_in(model));
  if (!fitted) return fail(fitted.error());
  return comparison_of(part, ground.repeats, std::move(*fitted), ground.suspects);
}

Expected<Comparison> compare(const Part& part, const std::vector<Term>& model,
                             const Groundwork* known, const Fitted& fitted) {
  if (part.table.size() == 0) return fail("there are no readings of an axis to compare with");
  if (part.kind == Part::Kind::course) return compare_course(part, model);
  const GroundworkOf ground(part, model, known);
  auto out = compare_on(part, model, ground->whole, ground->thin ? &ground->thin->table : nullptr);
  if (!out) return out;
  if (!ground->thin) {
    if (out->fails()) out->seats = seats_in(part, ground->whole.repeats, *out);
    return out;
  }
  const Part& thin = *ground->thin;
  out->means = thin.table.size();
  if (fitted) fitted(*out);
  NONIO_TRY(auto of_means, compare_on(thin, out->fit.terms, *ground->of_thin));
  if (of_means.fails()) out->seats = seats_in(thin, ground->of_thin->repeats, of_means);
  out->places = std::move(of_means.places);
  return out;
}

}  // namespace nonio::model
