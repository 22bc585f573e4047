// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/step_diagonals.h"

#include <algorithm>
#include <cmath>

#include "nonio/math/distributions.h"
#include "step_estimate.h"

namespace nonio::math {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Index = Eigen::Index;

// limit of eigenvalues, relative to the largest; directions below this limit are not determined
constexpr double undetermined = 1e-10;
constexpr double unmoved = 1e-6;  // largest change by an undetermined unit vector that is ignored
constexpr int corrections = 2;

std::array<Vector3d, 2> across(const Vector3d& u) {
  const Vector3d one = u.unitOrthogonal();
  return {one, u.cross(one)};
}

/// Columns: function values, set-up angles times L, zeros of the passes, zeros of the series.
struct Layout {
  Index functions = 0, set_up = 0, zeros = 0, series = 0;
  Index first_zero() const { return functions + set_up; }
  Index first_series() const { return first_zero() + zeros; }
  Index columns() const { return first_series() + series; }
};

struct ReadingRow {
  std::size_t pass, moves;  ///< index of the pass; number of moves, 0 for the zero of the pass
};

/// Rows of readings (weight 1), of series, and of the gauge.
struct Design {
  Layout layout;
  MatrixXd A;
  VectorXd b;
  std::vector<ReadingRow> readings;
  VectorXd series_weight;  ///< weights of the readings of all series, concatenated; 0 if not used
};

std::size_t node(const StepDiagonals& d, int sign, std::size_t moves) {
  return sign > 0 ? moves : d.n - moves;
}

void put_reading(const StepDiagonals& d, const ReadingRow& row, Design& design, Index r) {
  const auto& pass = d.passes[row.pass];
  const Vector3d u = direction(d, pass), p = displacement(d, pass, row.moves);
  const auto moves = d.counts(row.moves);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t here = node(d, pass.sign[axis], moves[axis]);
    const std::size_t start = node(d, pass.sign[axis], 0);
    for (std::size_t along = 0; along < 3; ++along) {
      const auto column = [&](std::size_t i) {
        return static_cast<Index>(function_column(axis, along, i, d.n));
      };
      const double share = u[static_cast<Index>(along)];
      if (here > 0) design.A(r, column(here)) += share;
      if (start > 0) design.A(r, column(start)) -= share;
    }
  }
  const Layout& l = design.layout;
  if (l.set_up > 0) {
    const auto sides = across(u);
    for (std::size_t k = 0; k < 2; ++k)
      design.A(r, l.functions + static_cast<Index>(2 * row.pass + k)) =
          sides[k].dot(p) / d.diagonal();
  }
  design.A(r, l.first_zero() + static_cast<Index>(row.pass)) = 1.0;
  design.b[r] = row.moves == 0 ? 0.0 : pass.reading[row.moves - 1];
}

/// E_aa is interpolated between its positions. Returns false if x is outside of the travel.
bool put_position(const StepDiagonals& d, std::size_t axis, double x, double weight,
                  Eigen::Ref<Eigen::RowVectorXd> row) {
  const double steps = (x - d.low[axis]) / d.travel[axis] * static_cast<double>(d.n);
  const double slack = 1e-6;
  if (!(steps > -slack) || !(steps < static_cast<double>(d.n) + slack)) return false;
  const auto i =
      static_cast<std::size_t>(std::clamp(std::floor(steps), 0.0, static_cast<double>(d.n - 1)));
  const double part = steps - static_cast<double>(i);
  if (i > 0) row[static_cast<Index>(function_column(axis, axis, i, d.n))] += weight * (1.0 - part);
  row[static_cast<Index>(function_column(axis, axis, i + 1, d.n))] += weight * part;
  return true;
}

