// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/blindness.h"

#include <algorithm>
#include <cmath>

#include "dense.h"

namespace nonio::math {

namespace {

// steps along a line; sufficient, because the shapes are polynomials of second degree
constexpr std::size_t steps_of_line = 12;
constexpr double unseen_below = 1e-9;

struct OneError {
  const char* name;
  std::size_t axis;  ///< axis that moves; for a squareness the second axis
  char kind;         ///< 'p' positioning, 's' straightness, 'a' angle, 'q' squareness
  /// Component of positioning and straightness; angles and squarenesses have levers instead.
  std::size_t component;
  struct Lever {
    std::size_t component, arm;
    double sign;
  };
  std::array<Lever, 2> levers{};
  std::size_t used = 0;
};

using Lever = OneError::Lever;
const std::array<OneError, 21> all_errors{{
    {"EXX", 0, 'p', 0, {}, 0},
    {"EYY", 1, 'p', 1, {}, 0},
    {"EZZ", 2, 'p', 2, {}, 0},
    {"C0Y", 1, 'q', 0, {Lever{0, 1, -1.0}}, 1},
    {"B0Z", 2, 'q', 0, {Lever{0, 2, 1.0}}, 1},
    {"A0Z", 2, 'q', 1, {Lever{1, 2, -1.0}}, 1},
    {"EYX", 0, 's', 1, {}, 0},
    {"EZX", 0, 's', 2, {}, 0},
    {"EXY", 1, 's', 0, {}, 0},
    {"EZY", 1, 's', 2, {}, 0},
    {"EXZ", 2, 's', 0, {}, 0},
    {"EYZ", 2, 's', 1, {}, 0},
    {"EAX", 0, 'a', 1, {Lever{1, 2, -1.0}, Lever{2, 1, 1.0}}, 2},
    {"EBX", 0, 'a', 0, {Lever{0, 2, 1.0}}, 1},
    {"ECX", 0, 'a', 0, {Lever{0, 1, -1.0}}, 1},
    {"EAY", 1, 'a', 1, {Lever{1, 2, -1.0}}, 1},
    {"EBY", 1, 'a', 0, {Lever{0, 2, 1.0}}, 1},
    {"ECY", 1, 'a', 0, {}, 0},
    {"EAZ", 2, 'a', 0, {}, 0},
    {"EBZ", 2, 'a', 0, {}, 0},
    {"ECZ", 2, 'a', 0, {}, 0},
}};

Corner error_shape(const OneError& e, const Corner& at, const Corner& low, const Corner& high) {
  Corner out{};
  const double length = high[e.axis] - low[e.axis];
  if (!(length > 0.0)) return out;
  const double t = (at[e.axis] - low[e.axis]) / length;
  if (e.kind == 'p') out[e.component] = t;
  if (e.kind == 's') out[e.component] = 4.0 * t * (1.0 - t);
  const double angle = e.kind == 'a' ? 2.0 * t - 1.0 : 1.0;
  for (std::size_t k = 0; k < e.used; ++k) {
    const Lever& l = e.levers[k];
    out[l.component] += l.sign * angle * (at[l.arm] - (low[l.arm] + high[l.arm]) / 2.0);
  }
  return out;
}

/// Returns the largest error in the volume for a coefficient of 1, m; 0 if the error has no effect.
double largest_in_volume(const OneError& e, const Corner& low, const Corner& high) {
  double most = 0.0;
  for (std::size_t corner = 0; corner < 27; ++corner) {
    Corner at{};
    for (std::size_t k = 0, rest = corner; k < 3; ++k, rest /= 3)
      at[k] = low[k] + (high[k] - low[k]) * static_cast<double>(rest % 3) / 2.0;
    for (const double v : error_shape(e, at, low, high)) most = std::max(most, std::fabs(v));
  }
  return most;
}

Corner unit_shape(const OneError& e, const Corner& at, const Corner& low, const Corner& high) {
  Corner out = error_shape(e, at, low, high);
  const double most = largest_in_volume(e, low, high);
  for (double& v : out) v = most > 0.0 ? v / most : 0.0;
  return out;
}

/// Reduced row echelon form, by columns from the left: a column without a pivot is a combination of
/// the pivot columns before it.
struct Echelon {
  std::vector<std::size_t> pivots;
  Eigen::MatrixXd reduced;

