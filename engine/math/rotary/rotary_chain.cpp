// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/rotary_chain.h"

#include <algorithm>
#include <cmath>

#include "chain_start.h"
#include "combinations.h"
#include "common/constants.h"

namespace nonio::math {
namespace {

using namespace chain;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double derivative_step = 1e-6;  // m and rad, step of numerical derivatives
constexpr double ended = 1e-12;           // m: a smaller step ends the iteration
constexpr int most_steps = 60;
constexpr double largest_tilt = 0.5;  // largest change of a direction in one step, rad
// largest ratio of the sums of squares of two chains that fit equally well
constexpr double fits_alike = 4.0;
constexpr double other_way = 0.1;  // smallest angle between directions of two different chains, rad
constexpr double open_changes_nothing = 1e-5, rounding_size = 1e-9;
constexpr std::size_t most_residual_rows = 200;

bool sound(const std::vector<ChainReading>& all, const ChainOrder& order) {
  return std::all_of(all.begin(), all.end(), [&](const ChainReading& r) {
    bool good = r.angle.size() == order.axes() && r.weight > 0.0 && std::isfinite(r.weight) &&
                r.ball < order.balls && r.tool < order.tools;
    for (const double x : r.at) good = good && std::fabs(x) <= largest_coordinate;
    for (const double a : r.angle) good = good && std::isfinite(a);
    return good;
  });
}

/// Lever that converts a tilt to a length: the largest range of a coordinate, at least 1 mm, m.
double extent_of(const std::vector<ChainReading>& all) {
  double size = 1e-3;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [low, high] = std::minmax_element(
        all.begin(), all.end(), [k](const auto& a, const auto& b) { return a.at[k] < b.at[k]; });
    size = std::max(size, high->at[k] - low->at[k]);
  }
  return size;
}

std::size_t unknowns_of(const ChainOrder& order) {
  return 4 * order.axes() + 3 * order.balls + 3 * (order.tools - 1);
}

std::array<std::size_t, 2> across(const ChainLine& line) {
  std::size_t along = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (std::fabs(line.direction[k]) > std::fabs(line.direction[along])) along = k;
  return {along == 0 ? 1U : 0U, along == 2 ? 1U : 2U};
}

void tilt(ChainLine& line, const std::array<std::size_t, 2>& e, double p, double q) {
  Vector3& n = line.direction;
  const std::size_t third = 3 - e[0] - e[1];
  const double change = (p * n[e[0]] + q * n[e[1]]) / n[third];
  n[e[0]] += p, n[e[1]] += q, n[third] -= change;
  n = as_array(as_vector(n).normalized());
}

ChainState moved(ChainState s, const VectorXd& by) {
  Index k = 0;
  for (ChainLine& line : s.lines) {
    const auto e = across(line);
    line.point[e[0]] += by[k], line.point[e[1]] += by[k + 1];
    tilt(line, e, by[k + 2], by[k + 3]);
    k += 4;
  }
  for (Vector3& ball : s.ball)
    for (double& x : ball) x += by[k++];
  for (std::size_t t = 1; t < s.tool.size(); ++t)
    for (double& x : s.tool[t]) x += by[k++];
  return s;
}

class Descent {
 public:
  Descent(const std::vector<ChainReading>& all, const ChainOrder& order, ChainState start)
      : all_(all), order_(order), state_(std::move(start)) {
    root_.resize(3 * at(all.size()));
    for (std::size_t i = 0; i < all.size(); ++i)
      root_.segment<3>(3 * at(i)).setConstant(std::sqrt(all[i].weight));
    scale_ = VectorXd::Ones(at(unknowns_of(order)));
    const double lever = extent_of(all);
    for (std::size_t l = 0; l < order.axes(); ++l)
      scale_.segment<2>(4 * at(l) + 2).setConstant(1.0 / lever);
  }

