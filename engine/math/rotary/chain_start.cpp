// SPDX-License-Identifier: Apache-2.0
//
// Starting values of the fit of a chain: with given directions of its axes, the problem is linear,
//
//     M = k + sum_j A_j v_j + A dq - sum_j B_j w_j - B dt
//
// A_j: product of the first j rotations of the tables, v_j: vector from one of their points to the
// next, finally to the ball; B_j, w_j: likewise for the heads, finally to the tip; k: first point
// of the tables (the ball, if there are none) minus that of the heads; dq, dt: positions of other
// balls and tips relative to the first.
#include "chain_start.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace nonio::math {

namespace chain {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr std::size_t kept = 4;  // number of starts that are refined
// relative eigenvalue below which a combination is undetermined
constexpr double least_share = 1e-12;
constexpr double good_enough = 0.05;  // rms residual relative to the rms distance from reading 1
constexpr double same_angle = 1e-9;   // tolerance for equal angles, rad

using Directions = std::vector<Vector3>;

/// Returns directions along the machine's axes, and if `between` also halfway between two of them.
Directions directions(bool between) {
  Directions out;
  for (std::size_t k = 0; k < 3; ++k)
    for (const double sign : {1.0, -1.0}) {
      Vector3 n{};
      n[k] = sign;
      out.push_back(n);
    }
  for (std::size_t k = 0; between && k < 3; ++k)
    for (const double one : {1.0, -1.0})
      for (const double other : {1.0, -1.0}) {
        Vector3 n{};
        n[k] = one / std::numbers::sqrt2, n[(k + 1) % 3] = other / std::numbers::sqrt2;
        out.push_back(n);
      }
  return out;
}

class Linear {
 public:
  Linear(const std::vector<ChainReading>& all, const ChainOrder& order, Directions n)
      : order_(order), n_(std::move(n)), blocks_(1 + order.axes() + order.balls + order.tools - 2) {
    MatrixXd normal = MatrixXd::Zero(3 * at(blocks_), 3 * at(blocks_));
    VectorXd right = VectorXd::Zero(3 * at(blocks_));
    for (const ChainReading& r : all) {
      const auto blocks = blocks_of(r);
      for (const auto& [i, a] : blocks) {
        right.segment<3>(3 * at(i)) += r.weight * a.transpose() * as_vector(r.at);
        for (const auto& [k, b] : blocks)
          normal.block<3, 3>(3 * at(i), 3 * at(k)) += r.weight * a.transpose() * b;
      }
    }
    const Spectrum s = spectrum(normal);
    x_ = VectorXd::Zero(right.size());
    for (Index k = 0; k < s.values.size(); ++k)
      if (s.values[k] > least_share * s.values[s.values.size() - 1])
        x_ += s.vectors.col(k) * (s.vectors.col(k).dot(right) / s.values[k]);
    for (const ChainReading& r : all) {
      Vector3d left = as_vector(r.at);
      for (const auto& [i, a] : blocks_of(r)) left -= a * x_.segment<3>(3 * at(i));
      sum_ += r.weight * left.squaredNorm();
    }
  }

  double sum() const { return sum_; }

  ChainState state() const {
    ChainState s;
    for (const Vector3& n : n_) s.lines.push_back({{}, n});
    Vector3d first_head = Vector3d::Zero();
    for (std::size_t l = order_.axes(); l-- > order_.tables;) {
      first_head -= part(1 + l);
      s.lines[l].point = as_array(first_head);
    }
    Vector3d point = part(0) + first_head;
    for (std::size_t l = 0; l < order_.tables; ++l) {
      s.lines[l].point = as_array(point);
      point += part(1 + l);
    }
    std::size_t block = 1 + order_.axes();
    s.ball.push_back(as_array(point));
    for (std::size_t b = 1; b < order_.balls; ++b)
      s.ball.push_back(as_array(point + part(block++)));
    s.tool.push_back({});
    for (std::size_t t = 1; t < order_.tools; ++t) s.tool.push_back(as_array(part(block++)));
    return s;
  }

 private:
  std::vector<std::pair<std::size_t, Matrix3d>> blocks_of(const ChainReading& r) const {
    std::vector<std::pair<std::size_t, Matrix3d>> out{{0, Matrix3d::Identity()}};
    Matrix3d table = Matrix3d::Identity(), head = -Matrix3d::Identity();
    for (std::size_t l = 0; l < order_.axes(); ++l) {
      Matrix3d& turned = l < order_.tables ? table : head;
      turned = turned * turn(n_[l], r.angle[l]);
      out.emplace_back(1 + l, turned);
    }
    const std::size_t balls = 1 + order_.axes(), tools = balls + order_.balls - 1;
    if (r.ball > 0) out.emplace_back(balls + r.ball - 1, table);
    if (r.tool > 0) out.emplace_back(tools + r.tool - 1, head);
    return out;
  }
  Vector3d part(std::size_t block) const { return x_.segment<3>(3 * at(block)); }

  ChainOrder order_;
  Directions n_;
  std::size_t blocks_;
  VectorXd x_;
  double sum_ = 0.0;
};

/// For an axis at rest, one direction is sufficient.
std::vector<Linear> best_of(const std::vector<ChainReading>& all, const ChainOrder& order,
                            bool between) {
  std::vector<Directions> tried(1);
  for (std::size_t l = 0; l < order.axes(); ++l) {
    Directions each = directions(between);
    if (std::all_of(all.begin(), all.end(), [&](const ChainReading& r) {
          return std::fabs(r.angle[l] - all.front().angle[l]) < same_angle;
        }))
      each.resize(1);
    std::vector<Directions> longer;
    for (const Directions& before : tried)
      for (const Vector3& n : each) {
        longer.push_back(before);
        longer.back().push_back(n);
      }
    tried = std::move(longer);
  }
  std::vector<Linear> out;
  for (Directions& n : tried) {
    out.emplace_back(all, order, std::move(n));
    std::stable_sort(out.begin(), out.end(),
                     [](const auto& a, const auto& b) { return a.sum() < b.sum(); });
    if (out.size() > kept) out.pop_back();
  }
  return out;
}

}  // namespace

Matrix3d turn(const Vector3& n, double angle) {
  Matrix3d cross;
  cross << 0.0, -n[2], n[1], n[2], 0.0, -n[0], -n[1], n[0], 0.0;
  return Matrix3d::Identity() + std::sin(angle) * cross + (1.0 - std::cos(angle)) * cross * cross;
}

std::vector<ChainState> chain_starts(const std::vector<ChainReading>& all,
                                     const ChainOrder& order) {
  double size = 0.0;
  for (const ChainReading& r : all)
    size += r.weight * (as_vector(r.at) - as_vector(all.front().at)).squaredNorm();
  auto best = best_of(all, order, false);
  if (best.front().sum() > good_enough * good_enough * size) best = best_of(all, order, true);
  std::vector<ChainState> out;
  for (const Linear& one : best) out.push_back(one.state());
  return out;
}

}  // namespace chain

Vector3 chain_reading(const ChainState& s, const ChainOrder& order, const ChainReading& r) {
  using chain::as_vector;
  Eigen::Vector3d ball = as_vector(s.ball[r.ball]), tip = as_vector(s.tool[r.tool]);
  for (std::size_t l = order.axes(); l-- > 0;) {
    Eigen::Vector3d& carried = l < order.tables ? ball : tip;
    const Eigen::Vector3d c = as_vector(s.lines[l].point);
    carried = c + chain::turn(s.lines[l].direction, r.angle[l]) * (carried - c);
  }
  return chain::as_array(ball - tip);
}

}  // namespace nonio::math
