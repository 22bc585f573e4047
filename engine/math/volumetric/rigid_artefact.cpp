// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/rigid_artefact.h"

#include <algorithm>
#include <cmath>

#include "dense.h"

namespace nonio::math {

namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

// a rotation that moves a ball by less, relative to the size of the artefact, is ignored
constexpr double no_lever = 1e-6;
// Largest width, relative to the length, of balls that are treated as being on one line, about
// which they determine no rotation.
constexpr double no_plane = 1e-3;
constexpr double least_u = 1e-9;  // m, m/m; smallest standard uncertainty used for stated values

Vector3d vector_of(const Corner& c) { return {c[0], c[1], c[2]}; }

/// A coordinate that was not measured is set to 0, because a tilt out of the plane of the other
/// coordinates changes them in second order only.
Vector3d place_of(const ArtefactPlacement& p, std::size_t i) {
  Vector3d at = vector_of(p.at[i]);
  for (std::size_t k = 0; k < 3; ++k)
    if (!p.measured[k]) at[static_cast<Index>(k)] = 0.0;
  return at;
}

/// The position and orientation of an artefact: a ball at q is at R (q - from) + to.
struct Stand {
  Matrix3d R = Matrix3d::Identity();
  Vector3d from = Vector3d::Zero(), to = Vector3d::Zero();
  bool turned_by_all = false;  ///< whether the balls are not on one line
  Vector3d place(const Vector3d& q) const { return R * (q - from) + to; }
  Vector3d back(const Vector3d& p) const { return R.transpose() * (p - to) + from; }
};

/// Returns the best fit of the pairs: rotation U diag(1, 1, det) V' of the matrix sum p q'.
Stand best_stand(const std::vector<Vector3d>& q, const std::vector<Vector3d>& p) {
  Stand s;
  const auto n = static_cast<double>(q.size());
  for (std::size_t i = 0; i < q.size(); ++i) s.from += q[i] / n, s.to += p[i] / n;
  MatrixXd sum = MatrixXd::Zero(3, 3);
  for (std::size_t i = 0; i < q.size(); ++i) sum += (p[i] - s.to) * (q[i] - s.from).transpose();
  const Eigen::JacobiSVD<MatrixXd> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix3d U = svd.matrixU(), V = svd.matrixV();
  Vector3d sign(1.0, 1.0, (U * V.transpose()).determinant() < 0.0 ? -1.0 : 1.0);
  s.R = U * sign.asDiagonal() * V.transpose();
  s.turned_by_all =
      svd.singularValues()[1] > no_plane * no_plane * svd.singularValues()[0] && q.size() > 2;
  return s;
}

class Frame {
 public:
  explicit Frame(const Artefact& a) : a_(a), q_(a.balls.size()), is_placed_(a.placements.size()) {}

  tl::expected<void, ArtefactRefusal> find() {
    const bool stated = std::any_of(a_.balls.begin(), a_.balls.end(),
                                    [](const ArtefactBall& b) { return b.stated.has_value(); });
    for (std::size_t b = 0; b < q_.size(); ++b)
      if (a_.balls[b].stated) q_[b] = vector_of(*a_.balls[b].stated);
    if (!stated && !a_.placements.empty()) {
      const ArtefactPlacement& first = a_.placements.front();
      for (std::size_t i = 0; i < first.ball.size(); ++i) q_[first.ball[i]] = place_of(first, i);
    }
    for (bool more = true; more;) {
      more = false;
      for (std::size_t p = 0; p < is_placed_.size(); ++p) more |= !is_placed_[p] && link(p);
    }
    for (std::size_t p = 0; p < is_placed_.size(); ++p)
      if (!is_placed_[p])
        return tl::unexpected(
            ArtefactRefusal{ArtefactRefusal::Why::not_linked, a_.placements[p].name, {}, 0.0});
    return check();
  }

  const Vector3d& ball(std::size_t b) const { return *q_[b]; }
  bool known(std::size_t b) const { return q_[b].has_value(); }
  const Stand& stand(std::size_t p) const { return *is_placed_[p]; }

 private:
  /// Fits a placement by its known balls, and derives its other balls. Returns false if no ball is
  /// known, or if the known balls are on one line and others are not known.
  bool link(std::size_t p) {
    const ArtefactPlacement& placement = a_.placements[p];
    std::vector<Vector3d> q, at;
    for (std::size_t i = 0; i < placement.ball.size(); ++i)
      if (q_[placement.ball[i]])
        q.push_back(*q_[placement.ball[i]]), at.push_back(place_of(placement, i));
    if (q.empty()) return false;
    const Stand stand = best_stand(q, at);
    const bool all = q.size() == placement.ball.size();
    if (!all && !stand.turned_by_all) return false;
    for (std::size_t i = 0; i < placement.ball.size(); ++i)
      if (auto& ball = q_[placement.ball[i]]; !ball) ball = stand.back(place_of(placement, i));
    is_placed_[p] = stand;
    return true;
  }

  tl::expected<void, ArtefactRefusal> check() const {
    ArtefactRefusal worst{ArtefactRefusal::Why::does_not_fit, {}, {}, 0.0};
    const auto see = [&](double d, const std::string& placement, const std::string& ball) {
      if (d > worst.distance || !std::isfinite(d)) worst = {worst.why, placement, ball, d};
    };
    for (std::size_t p = 0; p < is_placed_.size(); ++p)
      for (std::size_t i = 0; i < a_.placements[p].ball.size(); ++i) {
        const std::size_t b = a_.placements[p].ball[i];
        Vector3d apart = is_placed_[p]->place(*q_[b]) - place_of(a_.placements[p], i);
        for (std::size_t k = 0; k < 3; ++k)
          if (!a_.placements[p].measured[k]) apart[at(k)] = 0.0;
        see(apart.norm(), a_.placements[p].name, a_.balls[b].name);
      }
    for (const ArtefactLength& l : a_.lengths)
      if (q_[l.a] && q_[l.b])
        see(std::fabs((*q_[l.a] - *q_[l.b]).norm() - l.length), a_.placements.front().name,
            a_.balls[l.a].name + " - " + a_.balls[l.b].name);
    if (worst.distance <= artefact_limit) return {};
    return tl::unexpected(worst);
  }

