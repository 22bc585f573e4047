// SPDX-License-Identifier: Apache-2.0
//
// The noise is white plus a slow part (statistics/path_noise.h). Effective degrees of freedom: (n -
// parameters)/g, with g the variance of a slow column relative to that of white noise, at least 1.
// A second constant is fitted only if it makes the residuals significantly smaller (F, level 1 %).
#include <algorithm>
#include <cmath>

#include "nonio/math/distributions.h"
#include "nonio/math/thermal.h"
#include "statistics/path_noise.h"

namespace nonio::math {

namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

constexpr std::size_t most_means = 120, fewest = 12;
// Reason for these limits: docs/dev/constants.md, A15.
constexpr double longest_share = 0.5;   // largest time constant, as a fraction of the test
constexpr double largest_u_tau = 0.25;  // largest relative uncertainty of a time constant
constexpr double second_level = 0.01;
constexpr double apart = 2.0;  // smallest ratio of two time constants

/// `v`: variance of the times in each interval; `place`: index of the interval.
struct Means {
  Vector t, d, v;
  std::vector<int> place;
  double duration = 0.0, step = 0.0;
};

Means means_of(const Track& k) {
  Means out;
  const double start = k.time.front();
  out.duration = k.time.back() - start;
  const auto bins = static_cast<double>(std::min(k.size(), most_means));
  out.step = out.duration / (bins - 1.0);
  std::vector<double> t, d, n, squares;
  for (std::size_t i = 0; i < k.size(); ++i) {
    const int at = static_cast<int>(std::lround((k.time[i] - start) / out.step));
    if (out.place.empty() || out.place.back() != at) {
      out.place.push_back(at);
      t.push_back(0.0), d.push_back(0.0), n.push_back(0.0), squares.push_back(0.0);
    }
    // Sum relative to the middle of the interval, to reduce rounding errors.
    const double off = k.time[i] - start - at * out.step;
    t.back() += off, d.back() += k.d[i], n.back() += 1.0, squares.back() += off * off;
  }
  out.t.resize(at(t.size())), out.d.resize(at(t.size())), out.v.resize(at(t.size()));
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double off = t[i] / n[i];
    out.t[at(i)] = out.place[i] * out.step + off, out.d[at(i)] = d[i] / n[i];
    out.v[at(i)] = std::max(0.0, squares[i] / n[i] - off * off);
  }
  return out;
}

struct Settling {
  std::vector<double> log_tau;
  Vector beta;
  Matrix jacobian;
  double rss = INFINITY;  ///< whitened residual sum of squares
};

Matrix columns_for(const Means& m, const std::vector<double>& log_tau) {
  Matrix X(m.t.size(), at(1 + log_tau.size()));
  X.col(0).setOnes();
  for (std::size_t k = 0; k < log_tau.size(); ++k) {
    const double tau = std::exp(log_tau[k]);
    // Mean of exp(-t/tau) over times of variance v: 1 + v/(2 tau^2) times its value at their mean.
    X.col(at(k + 1)) = m.t.binaryExpr(m.v, [tau](double t, double v) {
      return -std::expm1(-t / tau) - std::exp(-t / tau) * v / (2.0 * tau * tau);
    });
  }
  return X;
}

Settling linear(const Means& m, const std::vector<double>& log_tau, const PathNoise& noise) {
  Matrix both = with_column(columns_for(m, log_tau), m.d);
  whiten(both, m.place, noise);
  const Eigen::Index k = both.cols() - 1;
  const Matrix X = left_columns(both, k);
  const Vector y = both.col(k);
  Settling out{log_tau, least_squares(X, y), {}, 0.0};
  out.rss = squared_residual(y, X, out.beta);
  if (!std::isfinite(out.rss)) out.rss = INFINITY;
  return out;
}

Vector left_of(const Means& m, const Settling& c) {
  return residual(m.d, columns_for(m, c.log_tau), c.beta);
}

Matrix jacobian_of(const Means& m, const Settling& c) {
  Matrix J(m.t.size(), at(1 + 2 * c.log_tau.size()));
  const Matrix X = columns_for(m, c.log_tau);
  for (Eigen::Index k = 0; k < X.cols(); ++k) J.col(k) = X.col(k);
  for (std::size_t k = 0; k < c.log_tau.size(); ++k) {
    const double tau = std::exp(c.log_tau[k]), size = c.beta[at(k + 1)];
    J.col(X.cols() + at(k)) = m.t.binaryExpr(m.v, [tau, size](double t, double v) {
      const double x = t / tau, w = v / (tau * tau);
      return -size * std::exp(-x) * (x * (1.0 + w / 2.0) - w);
    });
  }
  return J;
}

