// SPDX-License-Identifier: Apache-2.0
//
// One least-squares problem for all readings. Every reading is a source of noise; a row is a
// reading minus positioning, so rows share sources, and their covariance is N diag(sigma^2) N'.
#include "nonio/math/diagonals.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "dense.h"
#include "diagonal_readings.h"
#include "nonio/math/distributions.h"

namespace nonio::math {

namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using Row = Eigen::RowVectorXd;

/// smallest pivot that counts for the rank, relative to the largest one
constexpr double rank_threshold = 1e-10;
// Limit of the closure error, in standard uncertainties: docs/dev/constants.md, A6.
constexpr double closure_limit = 4.0;

/// The linear equations A theta = y + N e for theta = (f_1..f_{n-1}, g_1..g_{n-1}, k Ly, slopes of
/// directly measured straightness). e: errors of the readings; other symbols as in diagonals.h.
class System {
 public:
  explicit System(const DiagonalReadings& r) : r_(r), n_(r.n) {
    unknowns_ = 2 * n_ - 1;
    std::size_t rows = 2 * n_, columns = unknowns_;
    for (const GridLine& line : r.third) rows += line.mean.size() - 1;
    for (const auto* direct : {&r.EYX, &r.EXY}) {
      if (!*direct) continue;
      rows += (*direct)->whole ? n_ - 1 : (n_ + 1) / 2;
      columns += (*direct)->whole ? 0 : 1;
    }
    noise_known_ = add_sources();
    A_ = Matrix::Zero(at(rows), at(columns));
    y_ = Vector::Zero(at(rows));
    N_ = Matrix::Zero(at(rows), at(sigma_.size()));
    add_line(r.D1, first_of_lines_);
    std::size_t source = first_of_lines_ + r.D1.mean.size();
    add_line(r.D2, source);
    source += r.D2.mean.size();
    for (const GridLine& line : r.third) add_line(line, source), source += line.mean.size();
    std::size_t slope = unknowns_, first = 0;
    for (const auto* direct : {&r.EYX, &r.EXY}) {
      if (*direct && (*direct)->whole) add_whole(**direct, source, first);
      if (*direct && !(*direct)->whole) add_odd(**direct, source, first, slope++);
      if (*direct) source += (*direct)->readings();
      first = n_ - 1;
    }
  }

  const Matrix& A() const { return A_; }
  /// Derivatives of the rows by the readings: y = N readings.
  const Matrix& N() const { return N_; }
  std::size_t first_of_X() const { return r_.Y.size() * (n_ + 1); }
  std::size_t first_of_yaw() const { return first_of_X() + r_.X.size() * (n_ + 1); }
  const Vector& y() const { return y_; }
  /// If one is not known, 1 for lengths and 0 for yaw. Readings that are 0 by definition have 0.
  const std::vector<double>& sigma() const { return sigma_; }
  /// Index of the first reading of the measured straightness EYX, or if `second` of EXY.
  std::size_t first_of_direct(bool second) const {
    const std::size_t last = r_.EXY ? r_.EXY->readings() : 0;
    return sigma_.size() - last - (!second && r_.EYX ? r_.EYX->readings() : 0);
  }
  bool noise_known() const { return noise_known_; }
  std::size_t unknowns() const { return unknowns_; }
  Matrix covariance() const {
    const Matrix root = scaled(sigma_);
    return product_transposed(root, root);
  }
  /// B with B B' = covariance of the rows for noise of 1 in readings of lines and straightness.
  Matrix unit_noise() const { return scaled(unit_); }

  Row f(std::size_t i) const { return place(i, 0); }
  Row g(std::size_t i) const { return place(i, n_ - 1); }
  Row k() const {
    Row row = Row::Zero(A_.cols());
    row[at(unknowns_ - 1)] = 1.0 / r_.Ly;
    return row;
  }

 private:
  Row place(std::size_t i, std::size_t first) const {
    Row row = Row::Zero(A_.cols());
    if (i > 0 && i < n_) row[at(first + i - 1)] = 1.0;
    return row;
  }
  Matrix scaled(const std::vector<double>& sigma) const {
    return scaled_columns(N_, Eigen::Map<const Vector>(sigma.data(), at(sigma.size())));
  }

