// SPDX-License-Identifier: Apache-2.0
//
// Finds passes and directions with the other sign or in reverse order.
// A pass must agree with the others of its direction only after it is turned. All passes are
// compared first without their lines (drift changes lines), then without their means only (a pitch
// error is mostly a line).
// For a direction, u is half of the reversal and v the mean of both directions, both without the
// shapes that elastic wind-up of a drive gives the reversal. A correct v contains the pitch error.
// A wrong sign exchanges u and v; reverse order exchanges their odd parts. u must exceed the
// scatter and three times v (the odd part 2.2 times that of v), whichever of the shapes is
// subtracted. If the directions are opposed only with these shapes, wind-up may be the cause, and
// the finding is information.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "campaign/reading/plausibility/plausibility.h"
#include "campaign/reading/plausibility/plausibility_strokes.h"
#include "nonio/math/distributions.h"

namespace nonio::reading {
namespace {

/// Means over the passes at each target, and the scatter of readings about them.
class Curve {
 public:
  void add(const Stroke& s, double weight = 1.0) {
    for (std::size_t i = 0; i < s.target.size(); ++i) {
      Cell& cell = cells_[s.target[i]];
      cell.count += weight;
      cell.sum += weight * s.deviation[i];
      cell.squares += weight * s.deviation[i] * s.deviation[i];
    }
  }
  void sum_up() { all_ = sums(); }

  /// Means without this pass. Depth and scatter still include all targets.
  Curve without(const Stroke& s) const {
    Curve own;
    for (const double target : s.target) own.cells_[target] = cells_.at(target);
    Sums elsewhere;
    if (own.cells_.size() < cells_.size()) {
      const Sums here = own.sums();
      elsewhere = {all_.cells - here.cells, all_.count - here.count,
                   std::max(0.0, all_.squares - here.squares), all_.freedom - here.freedom};
    }
    own.add(s, -1.0);
    std::erase_if(own.cells_, [](const auto& one) { return one.second.count < 0.5; });
    own.elsewhere_ = elsewhere;
    return own;
  }
  template <class Visit>
  void each(const Visit& visit) const {
    for (const auto& [target, cell] : cells_) visit(target, cell.sum / cell.count);
  }
  std::optional<double> mean(double target) const {
    const auto at = cells_.find(target);
    if (at == cells_.end()) return std::nullopt;
    return at->second.sum / at->second.count;
  }
  double depth() const {
    const Sums all = sums();
    return all.cells == 0.0 ? 1.0 : all.count / all.cells;
  }
  /// Returns the sum of squares about the means, and the degrees of freedom.
  std::pair<double, double> scatter() const {
    const Sums all = sums();
    return {all.squares, all.freedom};
  }

 private:
  struct Sums {
    double cells = 0.0, count = 0.0, squares = 0.0, freedom = 0.0;
  };
  struct Cell {
    double count = 0.0, sum = 0.0, squares = 0.0;
  };

  Sums sums() const {
    Sums out = elsewhere_;
    out.cells += static_cast<double>(cells_.size());
    for (const auto& [target, cell] : cells_) {
      out.count += cell.count;
      if (cell.count < 1.5) continue;
      out.squares += std::max(0.0, cell.squares - cell.sum * cell.sum / cell.count);
      out.freedom += cell.count - 1.0;
    }
    return out;
  }