Design begin_design(const StepDiagonals& d, const std::vector<AxisSeries>& series,
                    const StepChoices& choices) {
  Design design;
  for (std::size_t k = 0; k < d.passes.size(); ++k)
    for (std::size_t t = 0; t <= 3 * d.n; ++t)
      if (t == 0 || std::isfinite(d.passes[k].reading[t - 1])) design.readings.push_back({k, t});
  Layout& l = design.layout;
  const auto passes = static_cast<Index>(d.passes.size());
  l.functions = static_cast<Index>(9 * d.n);
  l.set_up = choices.set_up_known ? 0 : 2 * passes;
  l.zeros = passes;
  l.series = static_cast<Index>(series.size());
  std::size_t rows = design.readings.size() + (choices.set_up_known ? 0 : 3);
  for (const AxisSeries& s : series) rows += s.position.size();
  design.A = MatrixXd::Zero(static_cast<Index>(rows), l.columns());
  design.b = VectorXd::Zero(static_cast<Index>(rows));
  std::size_t of_series = 0;
  for (const AxisSeries& s : series) of_series += s.position.size();
  design.series_weight = VectorXd::Zero(static_cast<Index>(of_series));
  return design;
}

Design design_of(const StepDiagonals& d, const std::vector<AxisSeries>& series,
                 const StepChoices& choices, double u_reading) {
  Design design = begin_design(d, series, choices);
  Index r = 0;
  for (const ReadingRow& row : design.readings) put_reading(d, row, design, r++);
  for (std::size_t k = 0; k < series.size(); ++k) {
    const AxisSeries& s = series[k];
    const double weight = s.u > 0.0 && u_reading > 0.0 ? u_reading / s.u : 1.0;
    for (std::size_t i = 0; i < s.position.size(); ++i, ++r) {
      Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(design.layout.columns());
      if (!put_position(d, s.axis, s.position[i], weight, row)) continue;  // the row remains 0
      row[design.layout.first_series() + static_cast<Index>(k)] = weight;
      design.A.row(r) = row;
      design.b[r] = weight * s.deviation[i];
      design.series_weight[r - static_cast<Index>(design.readings.size())] = weight;
    }
  }
  if (choices.set_up_known) return design;
  // Mirrors of unknown orientation leave rotations undetermined: EYX, EZX, EZY end at 0.
  for (const auto& [axis, along] : {std::pair{0U, 1U}, std::pair{0U, 2U}, std::pair{1U, 2U}})
    design.A(r++, static_cast<Index>(function_column(axis, along, d.n, d.n))) = 1.0;
  return design;
}

/// The pseudo-inverse of the normal equations, and the directions that it does not determine.
struct Factor {
  MatrixXd inverse, open;
  Index rank = 0;
};

Factor factor(const Design& design) {
  const auto [values, vectors] = spectrum(transposed_product(design.A, design.A));
  const Index size = values.size();
  const double least = undetermined * values[size - 1];
  Index open = 0;
  while (open < size && values[open] <= least) ++open;
  const MatrixXd V = columns(vectors, open, size - open);
  Factor f;
  f.rank = size - open;
  f.open = left_columns(vectors, open);
  f.inverse = product_transposed(scaled_columns(V, values.tail(size - open).cwiseInverse()), V);
  return f;
}

VectorXd solve(const Design& design, const Factor& f, const VectorXd& b) {
  return times(f.inverse, transposed_times(design.A, b));
}

/// Returns the error of the point after some moves of a pass, minus that at its start.
Vector3d error_of(const StepDiagonals& d, const ReadingRow& row, const VectorXd& x) {
  const auto& pass = d.passes[row.pass];
  const auto moves = d.counts(row.moves);
  Vector3d e = Vector3d::Zero();
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t along = 0; along < 3; ++along) {
      const auto value = [&](std::size_t i) {
        return i == 0 ? 0.0 : x[static_cast<Index>(function_column(axis, along, i, d.n))];
      };
      e[static_cast<Index>(along)] +=
          value(node(d, pass.sign[axis], moves[axis])) - value(node(d, pass.sign[axis], 0));
    }
  return e;
}

Vector3d set_up_of(const StepDiagonals& d, std::size_t pass, const Design& design,
                   const VectorXd& x) {
  const auto sides = across(direction(d, d.passes[pass]));
  const Index first = design.layout.functions + static_cast<Index>(2 * pass);
  return (sides[0] * x[first] + sides[1] * x[first + 1]) / d.diagonal();
}