  const Artefact& a_;
  std::vector<std::optional<Vector3d>> q_;
  std::vector<std::optional<Stand>> is_placed_;
};

void put_placement(const Artefact& a, const Frame& frame, std::size_t p, std::size_t first,
                   std::size_t group, ArtefactLines& out) {
  const ArtefactPlacement& placement = a.placements[p];
  const Stand& stand = frame.stand(p);
  const std::size_t stand_at = first + 6 * p, balls_at = first + 6 * a.placements.size(),
                    n = placement.ball.size();
  double size = 0.0;
  for (std::size_t i = 0; i < n; ++i)
    size = std::max(size, (stand.place(frame.ball(placement.ball[i])) - stand.to).norm());
  for (std::size_t k = 0; k < 3; ++k) {
    if (!placement.measured[k]) continue;
    RigidLine line;
    line.kind = RigidLine::Kind::point;
    line.group = group;
    Corner sense{};
    sense[k] = 1.0;
    line.shared.push_back({stand_at + k, std::vector<double>(n, 1.0)});
    for (std::size_t j = 0; j < 3; ++j)
      line.shared.push_back({stand_at + 3 + j, std::vector<double>(n, 0.0)});
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t b = placement.ball[i];
      const Vector3d place = stand.place(frame.ball(b)), lever = place - stand.to;
      // Evaluate the errors at the ball positions of the fitted placement: at the measured
      // positions, their scatter would seem to determine the scale, which only a certificate does.
      Corner where = placement.at[i];
      for (std::size_t c = 0; c < 3; ++c)
        if (placement.measured[c]) where[c] = place[at(c)];
      line.readings.push_back({where, sense, 1, place[at(k)] - placement.at[i][k]});
      for (std::size_t j = 0; j < 3; ++j) {
        const double turned = Vector3d::Unit(at(j)).cross(lever)[at(k)];
        if (std::fabs(turned) > no_lever * size) line.shared[1 + j].of_reading[i] = turned;
        std::vector<double> moved(n, 0.0);
        moved[i] = -stand.R(at(k), at(j));
        line.shared.push_back({balls_at + 3 * b + j, std::move(moved)});
      }
    }
    out.lines.push_back(std::move(line));
    out.of.push_back({p, k});
  }
}

/// The scale of the stated values is the last unknown.
class Stated {
 public:
  void add(double value, double u, const std::vector<std::pair<std::size_t, double>>& shares) {
    for (auto& shared : line_.shared) shared.of_reading.push_back(0.0);
    line_.readings.push_back({{}, {}, 0, value, std::max(least_u, u)});
    for (const auto& [unknown, share] : shares) of(unknown).of_reading.back() = share;
  }
  RigidLine take() {
    line_.kind = RigidLine::Kind::stated;
    return std::move(line_);
  }
  bool any() const { return !line_.readings.empty(); }

 private:
  RigidLine::Shared& of(std::size_t unknown) {
    const auto found = std::find_if(line_.shared.begin(), line_.shared.end(),
                                    [&](const auto& s) { return s.unknown == unknown; });
    if (found != line_.shared.end()) return *found;
    line_.shared.push_back({unknown, std::vector<double>(line_.readings.size(), 0.0)});
    return line_.shared.back();
  }
  RigidLine line_;
};

void put_stated(const Artefact& a, const Frame& frame, std::size_t balls_at, ArtefactLines& out) {
  const std::size_t scale = balls_at + 3 * a.balls.size();
  Stated stated;
  for (std::size_t b = 0; b < a.balls.size(); ++b)
    for (std::size_t j = 0; j < 3 && a.balls[b].stated; ++j)
      stated.add(0.0, a.balls[b].u,
                 {{balls_at + 3 * b + j, 1.0}, {scale, -(*a.balls[b].stated)[j]}});
  for (const ArtefactLength& l : a.lengths) {
    if (!frame.known(l.a) || !frame.known(l.b)) continue;
    const Vector3d way = frame.ball(l.a) - frame.ball(l.b), n = way.normalized();
    std::vector<std::pair<std::size_t, double>> shares{{scale, -l.length}};
    for (std::size_t j = 0; j < 3; ++j) {
      shares.emplace_back(balls_at + 3 * l.a + j, n[at(j)]);
      shares.emplace_back(balls_at + 3 * l.b + j, -n[at(j)]);
    }
    stated.add(l.length - way.norm(), l.u, shares);
  }
  if (!stated.any()) return;
  stated.add(0.0, a.u_scale, {{scale, 1.0}});
  out.lines.push_back(stated.take());
  out.states = true;
}

}  // namespace

tl::expected<ArtefactLines, ArtefactRefusal> artefact_lines(const Artefact& a, std::size_t first,
                                                            std::size_t group) {
  Frame frame(a);
  if (auto found = frame.find(); !found) return tl::unexpected(found.error());
  ArtefactLines out;
  out.unknowns = 6 * a.placements.size() + 3 * a.balls.size() + 1;
  for (std::size_t p = 0; p < a.placements.size(); ++p)
    put_placement(a, frame, p, first, group, out);
  put_stated(a, frame, first + 6 * a.placements.size(), out);
  return out;
}

}  // namespace nonio::math