  /// Order: Y, X, yaw, lines, direct straightness. Returns false if some noise is not known.
  bool add_sources() {
    bool known = true;
    const auto add = [&](const MeanCurve& c, double unit) {
      known = known && c.u > 0.0;
      for (std::size_t i = 0; i < c.mean.size(); ++i) {
        const double on = i == 0 && c.zeroed ? 0.0 : 1.0;
        sigma_.push_back(on * c.u);
        unit_.push_back(on * unit);
        equal_.push_back(on);
      }
    };
    for (const PitchLine& line : r_.Y) add(line, 0.0);
    for (const PitchLine& line : r_.X) add(line, 0.0);
    for (const MeanCurve& yaw : r_.ECX) {
      add(yaw, 0.0);
      std::fill(equal_.end() - static_cast<std::ptrdiff_t>(n_ + 1), equal_.end(), 0.0);
    }
    first_of_lines_ = sigma_.size();
    add(r_.D1, 1.0);
    add(r_.D2, 1.0);
    for (const GridLine& line : r_.third) add(line, 1.0);
    for (const auto* direct : {&r_.EYX, &r_.EXY})
      if (*direct) {
        const bool through_ends = (*direct)->whole && (*direct)->zeroed;
        const auto add_one = [&](const MeanCurve& curve) {
          add(curve, 1.0);
          if (through_ends) sigma_.back() = unit_.back() = equal_.back() = 0.0;
        };
        add_one(**direct);
        if ((*direct)->reversed) add_one(*(*direct)->reversed);
      }
    if (!known) sigma_ = equal_;
    return known;
  }

  /// Each curve has its own zero, because a common zero of two lines of X would contain squareness.
  void subtract(Eigen::Index row, const MeanCurve& c, std::size_t source, std::size_t i,
                double factor) {
    y_[row] -= factor * (c.mean[i] - c.mean[0]);
    N_(row, at(source + i)) -= factor;
    N_(row, at(source)) += factor;
  }

  void add_stop(Eigen::Index row, const GridLine& line, std::size_t j, double sign) {
    const std::size_t a = line.ix[j], b = line.iy[j];
    const double y = r_.Ly * static_cast<double>(b) / static_cast<double>(n_);
    A_.row(row) += sign * (line.cx * (g(b) - y * k()) + line.cy * f(a));
    const std::size_t curve = n_ + 1, first_x = r_.Y.size(), first_yaw = first_x + r_.X.size();
    const std::size_t Y = of_direction(r_.Y, line.y_direction).front();
    subtract(row, r_.Y[Y], Y * curve, b, sign * line.cy);
    const auto X = of_direction(r_.X, line.x_direction);
    const auto source = [&](std::size_t k) { return (first_x + X[k]) * curve; };
    const double apart = y - r_.X[X[0]].across;
    double second = 0.0;
    if (X.size() == 2) {
      second = apart / (r_.X[X[1]].across - r_.X[X[0]].across);
      subtract(row, r_.X[X[1]], source(1), a, sign * line.cx * second);
    } else if (!r_.ECX.empty()) {
      const std::size_t yaw = of_direction(r_.ECX, line.x_direction).front();
      subtract(row, r_.ECX[yaw], (first_yaw + yaw) * curve, a, -sign * line.cx * apart);
    }
    subtract(row, r_.X[X[0]], source(0), a, sign * line.cx * (1.0 - second));
  }

  void add_line(const GridLine& line, std::size_t source) {
    for (std::size_t j = 1; j < line.mean.size(); ++j, ++next_) {
      add_stop(next_, line, j, 1.0);
      add_stop(next_, line, 0, -1.0);
      y_[next_] += line.mean[j] - line.mean[0];
      N_(next_, at(source + j)) += 1.0;
      N_(next_, at(source)) -= 1.0;
    }
  }

  void put_direct(const DirectStraightness& c, std::size_t source, std::size_t i, double factor) {
    y_[next_] += factor * c.mean_of(i);
    const std::size_t curves = c.reversed ? 2 : 1;
    for (std::size_t k = 0; k < curves; ++k)
      N_(next_, at(source + k * c.mean.size() + i)) += factor / static_cast<double>(curves);
  }