/// Terms of second order: nu.E, and the shorter path of a beam not parallel to the diagonal.
VectorXd without_second_order(const StepDiagonals& d, const Design& design, const VectorXd& x,
                              const StepChoices& choices) {
  VectorXd b = design.b;
  for (std::size_t r = 0; r < design.readings.size(); ++r) {
    const ReadingRow& row = design.readings[r];
    const Vector3d nu = set_up_of(d, row.pass, design, x);
    double term = nu.dot(error_of(d, row, x));
    if (choices.mirror_to_beam)
      term -= 0.5 * nu.squaredNorm() *
              direction(d, d.passes[row.pass]).dot(displacement(d, d.passes[row.pass], row.moves));
    b[static_cast<Index>(r)] -= term;
  }
  return b;
}

/// Scatter of the readings about the fitted functions, independent of the axis series.
struct Scatter {
  double u = 0.0, dof = 0.0;
};

Scatter scatter_of(const Design& design, const Factor& f) {
  const VectorXd e = residual(design.b, design.A, solve(design, f, design.b));
  const auto readings = static_cast<Index>(design.readings.size());
  const double dof = static_cast<double>(design.A.rows() - f.rank);
  return {dof > 0.0 ? std::sqrt(e.head(readings).squaredNorm() / dof) : 0.0, dof};
}

std::array<bool, 3> known_scales(const StepDiagonals& d, const Factor& f) {
  std::array<bool, 3> known{};
  for (std::size_t a = 0; a < 3; ++a)
    known[a] = f.open.cols() == 0 ||
               f.open.row(static_cast<Index>(function_column(a, a, d.n, d.n))).norm() < unmoved;
  return known;
}

/// At most eight directions are undetermined, and none of them changes a result.
bool complete(const StepDiagonals& d, const Factor& f, const std::array<bool, 3>& known) {
  const auto size = static_cast<Index>(9 * d.n);
  if (f.open.cols() > 8) return false;
  for (Index k = 0; k < f.open.cols(); ++k) {
    StepSolution moved;
    present(d, f.open.col(k).head(size), MatrixXd::Zero(size, size), {}, known, moved);
    for (const StepCurve& c : moved.curves)
      for (const double v : c.value)
        if (!(std::fabs(v) < unmoved)) return false;
    for (const Estimated& s : moved.squareness)
      if (!(std::fabs(s.value) * d.diagonal() < unmoved)) return false;
  }
  return true;
}

/// The order is that of the model: passes with their zeros, then series.
Sensitivity sensitivity_of(const StepDiagonals& d, const Design& design, const Factor& f,
                           const ReadingModel* model) {
  Sensitivity out{model, {}};
  if (model == nullptr) return out;
  const auto each = static_cast<Index>(3 * d.n + 1);
  const auto passes = each * static_cast<Index>(d.passes.size());
  const auto read = static_cast<Index>(design.readings.size());
  const MatrixXd G = product_transposed(f.inverse.topRows(design.layout.functions), design.A);
  out.of_readings = MatrixXd::Zero(G.rows(), passes + design.series_weight.size());
  for (Index r = 0; r < read; ++r) {
    const ReadingRow& row = design.readings[static_cast<std::size_t>(r)];
    out.of_readings.col(static_cast<Index>(row.pass) * each + static_cast<Index>(row.moves)) =
        G.col(r);
  }
  for (Index i = 0; i < design.series_weight.size(); ++i)
    out.of_readings.col(passes + i) = G.col(read + i) * design.series_weight[i];
  return out;
}

double used_u(const StepChoices& choices, const Scatter& s) {
  return choices.u_reading > 0.0 ? choices.u_reading : s.u;
}

/// Fits a line to values y with covariance C by generalized least squares, and tests the residuals.
ShapeContrast against_line(const AxisSeries& s, const MatrixXd& C, const VectorXd& y, double dof) {
  ShapeContrast out;
  out.axis = s.axis;
  const Eigen::LLT<MatrixXd> llt(C);
  if (y.size() < 4 || llt.info() != Eigen::Success) return out;
  MatrixXd line(y.size(), 2);
  for (Index i = 0; i < y.size(); ++i)
    line.row(i) << 1.0, s.position[static_cast<std::size_t>(i)] - s.position.front();
  const MatrixXd white = whitened(llt, line);
  const VectorXd seen = whitened(llt, y);
  const VectorXd fit = least_squares(white, seen);
  const VectorXd e = residual(y, line, least_squares(line, y));
  const double f = squared_residual(seen, white, fit) / static_cast<double>(y.size() - 2);
  out.p = f_upper(f, static_cast<double>(y.size() - 2), dof);
  out.rms = std::sqrt(e.squaredNorm() / static_cast<double>(y.size()));
  Index worst = 0;
  out.largest = e.cwiseAbs().maxCoeff(&worst);
  out.at = s.position[static_cast<std::size_t>(worst)];
  return out;
}

