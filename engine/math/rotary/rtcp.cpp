// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/rtcp.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "dense.h"

namespace nonio::math {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double least_radius = 1e-3;  // m; a smaller circle does not determine an axis
constexpr double same_ball = 1e-3;     // m; tolerance for positions of one ball in two lines
// Thresholds for singular values (of columns with norm at most 1) and for distances from the row
// space; the rounding of displayed commanded positions changes columns by about 1e-5 only.
constexpr double least_share = 1e-3, in_row_space = 1e-2;

Vector3d eigen(const Vector3& v) { return {v[0], v[1], v[2]}; }
Vector3 plain(const Vector3d& v) { return {v[0], v[1], v[2]}; }

Matrix3d turn(const Vector3d& n, double angle) {
  Matrix3d cross;
  cross << 0.0, -n[2], n[1], n[2], 0.0, -n[0], -n[1], n[0], 0.0;
  return Matrix3d::Identity() + std::sin(angle) * cross + (1.0 - std::cos(angle)) * cross * cross;
}

/// Returns std::nullopt if the positions follow no circle, or one with a radius below
/// `least_radius`.
std::optional<RotaryFit> circle_of(const std::vector<RtcpReading>& all, std::size_t line) {
  std::map<long long, BallCentre> places;
  for (const RtcpReading& r : all) {
    if (r.line != line) continue;
    BallCentre& c = places
                        .try_emplace(std::llround(std::remainder(r.angle, 6.283185307179586) * 1e5),
                                     BallCentre{{}, r.angle, 0.0})
                        .first->second;
    c.weight += 1.0;
    for (std::size_t k = 0; k < 3; ++k) c.at[k] += (r.at[k] - c.at[k]) / c.weight;
  }
  std::vector<BallCentre> centres;
  for (auto& [place, centre] : places) {
    centre.weight = 1.0;
    centres.push_back(centre);
  }
  auto fit = fit_rotary(centres, false);
  if (!fit || fit->radius < least_radius) return std::nullopt;
  return std::move(*fit);
}

class Readings {
 public:
  Readings(const std::vector<RtcpReading>& all, const RtcpWish& wish) : all_(all), wish_(wish) {}

  std::optional<RtcpRefusal> prepare() {
    std::size_t lines = 0;
    for (const RtcpReading& r : all_) lines = std::max(lines, r.line + 1);
    std::vector<std::optional<RotaryFit>> circles;
    const RotaryFit* largest = nullptr;
    for (std::size_t l = 0; l < lines; ++l) circles.push_back(circle_of(all_, l));
    for (const auto& c : circles)
      if (c && (largest == nullptr || c->radius > largest->radius)) largest = &*c;
    if (largest == nullptr) return RtcpRefusal::none_go_round;
    n0_ = eigen(largest->direction);
    c0_ = eigen(largest->centre);
    double off = 0.0;
    for (std::size_t l = 0; l < lines; ++l) {
      if (wish_.head && !circles[l]) return RtcpRefusal::none_go_round;
      ball_.push_back(place_of(l, circles[l] ? eigen(circles[l]->centre) : c0_, off));
    }
    if (off > rtcp_circle)
      return largest->s > rtcp_circle / 2.0 ? RtcpRefusal::not_a_circle : RtcpRefusal::disagree;
    choose_axes();
    choose_point();
    number();
    return std::nullopt;
  }

  Eigen::Index count() const { return static_cast<Eigen::Index>(all_.size()); }
  Eigen::Index unknowns() const { return unknowns_; }
  const std::vector<std::size_t>& ball_of_line() const { return which_; }
  const std::vector<Vector3d>& balls() const { return known_; }
  const Vector3d& point() const { return c0_; }
  const Vector3d& direction() const { return n0_; }
  const std::array<std::size_t, 2>& across() const { return across_; }

  VectorXd predicted(const VectorXd& x) const {
    Vector3d c = c0_, n = n0_;
    const auto e1 = static_cast<Eigen::Index>(across_[0]),
               e2 = static_cast<Eigen::Index>(across_[1]), e3 = 3 - e1 - e2;
    c[e1] += x[0], c[e2] += x[1];
    n[e1] += x[2], n[e2] += x[3];
    n[e3] -= (x[2] * n0_[e1] + x[3] * n0_[e2]) / n0_[e3];
    n.normalize();
    VectorXd out(count());
    for (Eigen::Index i = 0; i < count(); ++i) {
      const RtcpReading& r = all_[static_cast<std::size_t>(i)];
      const Vector3d& b = ball_[r.line];
      Vector3d d = Vector3d::Zero();
      if (ball_at_[r.line] >= 0) d = x.segment<3>(ball_at_[r.line]);
      const Vector3d moved =
          c + turn(n, r.angle) * (b + d - c) - c0_ - turn(n0_, r.angle) * (b - c0_);
      out[i] = (wish_.head ? 1.0 : -1.0) * eigen(r.sense).dot(moved);
      if (zero_at_[r.line] >= 0) out[i] += x[zero_at_[r.line]];
    }
    return out;
  }

