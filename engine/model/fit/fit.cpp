// SPDX-License-Identifier: Apache-2.0
#include "nonio/model/fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "data/design.h"
#include "data/thin.h"
#include "data/whitening.h"
#include "interpolation.h"
#include "nonio/math/golden_section.h"
#include "nonio/model/measurements.h"
#include "nonio/sdk/axis_readings.h"
#include "workbench.h"

namespace nonio::model {

namespace {

// The polynomial Filip (NIST StRD), the most difficult reference problem, passes with this
// threshold; columns that agree to twelve digits do not.
constexpr double rank_threshold = 1e-12;

struct Design {
  MatrixXd a;                      // whitened rows; zeros of lines first, then terms
  std::vector<std::string> names;  // name of the line or term of each column
  std::vector<Index> first;        // first column of each term, and the end
  std::vector<MatrixXd> blocks;
  // number of columns of a curve that the readings do not separate from others, per term
  std::vector<Index> lost;
};

Expected<Design> design_of(const Observations& o, const std::vector<Term>& terms,
                           const Whitening& white) {
  const auto n = static_cast<Index>(o.size());
  const auto lines = static_cast<Index>(lines_of(o));
  Design d;
  Index columns = lines;
  for (Index k = 0; k < lines; ++k) d.names.push_back("the zero of line " + std::to_string(k + 1));
  NONIO_TRY(auto blocks, blocks_of(o, terms, white.root(), &d.lost));
  d.blocks = std::move(blocks);
  for (std::size_t t = 0; t < terms.size(); ++t) {
    d.first.push_back(columns);
    columns += d.blocks[t].cols();
    for (Index k = 0; k < d.blocks[t].cols(); ++k) d.names.push_back(terms[t].name());
  }
  d.first.push_back(columns);
  d.a.setZero(n, columns);
  for (Index i = 0; i < n; ++i)
    d.a(i, static_cast<Index>(line_of(o, static_cast<std::size_t>(i)))) = 1.0;
  d.a.leftCols(lines) = white(d.a.leftCols(lines));
  for (std::size_t t = 0; t < terms.size(); ++t)
    d.a.middleCols(d.first[t], d.blocks[t].cols()) = white(d.blocks[t]);
  return d;
}

/// Columns with at least 5 % of the largest component in a null direction.
std::string inseparable(const MatrixXd& scaled, const std::vector<std::string>& names) {
  const Eigen::JacobiSVD<MatrixXd> svd(math::transposed_product(scaled, scaled),
                                       Eigen::ComputeThinV);
  const VectorXd direction = svd.matrixV().col(scaled.cols() - 1).cwiseAbs();
  std::string text;
  for (Index k = 0; k < direction.size(); ++k) {
    const std::string& name = names[static_cast<std::size_t>(k)];
    if (direction(k) > 0.05 * direction.maxCoeff() && text.find(name) == std::string::npos)
      text += (text.empty() ? "" : ", ") + name;
  }
  return text;
}

struct Solution {
  VectorXd x;
  MatrixXd cofactor;     // cofactor matrix, (A^T W A)^-1
  double squares = 0.0;  // weighted sum of squared residuals
};

/// `weighted`: readings, whitened like the design. The error names columns that are not separable.
Expected<Solution> solve(const Design& d, const VectorXd& weighted) {
  const Index unknowns = d.a.cols();
  VectorXd scale = d.a.colwise().norm().transpose();
  for (Index k = 0; k < unknowns; ++k)
    if (!(scale(k) > 0.0))
      return fail("the readings cannot show " + d.names[static_cast<std::size_t>(k)]);
  const MatrixXd a = math::scaled_columns(d.a, scale.cwiseInverse());
  Eigen::ColPivHouseholderQR<MatrixXd> qr(a);
  qr.setThreshold(rank_threshold);
  if (qr.rank() < unknowns)
    return fail("not separable with these readings: " + inseparable(a, d.names));
  Solution s;
  VectorXd scaled = math::solution(qr, weighted);
  scaled += math::solution(qr, math::residual(weighted, a, scaled));  // one step of refinement
  s.x = scaled.cwiseQuotient(scale);
  s.squares = math::squared_residual(weighted, a, scaled);
  // (A^T A)^-1 = P R^-1 R^-T P^T
  const MatrixXd r_inverse = math::inverse_of_upper(qr.matrixR().topLeftCorner(unknowns, unknowns));
  const MatrixXd half = math::scaled_rows(scale.cwiseInverse(), qr.colsPermutation() * r_inverse);
  s.cofactor = math::product_transposed(half, half);
  return s;
}

/// Returns the weighted sum of squared residuals with these shapes; infinite if the fit fails.
double squares_with(const Observations& o, const std::vector<Term>& terms, const Whitening& white,
                    const VectorXd& y) {
  auto d = design_of(o, terms, white);
  if (!d) return std::numeric_limits<double>::infinity();
  const VectorXd rotated = math::rotated(Eigen::HouseholderQR<MatrixXd>(d->a), white(y));
  return rotated.tail(rotated.size() - d->a.cols()).squaredNorm();
}

/// The columns of the other terms are eliminated once.
class SquaresOf {
 public:
  SquaresOf(const Observations& o, const std::vector<Term>& terms, std::size_t t,
            const Whitening& white, const VectorXd& y)
      : o_(o), white_(white), left_(white(y)) {
    std::vector<Term> others = terms;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(t));
    auto d = design_of(o, others, white);
    if (!d) return;
    const MatrixXd scaled = of_unit_length(std::move(d->a));
    const Eigen::HouseholderQR<MatrixXd> qr(scaled);
    others_ = math::orthonormal(qr, scaled.cols());
    math::take_out(others_, left_);
  }