  double way(std::size_t i) const { return static_cast<double>(i) / static_cast<double>(n_); }

  /// The even part may be known better from the diagonals than from another instrument.
  void add_odd(const DirectStraightness& c, std::size_t source, std::size_t first,
               std::size_t slope) {
    for (std::size_t i = 0; 2 * i < n_; ++i, ++next_) {
      A_.row(next_) = (place(i, first) - place(n_ - i, first)) / 2.0;
      A_(next_, at(slope)) = way(i) - 0.5;
      put_direct(c, source, i, 0.5);
      put_direct(c, source, n_ - i, -0.5);
    }
  }

  void add_whole(const DirectStraightness& c, std::size_t source, std::size_t first) {
    for (std::size_t i = 1; i < n_; ++i, ++next_) {
      A_.row(next_) = place(i, first);
      for (const auto& [j, factor] :
           {std::pair{i, 1.0}, {std::size_t{0}, way(i) - 1.0}, {n_, -way(i)}})
        put_direct(c, source, j, factor);
    }
  }

  const DiagonalReadings& r_;
  std::size_t n_, unknowns_ = 0, first_of_lines_ = 0;
  bool noise_known_ = false;
  Matrix A_, N_;
  Vector y_;
  std::vector<double> sigma_, unit_, equal_;
  Eigen::Index next_ = 0;
};

/// Generalized least squares. A value is valid only if the rows determine it (`determined`).
class Solution {
 public:
  Solution(const System& system, const ReadingModel* model) : model_(model) {
    const Matrix C = system.covariance();
    const Eigen::LLT<Matrix> llt(C);
    const Matrix A = whitened(llt, system.A());
    const Vector y = whitened(llt, system.y());
    Eigen::ColPivHouseholderQR<Matrix> qr(A);
    qr.setThreshold(rank_threshold);
    rank_ = static_cast<std::size_t>(qr.rank());
    const Matrix inverse = pseudo_inverse(qr);
    theta_ = times(inverse, y);
    projector_ = product(inverse, A);
    root_ = inverse;
    gain_ = product(inverse, whitened(llt, system.unit_noise()));
    if (model_ != nullptr) jacobian_ = product(inverse, whitened(llt, system.N()));
    const auto rows = static_cast<std::size_t>(A.rows());
    dof_ = rows > rank_ ? rows - rank_ : 0;
    if (dof_ > 0)
      scale_ = std::sqrt(squared_residual(y, A, theta_)) / std::sqrt(static_cast<double>(dof_));
    if (!system.noise_known()) factor_ = scale_;
  }

  std::size_t rank() const { return rank_; }
  std::size_t dof() const { return dof_; }
  double scale() const { return scale_; }
  double factor() const { return factor_; }

  bool determined(const Row& h) const { return (by(h, projector_) - h).norm() <= 1e-6 * h.norm(); }
  double value(const Row& h) const { return h * theta_; }
  double u(const Row& h) const { return factor_ * by(h, root_).norm(); }
  double gain(const Row& h) const { return by(h, gain_).norm(); }
  Shares shares(const Row& h) const {
    return model_ == nullptr ? Shares{} : shares_of_readings(by(h, jacobian_));
  }
  /// Returns the derivatives of a functional by the readings; requires a model.
  Row by_readings(const Row& h) const { return by(h, jacobian_); }
  Shares shares_of_readings(const Row& J) const {
    if (model_ == nullptr) return {};
    return model_->shares({J.data(), static_cast<std::size_t>(J.size())});
  }

 private:
  static Row by(const Row& h, const Matrix& A) {
    return transposed_times(A, h.transpose()).transpose();
  }