  MatrixXd jacobian(const VectorXd& x) const {
    constexpr double step = 1e-6;
    MatrixXd out(count(), unknowns());
    for (Eigen::Index k = 0; k < unknowns(); ++k) {
      VectorXd up = x, down = x;
      up[k] += step, down[k] -= step;
      out.col(k) = (predicted(up) - predicted(down)) / (2.0 * step);
    }
    return out;
  }

  Vector3d by_ball(const RtcpReading& r) const {
    return (wish_.head ? 1.0 : -1.0) * (turn(n0_, r.angle).transpose() * eigen(r.sense));
  }

  VectorXd deviations() const {
    VectorXd y(count());
    for (Eigen::Index i = 0; i < count(); ++i) y[i] = all_[static_cast<std::size_t>(i)].deviation;
    return y;
  }

 private:
  /// Returns the mean position of the ball of a line in the control, with the axis at 0, and raises
  /// `off` to the largest distance of a reading from it, m. With a head, the linear axes move back
  /// by the vector from its pivot (at c0) to the ball.
  Vector3d place_of(std::size_t line, const Vector3d& middle, double& off) const {
    Vector3d mean = Vector3d::Zero();
    double n = 0.0;
    const auto from_axis = [&](const RtcpReading& r) -> Vector3d {
      const Vector3d way =
          wish_.head ? Vector3d(middle - eigen(r.at)) : Vector3d(eigen(r.at) - c0_);
      return turn(n0_, r.angle).transpose() * way;
    };
    for (const RtcpReading& r : all_)
      if (r.line == line) mean += from_axis(r), n += 1.0;
    mean /= std::max(n, 1.0);
    for (const RtcpReading& r : all_)
      if (r.line == line) off = std::max(off, (from_axis(r) - mean).norm());
    return c0_ + mean;
  }

  void choose_axes() {
    std::size_t along = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (std::fabs(n0_[static_cast<Eigen::Index>(k)]) >
          std::fabs(n0_[static_cast<Eigen::Index>(along)]))
        along = k;
    across_ = {along == 0 ? 1U : 0U, along == 2 ? 1U : 2U};
  }

  /// a and b refer to the mean height of the balls that are sensed across the axis, otherwise of
  /// all balls.
  void choose_point() {
    double height[2] = {0.0, 0.0}, n[2] = {0.0, 0.0};
    for (const RtcpReading& r : all_) {
      const double h = (ball_[r.line] - c0_).dot(n0_);
      const bool senses = std::fabs(eigen(r.sense).dot(n0_)) < 0.9;
      for (const int k : {0, 1})
        if (k == 1 || senses) height[k] += h, n[k] += 1.0;
    }
    const int k = n[0] > 0.0 ? 0 : 1;
    c0_ += height[k] / n[k] * n0_;
  }

  void number() {
    unknowns_ = 4;
    std::vector<Eigen::Index> at;
    zero_at_.assign(ball_.size(), -1);
    for (std::size_t l = 0; l < ball_.size(); ++l) {
      const bool has_zero = std::any_of(all_.begin(), all_.end(), [&](const RtcpReading& r) {
        return r.line == l && r.has_zero;
      });
      if (!has_zero) zero_at_[l] = unknowns_++;
      std::size_t b = 0;
      while (b < known_.size() && !((known_[b] - ball_[l]).norm() < same_ball)) ++b;
      if (b == known_.size()) {
        known_.push_back(ball_[l]);
        at.push_back(wish_.ball_known ? -1 : unknowns_);
        unknowns_ += wish_.ball_known ? 0 : 3;
      }
      which_.push_back(b);
      ball_at_.push_back(at[b]);
    }
  }