std::vector<double> grid(const Means& m, int count) {
  std::vector<double> out;
  const double low = std::log(m.step / 2.0), high = std::log(3.0 * m.duration);
  for (int i = 0; i < count; ++i) out.push_back(low + (high - low) * i / (count - 1.0));
  return out;
}

Settling searched(const Means& m, std::size_t parts, const PathNoise& noise) {
  Settling best;
  const auto attempt = [&](std::vector<double> log_tau) {
    Settling c = linear(m, log_tau, noise);
    if (c.rss < best.rss) best = std::move(c);
  };
  const auto one = grid(m, parts == 1 ? 40 : 18);
  for (std::size_t i = 0; i < one.size(); ++i) {
    if (parts == 1) attempt({one[i]});
    for (std::size_t j = i + 1; parts == 2 && j < one.size(); ++j) attempt({one[j], one[i]});
  }
  return best;
}

/// Gauss-Newton steps in ln tau are halved while they increase the residuals. Small steps are
/// always accepted, so that rounding does not decide where the search ends.
void refine(const Means& m, const PathNoise& noise, Settling& c) {
  constexpr int most = 60;
  constexpr double near = 1e-4, reached = 1e-11;
  const std::size_t parts = c.log_tau.size();
  for (int step = 0; step < most; ++step) {
    const Matrix J = jacobian_of(m, c);
    Matrix both = with_column(J, left_of(m, c));
    whiten(both, m.place, noise);
    const Vector move = least_squares(left_columns(both, J.cols()), both.col(J.cols()));
    bool better = false;
    double largest = 0.0;
    for (double share = 1.0; share > 0.02 && !better; share /= 2.0) {
      std::vector<double> log_tau = c.log_tau;
      largest = 0.0;
      for (std::size_t k = 0; k < parts; ++k) {
        const double change = share * std::clamp(move[at(1 + parts + k)], -1.0, 1.0);
        log_tau[k] += change, largest = std::max(largest, std::fabs(change));
        log_tau[k] = std::clamp(log_tau[k], std::log(m.step / 20.0), std::log(100.0 * m.duration));
      }
      Settling next = linear(m, log_tau, noise);
      better = next.rss < c.rss || largest < near;
      if (better) c = std::move(next);
    }
    if (!better || largest < reached) break;
  }
  c.jacobian = jacobian_of(m, c);
}

struct Fitted {
  Settling curve;
  PathNoise noise;
};

Fitted fitted(const Means& m, std::size_t parts) {
  Fitted out;
  for (int round = 0; round < 3; ++round) {
    Settling c = searched(m, parts, out.noise);
    refine(m, out.noise, c);
    const Vector linearised = left_of(m, c);
    out.curve = std::move(c);
    if (round == 2) break;
    const PathNoise before = out.noise;
    out.noise = path_noise(out.curve.jacobian, linearised, m.place);
    if (std::fabs(before.rho - out.noise.rho) + std::fabs(before.w - out.noise.w) < 1e-6) break;
  }
  return out;
}

double rss_with(const Means& m, const Settling& c, const PathNoise& noise) {
  Matrix rest = left_of(m, c);
  whiten(rest, m.place, noise);
  return rest.squaredNorm();
}

/// Returns whether a second time constant is significant and differs by a factor of `apart` or
/// more. Both curves are compared under the noise estimated with two time constants.
bool two_parts(const Means& m, const Fitted& two) {
  Settling one = searched(m, 1, two.noise);
  refine(m, two.noise, one);
  const double n = static_cast<double>(m.t.size()), dof = n / two.noise.slow() - 5.0;
  const double rss = rss_with(m, two.curve, two.noise);
  if (!(dof > 1.0)) return false;
  if (std::fabs(two.curve.log_tau[0] - two.curve.log_tau[1]) < std::log(apart)) return false;
  const double f = test_ratio((one.rss - rss) / 2.0, rss / (n - 5.0));
  return significant(f_upper(f, 2.0, dof), second_level);
}