  bool ended_well() {
    VectorXd left = residual(state_);
    for (int round = 0; round < most_steps; ++round) {
      solve();
      VectorXd by = scale_.cwiseProduct(times(V_, transposed_times(U_, left).cwiseQuotient(size_)));
      double most = 0.0;
      for (std::size_t l = 0; l < order_.axes(); ++l)
        most = std::max(most, by.segment<2>(4 * at(l) + 2).cwiseAbs().maxCoeff());
      if (!std::isfinite(by.sum())) return false;
      if (most > largest_tilt) by *= largest_tilt / most;
      const double before = left.squaredNorm();
      const VectorXd whole = by;
      for (int half = 0;; ++half) {
        const ChainState next = moved(state_, by);
        const VectorXd there = residual(next);
        if (there.squaredNorm() <= before || half == 12) {
          if (there.squaredNorm() > before) by.setZero();
          if (!by.isZero(0.0)) state_ = next, left = there;
          break;
        }
        by *= 0.5;
      }
      if (by.cwiseAbs().maxCoeff() < ended || whole.cwiseAbs().maxCoeff() < ended) {
        solve();
        left_ = left;
        return true;
      }
    }
    return false;
  }

  const ChainState& state() const { return state_; }
  double sum() const { return left_.squaredNorm(); }
  bool identifies_direction(std::size_t axis) const {
    for (const Index k : {4 * at(axis) + 2, 4 * at(axis) + 3})
      if (std::fabs(V_.row(k).norm() - 1.0) > open_changes_nothing) return false;
    return true;
  }
  ChainFit fit() const;

 private:
  VectorXd residual(const ChainState& s) const {
    VectorXd out(root_.size());
    for (std::size_t i = 0; i < all_.size(); ++i)
      out.segment<3>(3 * at(i)) =
          as_vector(all_[i].at) - as_vector(chain_reading(s, order_, all_[i]));
    return root_.cwiseProduct(out);
  }

  MatrixXd jacobian() const {
    MatrixXd J(root_.size(), scale_.size());
    for (Index k = 0; k < scale_.size(); ++k) {
      VectorXd by = VectorXd::Zero(scale_.size());
      by[k] = derivative_step;
      const VectorXd up = residual(moved(state_, by));
      by[k] = -derivative_step;
      J.col(k) = scale_[k] / (2.0 * derivative_step) * (residual(moved(state_, by)) - up);
    }
    return J;
  }

  void solve() {
    const MatrixXd J = jacobian();
    const Eigen::HouseholderQR<MatrixXd> qr(J);
    const Index small = std::min(J.rows(), J.cols());
    const MatrixXd R = upper(qr, small);
    const Eigen::JacobiSVD<MatrixXd> svd(R, Eigen::ComputeFullV);
    all_sizes_ = VectorXd::Zero(J.cols());
    all_sizes_.head(small) = svd.singularValues();
    Index rank = 0;
    while (rank < small && all_sizes_[rank] > chain_rank * all_sizes_[0]) ++rank;
    V_ = left_columns(svd.matrixV(), rank);
    open_ = columns(svd.matrixV(), rank, J.cols() - rank);
    size_ = all_sizes_.head(rank);
    U_ = scaled_columns(product(J, V_), size_.cwiseInverse());
  }

  void put_followed(ChainFit& out) const;
  void put_open(ChainFit& out) const;