  const ReadingModel* model_;
  Vector theta_;
  Matrix projector_, root_, gain_, jacobian_;
  std::size_t rank_ = 0, dof_ = 0;
  double scale_ = 0.0, factor_ = 1.0;
};

using Functional = std::vector<Row>;  ///< one row per point, n + 1 points

KnownCurve known(const Solution& s, const Functional& h) {
  KnownCurve out;
  double sum = 0.0;
  for (const Row& row : h) {
    out.value.push_back(s.value(row));
    out.u.push_back(s.u(row));
    out.shares.push_back(s.shares(row));
    sum += s.gain(row) * s.gain(row);
  }
  // The rms is over the inner points, because a curve minus its end-point line is 0 at both ends.
  // For a curve minus its least-squares line the gain is therefore too large, but it is not used.
  out.gain = std::sqrt(sum / static_cast<double>(h.size() - 2));
  return out;
}

Functional part(const Functional& h, double sign) {
  Functional out;
  for (std::size_t i = 0; i < h.size(); ++i)
    out.push_back((h[i] + sign * h[h.size() - 1 - i]) / 2.0);
  return out;
}

/// Returns the slope of the least-squares line through n + 1 equidistant points over this length.
Row slope(const Functional& h, double length) {
  const double n = static_cast<double>(h.size() - 1);
  Row sum = Row::Zero(h.front().size());
  double squares = 0.0;
  for (std::size_t i = 0; i < h.size(); ++i) {
    const double p = length * (static_cast<double>(i) / n - 0.5);
    sum += p * h[i];
    squares += p * p;
  }
  return sum / squares;
}

Functional less_line(const Functional& h) {
  const double n = static_cast<double>(h.size() - 1);
  const Row tilt = slope(h, 1.0);
  Row mean = Row::Zero(h.front().size());
  for (const Row& row : h) mean += row / (n + 1.0);
  Functional out;
  for (std::size_t i = 0; i < h.size(); ++i)
    out.push_back(h[i] - mean - tilt * (static_cast<double>(i) / n - 0.5));
  return out;
}

/// Only the even part of S = d1 + d2 can be an error of the machine. With a model of the readings,
/// the limits use the whole budget.
Closure closure_of(const System& system, std::size_t n, const Solution& solution) {
  const Matrix C = system.covariance();
  const auto S = [&](std::size_t i) {
    Row h = Row::Zero(C.rows());
    if (i > 0) h[at(i - 1)] = h[at(n + i - 1)] = 1.0;
    return h;
  };
  const double factor = solution.factor();
  const auto variance = [&](const Row& h) {
    double sum = factor * factor * h.dot(h * C);
    for (const double u : solution.shares_of_readings(h * system.N()).u) sum += u * u;
    return sum;
  };
  Closure c;
  c.S_n = S(n) * system.y();
  c.S_n_limit = closure_limit * std::sqrt(variance(S(n)));
  double sum = 0.0, expected = 0.0, points = 0.0;
  for (std::size_t i = 1; i < n; ++i) {
    if (2 * i == n) continue;  // an odd curve is 0 at mid-travel
    const Row odd = (S(i) - S(n - i)) / 2.0;
    const double v = odd * system.y();
    sum += v * v;
    expected += variance(odd);
    points += 1.0;
  }
  c.S_odd = std::sqrt(sum / points);
  c.S_odd_limit = closure_limit * std::sqrt(expected / points);
  return c;
}

/// Both lines of X must exist.
DiagonalResult::Racking racking_of(const DiagonalReadings& r, const System& system,
                                   const Solution& s, const std::vector<double>& ECX) {
  const auto X = of_direction(r.X, r.D1.x_direction);
  const auto [low, high] = std::minmax_element(ECX.begin(), ECX.end());
  DiagonalResult::Racking out;
  out.value = std::fabs(r.X[X[1]].across - r.X[X[0]].across) * (*high - *low);
  out.high = static_cast<std::size_t>(high - ECX.begin());
  out.low = static_cast<std::size_t>(low - ECX.begin());
  Row J = Row::Zero(system.N().cols());
  for (const auto& [k, sign] : {std::pair{X[0], 1.0}, std::pair{X[1], -1.0}}) {
    const std::size_t first = system.first_of_X() + k * (r.n + 1);
    J[at(first + out.high)] += sign;
    J[at(first + out.low)] -= sign;
  }
  double square = 0.0;
  for (Eigen::Index i = 0; i < J.size(); ++i)
    square += std::pow(J[i] * system.sigma()[static_cast<std::size_t>(i)], 2);
  out.u = s.factor() * std::sqrt(square);
  out.shares = s.shares_of_readings(J);
  return out;
}

void fill_yaw(const DiagonalReadings& r, const System& system, const Solution& s,
              DiagonalResult& out) {
  const auto X = of_direction(r.X, r.D1.x_direction);
  if (X.size() == 1 && r.ECX.empty()) return;
  const auto readings = system.N().cols();
  // The scatter of lengths contains no information about an angle.
  const bool known = system.noise_known() || X.size() == 2;
  const auto put = [&](double value, double u, const Row& J) {
    out.ECX.value.push_back(value);
    if (!known) return;
    out.ECX.u.push_back(s.factor() * u);
    out.ECX.shares.push_back(s.shares_of_readings(J));
  };
  const std::size_t curve = r.n + 1;
  // standard uncertainty of a difference from the first point
  const auto noise = [&](const MeanCurve& c, std::size_t i) {
    const double one = system.noise_known() ? c.u : 1.0;
    return i == 0 ? 0.0 : one * (c.zeroed ? 1.0 : std::sqrt(2.0));
  };
  if (X.size() == 1) {
    const std::size_t which = of_direction(r.ECX, r.D1.x_direction).front();
    const std::size_t first = system.first_of_yaw() + which * curve;
    const MeanCurve& yaw = r.ECX[which];
    for (std::size_t i = 0; i <= r.n; ++i) {
      Row J = Row::Zero(readings);
      J[at(first + i)] += 1.0;
      J[at(first)] -= 1.0;
      put(yaw.mean[i] - yaw.mean[0], noise(yaw, i), J);
    }
    return;
  }
  const PitchLine &one = r.X[X[0]], &other = r.X[X[1]];
  const double W = other.across - one.across;
  for (std::size_t i = 0; i <= r.n; ++i) {
    Row J = Row::Zero(readings);
    for (const auto& [k, sign] : {std::pair{X[0], 1.0}, std::pair{X[1], -1.0}}) {
      const std::size_t first = system.first_of_X() + k * curve;
      J[at(first + i)] += sign / W;
      J[at(first)] -= sign / W;
    }
    put(((one.mean[i] - one.mean[0]) - (other.mean[i] - other.mean[0])) / W,
        std::hypot(noise(one, i), noise(other, i)) / std::fabs(W), J);
  }
  out.slave_shift = W * out.C0Y;
  out.racking = racking_of(r, system, s, out.ECX.value);
}

double variance_of(const System& system, const Solution& s, const Row& J) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < J.size(); ++i) {
    const double sigma = s.factor() * system.sigma()[static_cast<std::size_t>(i)];
    sum += J[i] * J[i] * sigma * sigma;
  }
  for (const double u : s.shares_of_readings(J).u) sum += u * u;
  return sum;
}