  /// Infinite if the columns of the term cannot be computed.
  double operator()(const Term& term) const {
    auto block = columns_of(o_, term, term.shape);
    if (!block) return std::numeric_limits<double>::infinity();
    *block = white_(*block);
    if (others_.cols() > 0) math::take_out(others_, *block);
    const Eigen::HouseholderQR<MatrixXd> qr(*block);
    const VectorXd rotated = math::rotated(qr, left_);
    return rotated.tail(rotated.size() - block->cols()).squaredNorm();
  }

 private:
  const Observations& o_;
  const Whitening& white_;
  VectorXd left_;
  MatrixXd others_;
};

/// Optimizes between adjacent grid values; a shape that has its usual value is unchanged.
void refine(const Observations& o, std::vector<Term>& terms, std::size_t t, std::size_t k,
            const Whitening& white, const VectorXd& y) {
  const std::vector<double> grid = terms[t].effect->shapes[k].grid(o, terms[t].axis);
  if (grid.empty() || is_usual(terms[t], terms[t].shape, k)) return;
  double& value = terms[t].shape[k];
  const double same = 1e-12 * std::max(std::fabs(value), grid.back() - grid.front());
  const auto above = std::upper_bound(grid.begin(), grid.end(), value + same);
  const auto below = std::lower_bound(grid.begin(), grid.end(), value - same);
  double low = below == grid.begin() ? value : *std::prev(below);
  double high = above == grid.end() ? value : *above;
  if (!(low < high)) return;
  const SquaresOf squares_of(o, terms, t, white, y);
  const auto at = [&](double x) {
    value = x;
    return squares_of(terms[t]);
  };
  const double start = value, squares = at(start);
  const double fine = 1e-7 * std::max(std::fabs(low), std::fabs(high));
  const math::Bracket bracket = math::golden_section(at, low, high, 40, fine);
  const double middle = (bracket.low + bracket.high) / 2.0;
  value = at(middle) <= squares ? middle : start;
}

Expected<void> start_shapes(const Observations& o, std::vector<Term>& terms,
                            const std::vector<char>& searched, const std::vector<double>& weight,
                            const Noise& noise) {
  const Workbench bench(o, terms, weight, {}, 0, nullptr, noise);
  NONIO_TRY(auto best, bench.best_shapes());
  for (std::size_t t = 0; t < terms.size(); ++t)
    if (searched[t]) terms[t].shape = best[t];
  return {};
}

void refine_shapes(const Observations& o, std::vector<Term>& terms,
                   const std::vector<char>& searched, const Whitening& white, const VectorXd& y) {
  std::size_t continuous = 0;
  for (std::size_t t = 0; t < terms.size(); ++t)
    for (const Effect::Shape& shape : terms[t].effect->shapes)
      continuous += searched[t] && shape.continuous;
  // Shapes are optimized one after the other; correlated shapes of a large effect need more rounds.
  constexpr std::size_t fewest = 2, most = 8;
  constexpr double still_better = 1e-3;
  double before = std::numeric_limits<double>::infinity();
  for (std::size_t round = 0; round < (continuous > 1 ? most : 1U); ++round) {
    for (std::size_t t = 0; t < terms.size(); ++t)
      for (std::size_t k = 0; searched[t] && k < terms[t].shape.size(); ++k)
        if (terms[t].effect->shapes[k].continuous) refine(o, terms, t, k, white, y);
    if (continuous < 2 || round + 1 < fewest) continue;
    const double now = squares_with(o, terms, white, y);
    if (!(now < before * (1.0 - still_better))) break;
    before = now;
  }
}

/// False for discrete values, the usual value, and a shape with one grid value and a usual one.
bool estimated(const Observations& o, const Term& term, std::size_t k) {
  const Effect::Shape& shape = term.effect->shapes[k];
  if (!shape.continuous || is_usual(term, term.shape, k)) return false;
  return !usual_of(term, k) || shape.grid(o, term.axis).size() > 1;
}

/// Derivative by shape k, by central differences.
Expected<VectorXd> shape_column(const Observations& o, const Term& term, std::size_t k,
                                const VectorXd& linear) {
  const Effect::Shape& shape = term.effect->shapes[k];
  double size = std::max(std::fabs(term.shape[k]), 1e-12);
  if (usual_of(term, k)) {  // the value may be 0, so use the width of the grid
    const std::vector<double> grid = shape.grid(o, term.axis);
    if (grid.size() > 1) size = std::max(size, grid.back() - grid.front());
  }
  const double step = 1e-4 * size;
  std::vector<double> up = term.shape, down = term.shape;
  up[k] += step;
  down[k] -= step;
  const auto above = columns_of(o, term, up), below = columns_of(o, term, down);
  if (!above) return fail(above.error());
  if (!below) return fail(below.error());
  if (above->cols() != linear.size() || below->cols() != linear.size())
    return fail(term.name() + ": the number of columns changes with a continuous shape");
  return VectorXd((*above - *below) * linear / (2.0 * step));
}

/// A value between adjacent grid values replaces a stated value if its gain of evidence exceeds the
/// cost of a searched shape (workbench.h, price).
void free_stated(const Observations& o, std::vector<Term>& terms, const std::vector<char>& searched,
                 const std::vector<double>& weight, const Noise& noise) {
  const Whitening white(o, weight, Whitening::of_repeats(noise));
  const Eigen::Map<const VectorXd> y(o.deviation.data(), static_cast<Index>(o.size()));
  const auto n = static_cast<double>((white.root().array() > 0.0).count());
  for (std::size_t t = 0; t < terms.size(); ++t) {
    if (!searched[t] || !has_stated(terms[t])) continue;
    const std::size_t k = terms[t].stated->shape;
    const std::vector<double> grid = terms[t].effect->shapes[k].grid(o, terms[t].axis);
    std::vector<Term> moved = terms;
    moved[t].shape[k] *= 1.0 + 1e-9;
    refine(o, moved, t, k, white, y);
    const double independent = std::max(static_cast<double>(grid.size() + 1) / 3.0, 2.0);
    const double price = std::log(n) + 2.0 * std::log(independent);
    const double gain =
        n * std::log(squares_with(o, terms, white, y) / squares_with(o, moved, white, y));
    if (gain > price) terms = std::move(moved);
  }
}

/// At most two Gauss-Newton steps on all readings; each must reduce the sum of squares.
void step_shapes(const Observations& o, std::vector<Term>& terms, const std::vector<char>& searched,
                 const Whitening& white, const VectorXd& y) {
  const VectorXd weighted = white(y);
  for (int round = 0; round < 2; ++round) {
    auto d = design_of(o, terms, white);
    if (!d) return;
    const auto s = solve(*d, weighted);
    if (!s) return;
    std::vector<double*> moved;
    std::vector<Term> next = terms;
    for (std::size_t t = 0; t < terms.size(); ++t)
      for (std::size_t k = 0; searched[t] && k < terms[t].shape.size(); ++k) {
        if (!estimated(o, terms[t], k)) continue;
        const Index columns = d->first[t + 1] - d->first[t];
        const auto column = shape_column(o, terms[t], k, s->x.segment(d->first[t], columns));
        if (!column) continue;
        d->a.conservativeResize(Eigen::NoChange, d->a.cols() + 1);
        d->a.rightCols(1) = white(*column);
        d->names.push_back(terms[t].name());
        moved.push_back(&next[t].shape[k]);
      }
    const auto joint = moved.empty() ? Expected<Solution>(fail("")) : solve(*d, weighted);
    if (!joint) return;
    for (std::size_t k = 0; k < moved.size(); ++k)
      *moved[k] += joint->x(d->first.back() + static_cast<Index>(k));
    if (!(squares_with(o, next, white, y) < s->squares)) return;
    terms = std::move(next);
  }
}

/// Whether the times of this axis are numbers of readings, because times were not measured.
bool untimed(const Observations& o, const Axis& axis) {
  const auto r = readings_of(o, axis);
  return r && !r->timed;
}

void name_parameters(Fit& out, const Observations& o, const Design& design) {
  for (std::size_t t = 0; t < out.terms.size(); ++t) {
    const Term& term = out.terms[t];
    const bool by_count = untimed(o, term.axis);
    const auto quantity = [&](const Effect::Parameter& p) {
      const Quantity q = quantity_of(p, term.axis);
      return by_count ? by_readings(q) : q;
    };
    const auto all = static_cast<std::size_t>(design.blocks[t].cols());
    const std::size_t first = term.differences ? 1 : 0;
    const std::size_t k = term.grouping ? all / (term.grouping->name.size() - first) : all;
    for (std::size_t i = 0; i < all; ++i) {
      const Effect::Parameter& p = term.effect->linear[term.effect->curve ? 0 : i % k];
      const std::string group = term.grouping ? term.grouping->name[first + i / k] : "";
      out.parameters.push_back({term.name(),
                                (term.effect->curve ? p.name + std::to_string(i % k + 1) : p.name) +
                                    (group.empty() ? "" : " " + group),
                                0.0, 0.0, quantity(p), false, group});
    }
    for (std::size_t i = 0; i < term.shape.size(); ++i) {
      const Effect::Parameter& p = term.effect->shapes[i].parameter;
      out.parameters.push_back({term.name(), p.name, term.shape[i],
                                std::numeric_limits<double>::quiet_NaN(), quantity(p), true});
    }
  }
}

/// Whether the noise has contributions that the weights of a fit do not contain.
bool more_than_weights(const Noise& noise) {
  return noise.zero != Noise::Zero::steady || noise.neighbours != noise.in_repeats;
}

/// A V A^T, if the weights are not the inverse of the covariance V; A maps readings to unknowns.
MatrixXd spread(const MatrixXd& design, const MatrixXd& cofactor, const Whitening& white,
                const MatrixXd& covariance) {
  const MatrixXd both = white(white(covariance).transpose());
  const MatrixXd map = math::product(design, cofactor);
  return math::product(math::transposed_product(map, both), map);
}

/// Standard deviation of a reading for uncertainties, m or rad; 0 without redundancy. Residuals are
/// whitened with the contributions to the noise that the weights do not contain.
double s_for_uncertainty(const Fit& fit, const Observations& o, const Solution& solution) {
  if (fit.redundancy == 0) return 0.0;
  const auto redundancy = static_cast<double>(fit.redundancy);
  if (!more_than_weights(fit.noise)) return std::sqrt(solution.squares / redundancy);
  Noise likely = fit.noise;
  if (likely.zero_found > 0.0) likely.zero_size = likely.zero_found;
  const Whitening white(o, fit.weight, likely);
  MatrixXd left = white(
      Eigen::Map<const VectorXd>(fit.residual.data(), static_cast<Index>(fit.residual.size())));
  white.take_out_zeros(left);
  return left.norm() / std::sqrt(redundancy);
}

/// Adds the effect of interpolated temperatures, in units of s^2 of the fit; if their error is not
/// known, no parameter gets an uncertainty. `plain`: cofactor matrix of the solution.
void add_interpolation(MatrixXd& cofactor, const MatrixXd& plain, const Observations& o,
                       const std::vector<Term>& terms, const Design& design, const Solution& s,
                       const Whitening& white, double s_of_fit) {
  std::vector<VectorXd> linear;
  for (std::size_t t = 0; t < terms.size(); ++t)
    linear.emplace_back(s.x.segment(design.first[t], design.first[t + 1] - design.first[t]));
  const auto wrong = wrong_by_interpolation(o, terms, linear);
  if (!wrong) {
    cofactor.setConstant(std::numeric_limits<double>::quiet_NaN());
    return;
  }
  if (wrong->cols() == 0 || !(s_of_fit > 0.0)) return;
  const MatrixXd a = math::left_columns(design.a, cofactor.rows());
  const MatrixXd of_parameters = math::product(plain, math::transposed_product(a, white(*wrong)));
  cofactor += math::product_transposed(of_parameters, of_parameters) / (s_of_fit * s_of_fit);
}

/// Change of the unknowns for one standard uncertainty of a stated shape.
VectorXd by_stated(const Term& term, const VectorXd& linear, const Observations& o,
                   const MatrixXd& plain, const MatrixXd& a, const Whitening& white) {
  const auto column = shape_column(o, term, term.stated->shape, linear);
  if (!column) return VectorXd::Zero(plain.rows());
  const MatrixXd wrong = *column * term.stated->u;
  return math::product(plain, math::transposed_product(a, white(wrong)));
}

/// Index among the parameters, u, and change of the unknowns for this u.
struct StatedShape {
  std::size_t parameter;
  double u;
  VectorXd of_unknowns;
};

/// Correlations with the other parameters have the sign opposite to the change of the unknowns.
void put_stated(Fit& out, const std::vector<StatedShape>& stated, const std::vector<Index>& place) {
  for (const StatedShape& one : stated) {
    out.parameters[one.parameter].u = one.u;
    for (std::size_t k = 0; k < place.size(); ++k) {
      const double u = out.parameters[k].u;
      if (place[k] < 0 || !(u > 0.0)) continue;
      out.correlation[one.parameter][k] = out.correlation[k][one.parameter] =
          -one.of_unknowns(place[k]) / u;
    }
  }
}

/// Linearized problem: the design together with the derivatives by the searched shapes.
void fill_covariance(Fit& out, const Observations& o, Design design, const Solution& s,
                     const std::vector<char>& searched, const Whitening& white) {
  std::vector<Index> place(out.parameters.size(), -1);         // row in the cofactor matrix
  std::vector<std::pair<std::size_t, std::size_t>> stated_at;  // indices of parameter and term
  Index row = design.first.front(), extra = 0;
  std::size_t at = 0;
  const Index plain = design.a.cols();
  for (std::size_t t = 0; t < out.terms.size(); ++t) {
    const Term& term = out.terms[t];
    const Index k = design.first[t + 1] - design.first[t];
    for (Index i = 0; i < k; ++i) place[at++] = row++;
    for (std::size_t i = 0; i < term.shape.size(); ++i, ++at) {
      if (has_stated(term) && term.stated->shape == i) stated_at.emplace_back(at, t);
      if (!searched[t] || !estimated(o, term, i)) continue;
      const auto column = shape_column(o, term, i, s.x.segment(design.first[t], k));
      if (!column || !(column->norm() > 0.0)) continue;
      design.a.conservativeResize(Eigen::NoChange, plain + extra + 1);
      design.a.col(plain + extra) = white(*column);
      design.names.push_back(term.name() + " " + out.parameters[at].name);
      place[at] = plain + extra++;
    }
  }
  MatrixXd cofactor = s.cofactor;
  if (extra > 0) {
    const VectorXd none = VectorXd::Zero(design.a.rows());
    if (auto joint = solve(design, none))
      cofactor = std::move(joint->cofactor);
    else  // a shape has no optimum between grid values, so it is known only to the step of its grid
      for (Index& p : place)
        if (p >= plain) p = -1;
    out.redundancy -= std::min(out.redundancy, static_cast<std::size_t>(extra));
  }
  const auto columns = cofactor.cols();
  const MatrixXd plain_cofactor = cofactor;
  std::vector<char> open(static_cast<std::size_t>(columns), 0);
  if (more_than_weights(out.noise)) {
    const auto with = [&](const Noise& noise) {
      return spread(design.a.leftCols(columns), plain_cofactor, white,
                    covariance_of(o, white.root(), noise));
    };
    cofactor = with(out.noise);
    if (out.noise.zero_open) {
      Noise steady = out.noise;
      steady.zero = Noise::Zero::steady;
      const MatrixXd known = with(steady);
      for (Index k = 0; k < columns; ++k)
        // docs/dev/constants.md, M32.
        open[static_cast<std::size_t>(k)] = known(k, k) < 0.5 * cofactor(k, k);
    }
  }
  const double s_of_u = out.s_noise = s_for_uncertainty(out, o, s);
  add_interpolation(cofactor, plain_cofactor, o, out.terms, design, s, white, s_of_u);
  std::vector<StatedShape> stated;
  for (const auto& [parameter, t] : stated_at) {
    const VectorXd linear = s.x.segment(design.first[t], design.first[t + 1] - design.first[t]);
    stated.push_back(
        {parameter, out.terms[t].stated->u,
         by_stated(out.terms[t], linear, o, plain_cofactor, design.a.leftCols(columns), white)});
    const VectorXd& made = stated.back().of_unknowns;
    if (s_of_u > 0.0) cofactor += made * made.transpose() / (s_of_u * s_of_u);
  }
  const std::size_t p = out.parameters.size();
  out.correlation.assign(p, std::vector<double>(p, 0.0));
  for (std::size_t i = 0; i < p; ++i) {
    out.correlation[i][i] = 1.0;
    if (place[i] < 0) continue;
    // Without the size of the random zero, u of parameters that depend on it is not determined.
    out.parameters[i].u = open[static_cast<std::size_t>(place[i])] != 0
                              ? std::numeric_limits<double>::quiet_NaN()
                              : s_of_u * std::sqrt(cofactor(place[i], place[i]));
    for (std::size_t k = 0; k < p; ++k)
      if (place[k] >= 0)
        out.correlation[i][k] =
            cofactor(place[i], place[k]) /
            std::sqrt(cofactor(place[i], place[i]) * cofactor(place[k], place[k]));
  }
  put_stated(out, stated, place);
}

}  // namespace