  const std::vector<ChainReading>& all_;
  const ChainOrder& order_;
  ChainState state_;
  VectorXd root_, scale_, left_, size_, all_sizes_;
  MatrixXd V_, U_, open_;
};

/// Reorders from index 3 i + k of a fit (reading i, coordinate k) to index k n + i of a budget.
std::vector<double> by_coordinate(const VectorXd& row) {
  const Index n = row.size() / 3;
  std::vector<double> out(static_cast<std::size_t>(row.size()));
  for (Index i = 0; i < n; ++i)
    for (Index k = 0; k < 3; ++k) out[static_cast<std::size_t>(k * n + i)] = row[3 * i + k];
  return out;
}

void Descent::put_followed(ChainFit& out) const {
  for (std::size_t j = 0; j < order_.axes(); ++j) {
    ChainFit::Followed f;
    double along = 0.0;
    for (std::size_t i = 0; i < all_.size(); ++i) {
      ChainReading r = all_[i];
      r.angle[j] += derivative_step;
      Eigen::Vector3d way = as_vector(chain_reading(state_, order_, r));
      r.angle[j] -= 2.0 * derivative_step;
      way -= as_vector(chain_reading(state_, order_, r));
      if (!(way.norm() > 0.0)) continue;
      way.normalize();
      along += std::pow(way.dot(left_.segment<3>(3 * at(i))), 2);
      f.dof_along += 1.0 - (way.transpose() * U_.middleRows<3>(3 * at(i))).squaredNorm();
    }
    f.dof_rest = out.dof - f.dof_along;
    if (f.dof_along > 0.0) f.along = std::sqrt(along / f.dof_along);
    if (f.dof_rest > 0.0) f.rest = std::sqrt(std::max(0.0, sum() - along) / f.dof_rest);
    out.followed.push_back(f);
  }
}

void Descent::put_open(ChainFit& out) const {
  for (Index k = 0; k < open_.cols(); ++k) {
    const VectorXd v = open_.col(k);
    out.null_space.emplace_back(v.data(), v.data() + v.size());
  }
  for (const OpenCombination& c : open_combinations(V_, chain_rank)) {
    out.open.emplace_back();
    for (const auto& [unknown, size] : c) out.open.back().push_back(unknown);
  }
}

ChainFit Descent::fit() const {
  ChainFit out;
  out.state = state_;
  out.unknowns = static_cast<std::size_t>(scale_.size());
  out.rank = static_cast<std::size_t>(size_.size());
  out.dof = static_cast<int>(root_.size() - size_.size());
  out.s = out.dof > 0 ? std::sqrt(sum() / out.dof) : 0.0;
  for (Index k = 0; k < all_sizes_.size(); ++k)
    out.singular.push_back(all_sizes_[k] / all_sizes_[0]);
  out.scale.assign(scale_.data(), scale_.data() + scale_.size());
  for (const ChainLine& line : state_.lines) out.across.push_back(across(line));
  const VectorXd own_left = left_.cwiseQuotient(root_);
  for (std::size_t i = 0; i < all_.size(); ++i)
    out.residual.push_back(as_array(own_left.segment<3>(3 * at(i))));
  const MatrixXd inverse = scaled_columns(
      product_transposed(scaled_columns(scaled_rows(scale_, V_), size_.cwiseInverse()), U_), root_);
  for (Index k = 0; k < inverse.rows(); ++k)
    out.by.push_back(by_coordinate(inverse.row(k).transpose()));
  if (all_.size() <= most_residual_rows) {
    const MatrixXd U = scaled_rows(root_.cwiseInverse(), U_);
    const MatrixXd W = scaled_rows(root_, U_);
    for (Index k = 0; k < 3; ++k)
      for (Index i = k; i < root_.size(); i += 3) {
        VectorXd row = -times(W, U.row(i).transpose());
        row[i] += 1.0;
        out.residual_by.push_back(by_coordinate(row));
      }
  }
  put_followed(out);
  put_open(out);
  return out;
}

bool other_chain(const Descent& best, const ChainState& other) {
  for (std::size_t l = 0; l < other.lines.size(); ++l)
    if (best.identifies_direction(l) &&
        angle_between(best.state().lines[l], other.lines[l]) > other_way)
      return true;
  return false;
}

/// The point of a line is the one nearest to the first ball (tables) or first tool tip (heads).
void settle(ChainState& s, const ChainOrder& order) {
  for (std::size_t l = 0; l < s.lines.size(); ++l)
    s.lines[l].point = nearest_on(s.lines[l], l < order.tables ? s.ball.front() : Vector3{});
}

}  // namespace