void put_parts(const Means& m, const Fitted& f, TimeConstants& out) {
  const Settling& c = f.curve;
  Matrix J = c.jacobian;
  whiten(J, m.place, f.noise);
  const double n = static_cast<double>(m.t.size()), p = static_cast<double>(J.cols()),
               g = f.noise.slow();
  out.dof = std::max(1.0, (n - p) / g);
  const double s2 = rss_with(m, c, f.noise) / std::max(1.0, n - p);
  out.s = std::sqrt(s2);
  const Matrix cov = s2 * inverse(Eigen::ColPivHouseholderQR<Matrix>(transposed_product(J, J)));
  const std::size_t parts = c.log_tau.size();
  std::vector<std::size_t> order(parts);
  for (std::size_t k = 0; k < parts; ++k) order[k] = k;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return c.log_tau[a] > c.log_tau[b]; });
  std::vector<std::size_t> rows{0};
  for (const std::size_t k : order) rows.push_back(1 + k), rows.push_back(1 + parts + k);
  for (const std::size_t a : rows) {
    out.covariance.emplace_back();
    for (const std::size_t b : rows) out.covariance.back().push_back(cov(at(a), at(b)));
  }
  out.d0 = c.beta[0];
  for (std::size_t i = 0; i < parts; ++i) {
    const double tau = std::exp(c.log_tau[order[i]]);
    out.parts.push_back({c.beta[at(1 + order[i])], tau,
                         std::sqrt(std::max(0.0, out.covariance[1 + 2 * i][1 + 2 * i])),
                         tau * std::sqrt(std::max(0.0, out.covariance[2 + 2 * i][2 + 2 * i]))});
  }
}

}  // namespace

double TimeConstants::at(double t) const {
  double sum = d0;
  for (const Part& p : parts) sum -= p.c * std::expm1(-t / p.tau);
  return sum;
}

double TimeConstants::rest(double t) const {
  double sum = 0.0;
  for (const Part& p : parts) sum += p.c * std::exp(-t / p.tau);
  return sum;
}

TimeConstants::Time TimeConstants::settled(double limit) const {
  if (parts.empty() || !(limit > 0.0)) return {};
  const double slowest = parts.front().tau;
  double most = 0.0;
  for (const Part& p : parts) most += std::fabs(p.c);
  if (most <= limit) return {};
  // After `high`, abs(rest) remains below the limit, so that the last crossing is before `high`.
  double high = slowest * std::log(most / limit), low = 0.0;
  constexpr int steps = 4000;
  int crossing = -1;
  for (int i = 0; i <= steps; ++i)
    if (std::fabs(rest(high * i / steps)) > limit) crossing = i;
  if (crossing < 0) return {};
  low = high * crossing / steps, high = std::min(high, high * (crossing + 1.0) / steps);
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2.0;
    (std::fabs(rest(middle)) > limit ? low : high) = middle;
  }
  Time out{high, 0.0};
  double slope = 0.0;
  std::vector<double> by{0.0};
  for (const Part& p : parts) {
    const double e = std::exp(-out.t / p.tau);
    slope -= p.c / p.tau * e;
    by.push_back(e), by.push_back(p.c * out.t / p.tau * e);
  }
  double variance = 0.0;
  for (std::size_t a = 0; a < by.size(); ++a)
    for (std::size_t b = 0; b < by.size(); ++b) variance += by[a] * by[b] * covariance[a][b];
  out.u = std::sqrt(std::max(0.0, variance)) / std::max(std::fabs(slope), 1e-300);
  return out;
}

TimeConstants time_constants(const Track& k) {
  TimeConstants out;
  if (k.size() < fewest || !(k.time.back() > k.time.front())) return out;
  const Means m = means_of(k);
  if (m.place.size() < fewest) return out;
  out.largest = longest_share * m.duration;
  const double level = m.d.mean(), spread = (m.d.array() - level).matrix().norm();
  // If all readings are equal up to rounding, there is no curve.
  if (!(spread > 1e-9 * std::fabs(level) * std::sqrt(static_cast<double>(m.t.size())))) {
    out.answer = TimeConstants::Answer::none;
    return out;
  }
  Fitted best = fitted(m, 1);
  if (m.place.size() >= 2 * fewest)
    if (Fitted two = fitted(m, 2); two_parts(m, two)) best = std::move(two);
  put_parts(m, best, out);
  using Answer = TimeConstants::Answer;
  bool none = true, resolved = true, within = true;
  for (const auto& p : out.parts) {
    none = none && !(std::fabs(p.c) > coverage_factor(out.dof) * p.u_c);
    within = within && p.tau <= out.largest;
    resolved = resolved && p.u_tau <= largest_u_tau * p.tau && std::isfinite(p.u_tau);
  }
  out.answer = !within     ? Answer::too_short
               : none      ? Answer::none
               : !resolved ? Answer::unresolved
                           : Answer::resolved;
  return out;
}

}  // namespace nonio::math