Agreement agreement(const System& system, const Solution& s, const Functional& even,
                    const DirectStraightness& direct, std::size_t first, double dof) {
  const std::size_t n = direct.mean.size() - 1, curves = direct.reversed ? 2 : 1;
  std::vector<Row> J;
  Agreement out;
  for (std::size_t k = 1; 2 * k <= n; ++k) {
    Row row = -s.by_readings(even[k]);
    for (const auto& [i, share] :
         {std::pair{k, 0.5}, {n - k, 0.5}, {std::size_t{0}, -0.5}, {n, -0.5}})
      for (std::size_t c = 0; c < curves; ++c)
        row[at(first + c * (n + 1) + i)] += share / static_cast<double>(curves);
    out.difference.push_back(
        (direct.mean_of(k) + direct.mean_of(n - k) - direct.mean_of(0) - direct.mean_of(n)) / 2.0 -
        s.value(even[k]));
    out.u.push_back(std::sqrt(variance_of(system, s, row)));
    J.push_back(std::move(row));
  }
  const std::size_t m = J.size();
  Matrix V(at(m), at(m));
  for (std::size_t a = 0; a < m; ++a)
    for (std::size_t b = 0; b <= a; ++b)
      V(at(a), at(b)) = V(at(b), at(a)) =
          a == b
              ? out.u[a] * out.u[a]
              : (variance_of(system, s, J[a] + J[b]) - variance_of(system, s, J[a] - J[b])) / 4.0;
  const Eigen::Map<const Vector> d(out.difference.data(), at(m));
  out.chi2 = d.dot(solution(Eigen::LDLT<Matrix>(V), d));
  out.p = f_upper(out.chi2 / static_cast<double>(m), static_cast<double>(m), dof);
  for (std::size_t k = 1; k < m; ++k)
    if (std::fabs(out.difference[k]) * out.u[out.worst] >
        std::fabs(out.difference[out.worst]) * out.u[k])
      out.worst = k;
  ++out.worst;  // the first inner point is point 1 of the grid
  return out;
}

}  // namespace