  explicit Echelon(Eigen::MatrixXd A) : reduced(std::move(A)) {
    Eigen::Index row = 0;
    for (Eigen::Index c = 0; c < reduced.cols() && row < reduced.rows(); ++c) {
      Eigen::Index best = 0;
      const double most = reduced.col(c).tail(reduced.rows() - row).cwiseAbs().maxCoeff(&best);
      if (most < unseen_below) continue;
      reduced.row(row).swap(reduced.row(row + best));
      reduced.row(row) /= reduced(row, c);
      for (Eigen::Index r = 0; r < reduced.rows(); ++r)
        if (r != row) reduced.row(r) -= reduced(r, c) * Eigen::RowVectorXd(reduced.row(row));
      pivots.push_back(static_cast<std::size_t>(c));
      ++row;
    }
  }
};

}  // namespace

Blindness blind_to(const std::vector<ThroughVolume>& lines) {
  Blindness out;
  if (lines.empty()) return out;
  Corner low = lines.front().from, high = low;
  for (const ThroughVolume& line : lines)
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min({low[k], line.from[k], line.to[k]});
      high[k] = std::max({high[k], line.from[k], line.to[k]});
    }
  std::vector<const OneError*> errors;
  for (const OneError& e : all_errors)
    if (high[e.axis] > low[e.axis]) errors.push_back(&e);
  out.errors = errors.size();

  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(lines.size() * steps_of_line),
                                            static_cast<Eigen::Index>(errors.size()));
  for (std::size_t l = 0; l < lines.size(); ++l) {
    const ThroughVolume& line = lines[l];
    Corner way{};
    double length = 0.0;
    for (std::size_t k = 0; k < 3; ++k) way[k] = line.to[k] - line.from[k];
    for (const double w : way) length += w * w;
    length = std::sqrt(length);
    for (std::size_t e = 0; e < errors.size(); ++e) {
      const Corner start = unit_shape(*errors[e], line.from, low, high);
      for (std::size_t i = 1; i <= steps_of_line; ++i) {
        const double t = static_cast<double>(i) / static_cast<double>(steps_of_line);
        Corner at{};
        for (std::size_t k = 0; k < 3; ++k) at[k] = line.from[k] + t * way[k];
        const Corner there = unit_shape(*errors[e], at, low, high);
        double reading = 0.0;
        for (std::size_t k = 0; k < 3; ++k) reading += way[k] / length * (there[k] - start[k]);
        A(static_cast<Eigen::Index>(l * steps_of_line + i - 1), static_cast<Eigen::Index>(e)) =
            reading;
      }
    }
  }
  for (std::size_t e = 0; e < errors.size(); ++e)
    if (A.col(static_cast<Eigen::Index>(e)).cwiseAbs().maxCoeff() < unseen_below)
      out.unseen.emplace_back(errors[e]->name);
  const Echelon echelon(std::move(A));
  out.rank = echelon.pivots.size();
  for (std::size_t c = 0; c < errors.size(); ++c) {
    const bool pivot =
        std::find(echelon.pivots.begin(), echelon.pivots.end(), c) != echelon.pivots.end();
    const bool alone =
        std::find(out.unseen.begin(), out.unseen.end(), errors[c]->name) != out.unseen.end();
    if (pivot || alone) continue;
    auto& terms = out.combinations.emplace_back();
    terms.emplace_back(errors[c]->name, 1.0);
    for (std::size_t r = 0; r < echelon.pivots.size(); ++r) {
      const double share =
          -echelon.reduced(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c));
      if (std::fabs(share) > 1e-6) terms.emplace_back(errors[echelon.pivots[r]]->name, share);
    }
  }
  return out;
}

}  // namespace nonio::math