Expected<Fit> fit(const Observations& o, std::vector<Term> terms, std::vector<double> weight,
                  const Noise& noise, const Observations* known_thin) {
  std::vector<char> searched;
  for (const Term& term : terms)
    searched.push_back(term.shape.empty() && !term.effect->shapes.empty());
  const bool any = std::find(searched.begin(), searched.end(), 1) != searched.end();
  const bool is_long = any && o.size() > thin_beyond;
  const Observations made = is_long && known_thin == nullptr ? thinned(o, weight) : Observations{};
  const Observations& thin = is_long && known_thin != nullptr ? *known_thin : made;
  if (thin.size() > 0 && thin.size() < o.size()) {
    NONIO_TRY(auto near, fit(thin, terms));
    terms = std::move(near.terms);
  } else if (any) {
    if (auto found = start_shapes(o, terms, searched, weight, noise); !found)
      return fail(found.error());
    free_stated(o, terms, searched, weight, noise);
  }
  return fit_near(o, std::move(terms), searched, std::move(weight), noise);
}

Expected<Fit> fit_near(const Observations& o, std::vector<Term> terms,
                       const std::vector<char>& searched, std::vector<double> weight,
                       const Noise& noise) {
  const Whitening white(o, weight, Whitening::of_repeats(noise));
  const VectorXd y =
      Eigen::Map<const VectorXd>(o.deviation.data(), static_cast<Index>(o.deviation.size()));
  if (std::find(searched.begin(), searched.end(), 1) == searched.end())
    return fit_at(o, std::move(terms), searched, std::move(weight), noise);
  if (o.size() > thin_beyond)
    step_shapes(o, terms, searched, white, y);
  else
    refine_shapes(o, terms, searched, white, y);
  return fit_at(o, std::move(terms), searched, std::move(weight), noise);
}