AxisSeries inside(const StepDiagonals& d, const AxisSeries& s) {
  AxisSeries in{s.axis, {}, {}, s.u};
  for (std::size_t i = 0; i < s.position.size(); ++i) {
    const double x = s.position[i] - d.low[s.axis], slack = 1e-6 * d.travel[s.axis];
    if (!(x > -slack) || !(x < d.travel[s.axis] + slack)) continue;
    in.position.push_back(s.position[i]);
    in.deviation.push_back(s.deviation[i]);
  }
  return in;
}

std::vector<ShapeContrast> contrast_shapes(const StepDiagonals& d,
                                           const std::vector<AxisSeries>& series,
                                           const StepChoices& choices, const Design& design,
                                           const Factor& f, const Scatter& scatter) {
  std::vector<ShapeContrast> out;
  const double u = used_u(choices, scatter);
  const VectorXd x = solve(design, f, design.b);
  if (!(u > 0.0)) return out;
  for (const AxisSeries& all : series) {
    const AxisSeries s = inside(d, all);
    const auto m = static_cast<Index>(s.position.size());
    MatrixXd T = MatrixXd::Zero(m, design.layout.functions);
    VectorXd y(m);
    for (Index i = 0; i < m; ++i) {
      const auto k = static_cast<std::size_t>(i);
      Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(T.cols());
      put_position(d, s.axis, s.position[k], 1.0, row);
      T.row(i) = row;
      y[i] = row.dot(x.head(T.cols())) - s.deviation[k];
    }
    const double u_axis = s.u > 0.0 ? s.u : u;
    MatrixXd C =
        u * u * product_transposed(product(T, f.inverse.topLeftCorner(T.cols(), T.cols())), T);
    C.diagonal().array() += u_axis * u_axis;
    out.push_back(against_line(s, C, y, choices.u_reading > 0.0 ? 1e6 : scatter.dof));
  }
  return out;
}

}  // namespace

Expected<StepSolution> solve_step_diagonals(const StepDiagonals& d,
                                            const std::vector<AxisSeries>& series,
                                            const StepChoices& choices, const ReadingModel* model) {
  Design design = design_of(d, {}, choices, 0.0);
  Factor f = factor(design);
  const Scatter scatter = scatter_of(design, f);
  StepSolution out;
  out.u_reading = used_u(choices, scatter);
  out.dof = scatter.dof;
  if (!series.empty()) {
    out.shapes = contrast_shapes(d, series, choices, design, f, scatter);
    design = design_of(d, series, choices, out.u_reading);
    f = factor(design);
  }
  const Layout& l = design.layout;
  out.unknowns = static_cast<std::size_t>(l.functions + l.set_up);
  out.rank = static_cast<std::size_t>(f.rank - l.zeros - l.series);
  const auto known = known_scales(d, f);
  if (!complete(d, f, known))
    return fail(
        "the readings do not determine the functions: " + std::to_string(out.unknowns - out.rank) +
        " numbers are open, as too many readings are missing");
  VectorXd x = solve(design, f, design.b);
  if (l.set_up > 0 && f.open.cols() == 0) {
    for (int i = 0; i < corrections; ++i)
      x = solve(design, f, without_second_order(d, design, x, choices));
    for (std::size_t k = 0; k < d.passes.size(); ++k)
      out.set_up.push_back(set_up_of(d, k, design, x).norm());
  }
  const Sensitivity sensitivity = sensitivity_of(d, design, f, model);
  if (model != nullptr && static_cast<Index>(model->readings()) != sensitivity.of_readings.cols())
    return fail("expected a model of the readings of all passes and series");
  present(d, x.head(l.functions),
          out.u_reading * out.u_reading * f.inverse.topLeftCorner(l.functions, l.functions),
          sensitivity, known, out);
  return out;
}

}  // namespace nonio::math