  std::map<double, Cell> cells_;
  Sums elsewhere_;
  Sums all_;
};

enum class Turned { not_at_all, order, sign };

/// Sums of squares of the difference of two curves: unchanged, in reverse order, with the other
/// sign.
struct Likeness {
  double same = 0.0, order = 0.0, sign = 0.0;
};

Likeness likeness(const std::vector<double>& a, const std::vector<double>& b,
                  const std::vector<double>& from_the_end) {
  Likeness out;
  for (std::size_t i = 0; i < a.size(); ++i) {
    out.same += (a[i] - b[i]) * (a[i] - b[i]);
    out.order += (from_the_end[i] - b[i]) * (from_the_end[i] - b[i]);
    out.sign += (a[i] + b[i]) * (a[i] + b[i]);
  }
  return out;
}

struct Scatter {
  double squares = 0.0, freedom = 0.0;
  void take(const std::pair<double, double>& one) { squares += one.first, freedom += one.second; }
};

void take_mean_out(std::vector<double>& values) {
  double mean = 0.0;
  for (const double v : values) mean += v / static_cast<double>(values.size());
  for (double& v : values) v -= mean;
}

struct Pair {
  std::vector<double> at, a, b;
};

Pair in_common(const Curve& one, const Curve& other) {
  Pair p;
  one.each([&](double target, double mean) {
    const auto there = other.mean(target);
    if (!there) return;
    p.at.push_back(target);
    p.a.push_back(mean);
    p.b.push_back(*there);
  });
  return p;
}

/// `with_line`: subtract lines, not only means. `noise`: variance of the difference at a target.
Turned turned_as(Pair p, double noise, bool with_line) {
  std::vector<double> from_the_end(p.a.rbegin(), p.a.rend());
  const auto bare = [&](std::vector<double>& v) {
    with_line ? take_line_out(p.at, v) : take_mean_out(v);
  };
  bare(p.a), bare(p.b), bare(from_the_end);
  const Likeness whole = likeness(p.a, p.b, from_the_end);
  // Stick-slip at the first reading of each pass affects both ends, so the comparison is repeated
  // without the ends.
  const auto n = static_cast<double>(p.at.size());
  const auto inner = [](std::vector<double>& v) { v.erase(v.begin()), v.pop_back(); };
  inner(p.at), inner(p.a), inner(p.b), inner(from_the_end);
  bare(p.a), bare(p.b), bare(from_the_end);
  const Likeness within = likeness(p.a, p.b, from_the_end);
  const auto fits = [&](double sum_of_squares, double sum_within) {
    return whole.same > 12.0 * sum_of_squares && sum_of_squares < 6.0 * noise * n &&
           whole.same > 20.0 * noise * n && within.same > 3.0 * sum_within;
  };
  const bool order = fits(whole.order, within.order), sign = fits(whole.sign, within.sign);
  if (order && !(sign && whole.sign < whole.order)) return Turned::order;
  return sign ? Turned::sign : Turned::not_at_all;
}

constexpr std::size_t fewest_compared = 7;

/// `scatter`: about the mean of target and direction. `without_line_only`: curves are compared only
/// without their lines.
Turned turned(const Curve& one, const Curve& other, const Scatter& scatter, double step,
              bool without_line_only) {
  const Pair pair = in_common(one, other);
  if (pair.at.size() < fewest_compared || scatter.freedom <= 0.0) return Turned::not_at_all;
  const double s = std::max(std::sqrt(scatter.squares / scatter.freedom), step);
  const double noise = s * s * (1.0 / one.depth() + 1.0 / other.depth());
  const Turned how = turned_as(pair, noise, true);
  return how != Turned::not_at_all || without_line_only ? how : turned_as(pair, noise, false);
}

void push_turned(Turned how, const std::string& which, std::vector<Finding>& out) {
  out.push_back({.id = how == Turned::order ? "plausibility.pass-order-turned"
                                            : "plausibility.pass-sign-turned",
                 .attention = true,
                 .texts = {{"which", which}}});
}

std::vector<double> without(std::vector<double> values, std::vector<std::vector<double>> shapes) {
  const auto product = [](const std::vector<double>& x, const std::vector<double>& y) {
    double sum = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) sum += x[i] * y[i];
    return sum;
  };
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    const double whole = product(shapes[k], shapes[k]);
    for (std::size_t j = 0; j < k; ++j) {
      const double of = product(shapes[j], shapes[j]);
      const double share = of > 0.0 ? product(shapes[k], shapes[j]) / of : 0.0;
      for (std::size_t i = 0; i < values.size(); ++i) shapes[k][i] -= share * shapes[j][i];
    }
    const double own = product(shapes[k], shapes[k]);
    if (!(own > 1e-9 * whole)) {
      shapes[k].assign(values.size(), 0.0);
      continue;
    }
    const double share = product(values, shapes[k]) / own;
    for (std::size_t i = 0; i < values.size(); ++i) values[i] -= share * shapes[k][i];
  }
  return values;
}

using Shapes = std::vector<std::vector<double>>;

/// Shapes of elastic wind-up: a line (screw held at one end), a parabola (held at both ends), or a
/// wave (load that turns with the table or returns once along the travel).
std::vector<Shapes> elastic_shapes(const std::vector<double>& at, bool rotary) {
  const double length = at.back() - at.front();
  Shapes powers(3), wave(3);
  for (const double x : at) {
    const double share = (x - at.front()) / length;
    const double angle = rotary ? x : 2.0 * std::numbers::pi * share;
    powers[0].push_back(1.0), powers[1].push_back(share), powers[2].push_back(share * share);
    wave[0].push_back(1.0), wave[1].push_back(std::sin(angle)), wave[2].push_back(std::cos(angle));
  }
  if (rotary) return {wave};
  return {powers, wave};
}

/// Odd part about the middle of the targets, one value per pair of targets, with the variance of
/// `values`.
std::vector<double> odd(const std::vector<double>& values) {
  std::vector<double> out;
  for (std::size_t i = 0; i < values.size() / 2; ++i)
    out.push_back((values[i] - values[values.size() - 1 - i]) / std::numbers::sqrt2);
  return out;
}

double square_sum(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return sum;
}