Expected<DiagonalResult> solve_diagonals(const DiagonalReadings& r, const ReadingModel* model) {
  if (auto ok = check(r); !ok) return fail(ok.error());
  const System system(r);
  if (model != nullptr && at(model->readings()) != system.N().cols())
    return fail("expected a model of " + std::to_string(system.N().cols()) + " readings, found " +
                std::to_string(model->readings()));
  const Solution s(system, model);
  const double L = std::hypot(r.Lx, r.Ly);
  Functional f, g, q;
  for (std::size_t i = 0; i <= r.n; ++i) f.push_back(system.f(i)), g.push_back(system.g(i));
  for (std::size_t i = 0; i <= r.n; ++i) q.push_back(r.Lx / L * g[i] + r.Ly / L * f[i]);

  DiagonalResult out;
  out.unknowns = system.unknowns();
  const std::size_t slopes = static_cast<std::size_t>(system.A().cols()) - out.unknowns;
  out.rank = s.rank() - slopes;  // the slopes are always determined
  out.noise_known = system.noise_known();
  out.residual_u = s.scale();
  out.dof = s.dof();
  const Row square = system.k(), lsq = square - slope(f, r.Lx) - slope(g, r.Ly);
  for (const Functional& h : {part(f, 1.0), part(g, 1.0), part(q, -1.0), Functional{square, lsq}})
    for (const Row& row : h)
      if (!s.determined(row)) return fail("the readings do not determine what two diagonals do");
  out.C0Y = s.value(square);
  out.u_C0Y = s.u(square);
  out.shares_C0Y = s.shares(square);
  out.EYX_even = known(s, part(f, 1.0));
  out.EXY_even = known(s, part(g, 1.0));
  out.q_odd = known(s, part(q, -1.0));
  out.lsq.C0Y = s.value(lsq);
  out.lsq.u_C0Y = s.u(lsq);
  out.lsq.shares_C0Y = s.shares(lsq);
  if (out.separable()) {
    out.EYX = known(s, f);
    out.EXY = known(s, g);
    out.lsq.EYX = known(s, less_line(f));
    out.lsq.EXY = known(s, less_line(g));
  }
  for (auto [d, from] : {std::pair{&out.d1, 0UL}, std::pair{&out.d2, r.n}}) {
    d->push_back(0.0);
    for (std::size_t i = 0; i < r.n; ++i) d->push_back(system.y()[at(from + i)]);
  }
  out.closure = closure_of(system, r.n, s);
  fill_yaw(r, system, s, out);
  if (model != nullptr) {
    const double dof = system.noise_known() ? r.D1.dof : static_cast<double>(s.dof());
    if (r.EYX && !r.EYX->whole)
      out.EYX_agrees =
          agreement(system, s, part(f, 1.0), *r.EYX, system.first_of_direct(false), dof);
    if (r.EXY && !r.EXY->whole)
      out.EXY_agrees =
          agreement(system, s, part(g, 1.0), *r.EXY, system.first_of_direct(true), dof);
  }
  return out;
}

Band straightness_band(const DiagonalResult& r, double Lx, double Ly, double G) {
  const double L = std::hypot(Lx, Ly), c = Lx / L, s = Ly / L;
  Band band;
  const std::size_t n = r.q_odd.value.size() - 1;
  for (std::size_t i = 0; i <= n; ++i) {
    const double q = r.q_odd.value[i];
    // The odd part is 0 at the ends and at mid-travel.
    const double half = i == 0 || i == n || 2 * i == n ? 0.0 : c * G / s;
    band.low.push_back(r.EYX_even.value[i] + q / s - half);
    band.high.push_back(r.EYX_even.value[i] + q / s + half);
  }
  return band;
}

double diagonal_gain(double Lx, double Ly) { return std::hypot(Lx, Ly) / (2.0 * std::min(Lx, Ly)); }

}  // namespace nonio::math