  const std::vector<RtcpReading>& all_;
  const RtcpWish& wish_;
  Vector3d n0_, c0_;
  std::array<std::size_t, 2> across_{0, 1};
  std::vector<Vector3d> ball_;   // ball position of each line
  std::vector<Vector3d> known_;  // positions of the distinct balls
  std::vector<std::size_t> which_;
  // by line: first index of the ball's unknown position; -1: known
  std::vector<Eigen::Index> ball_at_;
  std::vector<Eigen::Index> zero_at_;  // by line: index of its unknown zero; -1: known
  Eigen::Index unknowns_ = 4;
};

/// Least squares by singular values: combinations that the columns do not determine are set to 0.
struct Solved {
  MatrixXd inverse;
  Eigen::Index rank = 0;
  std::array<bool, 4> identifiable{};
};

Solved solved(const MatrixXd& j) {
  // One scale for all lengths and one for both tilts: a column of rounding errors remains small.
  const VectorXd norm = j.colwise().norm();
  const double tilt = std::max(norm[2], norm[3]);
  double length = 0.0;
  VectorXd scale(norm.size());
  for (Eigen::Index k = 0; k < norm.size(); ++k)
    if (k != 2 && k != 3) length = std::max(length, norm[k]);
  for (Eigen::Index k = 0; k < norm.size(); ++k) scale[k] = k == 2 || k == 3 ? tilt : length;
  MatrixXd normed = j;
  for (Eigen::Index k = 0; k < scale.size(); ++k)
    normed.col(k) *= scale[k] > 0.0 ? 1.0 / scale[k] : 0.0;
  const Eigen::JacobiSVD<MatrixXd> svd(normed, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const VectorXd& s = svd.singularValues();
  Solved out;
  MatrixXd v = svd.matrixV(), u = svd.matrixU();
  while (out.rank < s.size() && s[out.rank] > least_share * s[0]) ++out.rank;
  const MatrixXd row_space = left_columns(v, out.rank);
  out.inverse = product_transposed(scaled_columns(row_space, s.head(out.rank).cwiseInverse()),
                                   left_columns(u, out.rank));
  for (Eigen::Index k = 0; k < scale.size(); ++k)
    out.inverse.row(k) *= scale[k] > 0.0 ? 1.0 / scale[k] : 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    VectorXd unit = VectorXd::Zero(j.cols());
    unit[i] = 1.0;
    const VectorXd left = residual(unit, product_transposed(row_space, row_space), unit);
    out.identifiable[k] = scale[i] > 0.0 && left.norm() < in_row_space;
  }
  return out;
}

}  // namespace

tl::expected<RtcpFit, RtcpRefusal> fit_rtcp(const std::vector<RtcpReading>& all,
                                            const RtcpWish& wish) {
  Readings readings(all, wish);
  if (const auto refused = readings.prepare()) return tl::unexpected(*refused);
  const VectorXd y = readings.deviations();
  VectorXd x = VectorXd::Zero(readings.unknowns());
  // With errors of 1e-3 rad, each iteration with the Jacobian at the axis of the control reduces
  // the remainder by a factor of about 1000.
  const MatrixXd j = readings.jacobian(x);
  const Solved solution = solved(j);
  for (int round = 0; round < 6; ++round) x += times(solution.inverse, y - readings.predicted(x));
  RtcpFit fit;
  fit.point = plain(readings.point());
  fit.direction = plain(readings.direction());
  fit.across = readings.across();
  fit.identifiable = fit.identifiable_with_ball = solution.identifiable;
  if (!wish.ball_known) {
    RtcpWish with = wish;
    with.ball_known = true;
    Readings other(all, with);
    if (!other.prepare())
      fit.identifiable_with_ball =
          solved(other.jacobian(VectorXd::Zero(other.unknowns()))).identifiable;
  }
  fit.ball = readings.ball_of_line();
  for (const Vector3d& ball : readings.balls()) fit.place.push_back(plain(ball));
  const VectorXd residual = y - readings.predicted(x);
  fit.residual.assign(residual.data(), residual.data() + residual.size());
  fit.dof = static_cast<int>(all.size()) - static_cast<int>(solution.rank);
  fit.s = fit.dof > 0 ? residual.norm() / std::sqrt(fit.dof) : 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    const VectorXd row = solution.inverse.row(static_cast<Eigen::Index>(k)).transpose();
    fit.value[k] = x[static_cast<Eigen::Index>(k)];
    fit.by[k].assign(row.data(), row.data() + row.size());
  }
  constexpr std::size_t most_residuals = 1000;
  if (all.size() <= most_residuals) {
    MatrixXd left = MatrixXd::Identity(readings.count(), readings.count());
    left -= product(j, solution.inverse);
    for (Eigen::Index i = 0; i < readings.count(); ++i) {
      const VectorXd row = left.row(i).transpose();
      fit.residual_by.emplace_back(row.data(), row.data() + row.size());
    }
  }
  for (const RtcpReading& r : all) {
    const Vector3d by = readings.by_ball(r);
    for (std::size_t k = 0; k < 3; ++k) fit.by_ball[k].push_back(by[static_cast<Eigen::Index>(k)]);
  }
  return fit;
}

}  // namespace nonio::math