tl::expected<ChainFit, ChainRefusal> fit_chain(const std::vector<ChainReading>& all,
                                               const ChainOrder& order) {
  if (!sound(all, order)) return tl::unexpected(ChainRefusal::not_finite);
  if (all.size() < 2 || order.axes() == 0) return tl::unexpected(ChainRefusal::too_few);
  std::vector<Descent> ends;
  for (ChainState& start : chain_starts(all, order)) {
    settle(start, order);
    Descent one(all, order, std::move(start));
    if (one.ended_well()) ends.push_back(std::move(one));
  }
  if (ends.empty()) return tl::unexpected(ChainRefusal::not_converging);
  const auto best = std::min_element(
      ends.begin(), ends.end(), [](const auto& a, const auto& b) { return a.sum() < b.sum(); });
  const double none = std::pow(rounding_size, 2) * 3.0 * static_cast<double>(all.size());
  for (const Descent& other : ends)
    if (other.sum() <= fits_alike * best->sum() + none && other_chain(*best, other.state()))
      return tl::unexpected(ChainRefusal::ambiguous);
  ChainState state = best->state();
  settle(state, order);  // once more with the moved points, so that the derivatives refer to them
  Descent last(all, order, std::move(state));
  if (!last.ended_well()) return tl::unexpected(ChainRefusal::not_converging);
  ChainFit fit = last.fit();
  if (fit.dof < 1) return tl::unexpected(ChainRefusal::too_few);
  return fit;
}

ChainValue chain_value(const ChainFit& fit, const std::function<double(const ChainState&)>& of) {
  ChainValue out;
  out.value = of(fit.state);
  VectorXd gradient(at(fit.unknowns));
  for (Index k = 0; k < gradient.size(); ++k) {
    VectorXd by = VectorXd::Zero(gradient.size());
    by[k] = derivative_step;
    const double up = of(moved(fit.state, by));
    by[k] = -derivative_step;
    gradient[k] = (up - of(moved(fit.state, by))) / (2.0 * derivative_step);
  }
  double size = 0.0;
  for (Index k = 0; k < gradient.size(); ++k)
    size = std::hypot(size, gradient[k] * fit.scale[static_cast<std::size_t>(k)]);
  out.identifiable = std::isfinite(out.value) && std::isfinite(size);
  for (const auto& v : fit.null_space) {
    double part = 0.0;
    for (std::size_t k = 0; k < v.size(); ++k) part += v[k] * gradient[at(k)] * fit.scale[k];
    out.identifiable =
        out.identifiable && std::fabs(part) <= open_changes_nothing * std::max(size, rounding_size);
  }
  out.by.assign(fit.by.front().size(), 0.0);
  for (std::size_t k = 0; k < fit.by.size(); ++k)
    for (std::size_t i = 0; i < out.by.size(); ++i) out.by[i] += gradient[at(k)] * fit.by[k][i];
  return out;
}

Vector3 nearest_on(const ChainLine& line, const Vector3& to) {
  const Eigen::Vector3d c = as_vector(line.point), n = as_vector(line.direction);
  return as_array(c + n * n.dot(as_vector(to) - c));
}

double signed_distance(const ChainLine& a, const ChainLine& b) {
  const Eigen::Vector3d gap = as_vector(b.point) - as_vector(a.point), n = as_vector(a.direction);
  const Eigen::Vector3d cross = n.cross(as_vector(b.direction));
  constexpr double parallel = 1e-6;
  return cross.norm() > parallel ? gap.dot(cross.normalized()) : (gap - gap.dot(n) * n).norm();
}

double angle_between(const ChainLine& a, const ChainLine& b) {
  const Eigen::Vector3d n = as_vector(a.direction), m = as_vector(b.direction);
  return std::atan2(n.cross(m).norm(), n.dot(m));
}

}  // namespace nonio::math