/// Whether direction - agrees with direction + after it is turned. Local lost motion on an axis with
/// a good pitch causes the same.
bool is_direction_turned(const Curve& minus, const Curve& plus, const Scatter& scatter, double step,
                         bool rotary) {
  constexpr double least_travel = 1e-3;  // smallest range of targets, m
  constexpr double ratio = 9.0, ratio_of_odd = 5.0, chance = 1e-5;
  const Pair p = in_common(minus, plus);
  const std::size_t n = p.at.size();
  if (n < fewest_compared || scatter.freedom <= 0.0) return false;
  // Targets within a small travel show the reversal, not the pitch error.
  if (!rotary && !(p.at.back() - p.at.front() > least_travel)) return false;
  const double s = std::max(std::sqrt(scatter.squares / scatter.freedom), step);
  const double variance = s * s * (1.0 / minus.depth() + 1.0 / plus.depth()) / 4.0;
  std::vector<double> u, v;
  for (std::size_t i = 0; i < n; ++i)
    u.push_back((p.b[i] - p.a[i]) / 2.0), v.push_back((p.b[i] + p.a[i]) / 2.0);
  bool sign = true, order = true;
  for (const Shapes& shapes : elastic_shapes(p.at, rotary)) {
    const auto left_u = without(u, shapes), left_v = without(v, shapes);
    const auto in_u = [&](const std::vector<double>& of_u, const std::vector<double>& of_v,
                          double least, double freedom) {
      const double squares = square_sum(of_u);
      return squares > least * square_sum(of_v) &&
             math::f_upper(squares / freedom / variance, freedom, scatter.freedom) < chance;
    };
    sign = sign && in_u(left_u, left_v, ratio, static_cast<double>(n - shapes.size()));
    const auto odd_u = odd(left_u), odd_v = odd(left_v);
    order = order && in_u(odd_u, odd_v, ratio_of_odd, static_cast<double>(odd_u.size() - 1));
  }
  return order || sign;
}

/// Returns the other pass in the direction of `own`; requires exactly two passes per direction.
Curve the_other(const Stroke& own, const std::vector<Stroke>& strokes) {
  Curve other;
  for (const Stroke& s : strokes)
    if (&s != &own && s.direction == own.direction) other.add(s);
  return other;
}

/// Whether `own` differs more from the opposite direction than `other`, a pass of the same
/// direction.
bool the_farther(const Curve& own, const Curve& other, const Curve& opposite) {
  const auto apart = [&](const Curve& one) {
    Pair p = in_common(one, opposite);
    double sum = 0.0;
    take_mean_out(p.a), take_mean_out(p.b);
    for (std::size_t i = 0; i < p.a.size(); ++i) sum += (p.a[i] - p.b[i]) * (p.a[i] - p.b[i]);
    return sum;
  };
  return apart(own) >= apart(other);
}

/// Whether the curves are opposed including slopes. Curves with equal slopes were not turned.
bool opposed(const Pair& p, Turned how, double noise) {
  const auto n = static_cast<double>(p.a.size());
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < p.a.size(); ++i) {
    const double left = (how == Turned::order ? p.a[p.a.size() - 1 - i] : -p.a[i]) - p.b[i];
    sum += left, squares += left * left;
  }
  return squares - sum * sum / n <= 6.0 * noise * n;
}

}  // namespace

void turned_passes(const Passes& passes, bool rotary, std::vector<Finding>& out) {
  const auto& [strokes, step] = passes;
  std::map<int, Curve> by_direction;
  std::map<int, std::size_t> count;
  for (const Stroke& s : strokes) by_direction[s.direction].add(s), ++count[s.direction];
  for (auto& one : by_direction) one.second.sum_up();
  for (const Stroke& own : strokes) {
    Curve one;
    one.add(own);
    const Curve others = by_direction[own.direction].without(own);
    Scatter scatter;
    scatter.take(others.scatter());
    // The scatter of the other direction, in which the same run may be wrong too, is added only if
    // these passes are too few.
    if (scatter.freedom < static_cast<double>(fewest_compared))
      for (const auto& [direction, curve] : by_direction)
        if (direction != own.direction) scatter.take(curve.scatter());
    const Turned how = turned(one, others, scatter, step, false);
    if (how == Turned::not_at_all) continue;
    if (count[own.direction] == 2 && count.size() == 2 &&
        !the_farther(one, the_other(own, strokes), by_direction[-own.direction]))
      continue;
    return push_turned(how, name_of(own), out);
  }
  if (count.size() != 2) return;
  const Curve &minus = by_direction[-1], &plus = by_direction[1];
  Scatter scatter;
  scatter.take(minus.scatter());
  scatter.take(plus.scatter());
  if (is_direction_turned(minus, plus, scatter, step, rotary))
    return out.push_back({.id = "plausibility.direction-turned", .attention = true});
  const Turned how = turned(minus, plus, scatter, step, true);
  if (how == Turned::not_at_all) return;
  const double s = std::max(std::sqrt(scatter.squares / scatter.freedom), step);
  if (opposed(in_common(minus, plus), how, s * s * (1.0 / minus.depth() + 1.0 / plus.depth())))
    out.push_back({.id = "plausibility.directions-opposed"});
}

}  // namespace nonio::reading