Expected<Fit> fit_at(const Observations& o, std::vector<Term> terms,
                     const std::vector<char>& searched, std::vector<double> weight,
                     const Noise& noise) {
  const Whitening white(o, weight, Whitening::of_repeats(noise));
  const VectorXd y =
      Eigen::Map<const VectorXd>(o.deviation.data(), static_cast<Index>(o.deviation.size()));
  NONIO_TRY(auto design, design_of(o, terms, white));
  const auto used = static_cast<Index>((white.root().array() > 0.0).count());
  if (used <= design.a.cols())
    return fail(std::to_string(used) + " readings cannot determine " +
                std::to_string(design.a.cols()) + " unknowns");
  NONIO_TRY(const auto s, solve(design, white(y)));

  Fit out;
  out.terms = std::move(terms);
  out.weight = weight.empty() ? std::vector<double>(o.size(), 1.0) : std::move(weight);
  out.redundancy = static_cast<std::size_t>(used - design.a.cols());
  const Index lines = design.first.front();
  out.zero.assign(s.x.data(), s.x.data() + lines);
  // A reading of weight 0 also has a residual: its distance from the model.
  VectorXd residual = y;
  for (Index i = 0; i < y.size(); ++i)
    residual(i) -= s.x(static_cast<Index>(line_of(o, static_cast<std::size_t>(i))));
  for (std::size_t t = 0; t < out.terms.size(); ++t) {
    const MatrixXd& block = design.blocks[t];
    const VectorXd part = block * s.x.segment(design.first[t], block.cols());
    residual -= part;
    out.part.emplace_back(part.data(), part.data() + part.size());
  }
  out.residual.assign(residual.data(), residual.data() + residual.size());
  out.noise = noise;
  name_parameters(out, o, design);
  for (const Index lost : design.lost) out.lost.push_back(static_cast<std::size_t>(lost));
  Index column = lines;
  for (Parameter& p : out.parameters)
    if (!p.shape) p.value = s.x(column++);
  fill_covariance(out, o, std::move(design), s, searched, white);
  double sum = 0.0;
  for (const double w : out.weight) sum += w;
  // Use residuals of the original readings, not of the whitened ones.
  const double squares = white.independent() && noise.rough.empty()
                             ? s.squares
                             : root_weights(o, out.weight).cwiseProduct(residual).squaredNorm();
  out.rms = std::sqrt(squares / sum);
  out.s = out.redundancy > 0 ? std::sqrt(s.squares / static_cast<double>(out.redundancy)) : 0.0;
  return out;
}

std::vector<std::string> below_uncertainty(const Fit& fit) {
  std::vector<std::string> out;
  for (const Term& term : fit.terms) {
    if (term.effect->is_nuisance) continue;
    bool any = false, small = true;
    for (const Parameter& p : fit.parameters) {
      if (p.effect != term.name() || p.shape) continue;
      any = true;
      small = small && std::fabs(p.value) < 2.0 * p.u;
    }
    if (any && small) out.push_back(term.name());
  }
  return out;
}

Expected<std::vector<double>> said_by(const Observations& o, const Term& term, double value) {
  NONIO_TRY(const auto columns, columns_of(o, term, term.shape));
  const VectorXd says = columns.col(0) * value;
  return std::vector<double>(says.data(), says.data() + says.size());
}

double rms_with(const Observations& o, const std::vector<Term>& terms,
                const std::vector<double>& weight) {
  const Whitening white(o, weight, {});
  const Eigen::Map<const VectorXd> y(o.deviation.data(), static_cast<Index>(o.size()));
  const double sum = weight.empty() ? static_cast<double>(o.size())
                                    : std::accumulate(weight.begin(), weight.end(), 0.0);
  return std::sqrt(squares_with(o, terms, white, y) / sum);
}

}  // namespace nonio::model
