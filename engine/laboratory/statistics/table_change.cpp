// SPDX-License-Identifier: Apache-2.0
#include "laboratory/statistics/table_change.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "nonio/math/distributions.h"

namespace nonio::statistics {
namespace {

constexpr double least_p = 1e-3;  // smallest p of an unexplained part that is noise
// Largest RMS of an unexplained part that is noise, as a fraction of the change.
constexpr double most_noise = 0.4;
// Largest RMS of an unexplained part that is not noise, as a fraction of the RMS of the change h by
// the table (table_change.h).
constexpr double most_left = 0.1;
// Required difference of chi2 from a change without a table.
constexpr double clear = 25.0;
constexpr double distinct = 9.0;  // required difference of chi2 from any other candidate
// Smallest slope of h, in units of u_slope, if h is recognized by its size and not by its shape.
constexpr double slope_seen = 8.0;
constexpr int most_points = 5;            // largest offset of a table, in points
constexpr std::size_t fewest_places = 4;  // smallest number of positions

struct Between {
  double value = 0.0, variance = 0.0;
};

Between between(const std::vector<double>& position, const std::vector<double>& value, double x) {
  const auto above = std::lower_bound(position.begin(), position.end(), x);
  auto i = static_cast<std::size_t>(above - position.begin());
  const double near = 1e-6 * (position.back() - position.front());
  if (i < position.size() && position[i] - x <= near) return {value[i], 0.0};
  if (i > 0 && x - position[i - 1] <= near) return {value[i - 1], 0.0};
  i = std::clamp<std::size_t>(i, 1, position.size() - 1);
  const double part = (x - position[i - 1]) / (position[i] - position[i - 1]);
  double bend = 0.0;  // larger bend of the curve at the ends of the interval
  for (const std::size_t k : {i - 1, i})
    if (k > 0 && k + 1 < position.size()) {
      const double left = (value[k] - value[k - 1]) / (position[k] - position[k - 1]),
                   right = (value[k + 1] - value[k]) / (position[k + 1] - position[k]);
      bend = std::max(bend, std::fabs(right - left) / 2.0 * (position[i] - position[i - 1]));
    }
  const double wrong = bend * part * (1.0 - part);
  return {value[i - 1] + part * (value[i] - value[i - 1]), wrong * wrong};
}

/// Returns the standard uncertainty of a mean. Without a stated one (single run), it is estimated
/// from the scatter of the reversal along the axis, or from second differences of one direction;
/// both estimates are rather too large. 0 for fewer than three positions.
double u_of(const MeasuredCurve& c) {
  if (c.u > 0.0) return c.u;
  const auto& one = c.plus.empty() ? c.minus : c.plus;
  double sum = 0.0, squares = 0.0, n = 0.0;
  if (!c.plus.empty() && !c.minus.empty()) {
    for (std::size_t i = 0; i < c.position.size(); ++i) {
      const double B = c.plus[i] - c.minus[i];
      sum += B, squares += B * B, n += 1.0;
    }
    return n < 3.0 ? 0.0 : std::sqrt(std::max(0.0, (squares - sum * sum / n) / (n - 1.0)) / 2.0);
  }
  for (std::size_t i = 1; i + 1 < one.size(); ++i) {
    const double part =
        (c.position[i] - c.position[i - 1]) / (c.position[i + 1] - c.position[i - 1]);
    const double bend = one[i] - one[i - 1] - part * (one[i + 1] - one[i - 1]);
    squares += bend * bend / (1.0 + part * part + (1.0 - part) * (1.0 - part)), n += 1.0;
  }
  return n > 0.0 ? std::sqrt(squares / n) : 0.0;
}

struct CurveChange {
  std::vector<double> x, value, variance;
  std::vector<int> direction;
  double middle = 0.0, length = 0.0;
  /// Degrees of freedom of the noise; 0 if it is known from repeated runs.
  double dof_of_noise = 0.0;
};

CurveChange change_of(const MeasuredCurve& before, const MeasuredCurve& after, double resolution) {
  CurveChange d;
  const double near = 1e-6 * (before.position.back() - before.position.front());
  const double u_before = u_of(before), u_after = u_of(after);
  if (!(before.u > 0.0) || !(after.u > 0.0))
    d.dof_of_noise = static_cast<double>(after.position.size()) - 1.0;
  const double u2 = std::max(u_before * u_before + u_after * u_after, resolution * resolution);
  for (const int direction : {1, -1}) {
    const auto& was = direction > 0 ? before.plus : before.minus;
    const auto& is = direction > 0 ? after.plus : after.minus;
    if (was.empty() || is.empty()) continue;
    for (std::size_t i = 0; i < after.position.size(); ++i) {
      const double x = after.position[i];
      if (x < before.position.front() - near || x > before.position.back() + near) continue;
      const Between b = between(before.position, was, x);
      d.x.push_back(x), d.direction.push_back(direction);
      d.value.push_back(is[i] - b.value), d.variance.push_back(u2 + b.variance);
    }
  }
  if (d.x.empty()) return d;
  const auto [low, high] = std::minmax_element(d.x.begin(), d.x.end());
  d.middle = (*low + *high) / 2.0, d.length = *high - *low;
  return d;
}

using Three = std::array<double, 3>;

Three solved(std::array<Three, 3> a, Three b) {
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = k + 1; i < 3; ++i) {
      if (a[k][k] == 0.0) continue;
      const double f = a[i][k] / a[k][k];
      for (std::size_t j = k; j < 3; ++j) a[i][j] -= f * a[k][j];
      b[i] -= f * b[k];
    }
  Three x{};
  for (std::size_t k = 3; k-- > 0;) {
    double sum = b[k];
    for (std::size_t j = k + 1; j < 3; ++j) sum -= a[k][j] * x[j];
    x[k] = a[k][k] == 0.0 ? 0.0 : sum / a[k][k];
  }
  return x;
}

/// Fits two constants and a slope whose prior is 0 with standard uncertainty `u_slope`: 0 fixes the
/// slope at 0, infinity is no prior.
Three fitted(const CurveChange& d, const std::vector<double>& r, double u_slope) {
  std::array<Three, 3> a{};
  Three b{};
  for (std::size_t i = 0; i < r.size(); ++i) {
    const double w = 1.0 / d.variance[i], x = u_slope == 0.0 ? 0.0 : d.x[i] - d.middle;
    const Three row{d.direction[i] > 0 ? 1.0 : 0.0, d.direction[i] < 0 ? 1.0 : 0.0, x};
    for (std::size_t j = 0; j < 3; ++j) {
      b[j] += w * row[j] * r[i];
      for (std::size_t k = 0; k < 3; ++k) a[j][k] += w * row[j] * row[k];
    }
  }
  if (std::isfinite(u_slope) && u_slope > 0.0) a[2][2] += 1.0 / (u_slope * u_slope);
  return solved(a, b);
}

double after_fit(const CurveChange& d, const std::vector<double>& r, const Three& p,
                 std::size_t i) {
  return r[i] - (d.direction[i] > 0 ? p[0] : p[1]) - p[2] * (d.x[i] - d.middle);
}

double chi2_of(const CurveChange& d, const std::vector<double>& r, double u_slope) {
  const Three p = fitted(d, r, u_slope);
  double chi2 = std::isfinite(u_slope) && u_slope > 0.0 ? p[2] * p[2] / (u_slope * u_slope) : 0.0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    const double e = after_fit(d, r, p, i);
    chi2 += e * e / d.variance[i];
  }
  return chi2;
}

double rms_of(const CurveChange& d, const std::vector<double>& r, double u_slope) {
  const Three p = fitted(d, r, u_slope);
  double sum = 0.0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    const double e = after_fit(d, r, p, i);
    sum += e * e / static_cast<double>(r.size());
  }
  return std::sqrt(sum);
}

/// A hypothesis about the loaded table, with its change h at the compared positions.
struct Candidate {
  Loading loading;
  std::size_t table;
  int points;
  std::vector<double> h;
  double chi2 = 0.0;
  bool same_name(const Candidate& o) const {
    return loading == o.loading && points == o.points &&
           (table == o.table || loading == Loading::removed);
  }
};

class Recognizing {
 public:
  Recognizing(const CurveChange& d, const std::vector<TableCurve>& known, double u_slope)
      : d_(d), known_(known), u_slope_(u_slope) {}

  void with_base(const TableCurve& S) {
    const std::vector<double> s = values(S);
    if (!S.empty()) add(Loading::removed, 0, 0, s, -1.0, s, 0.0);
    for (std::size_t k = 0; k < known_.size(); ++k) {
      const std::vector<double> t = values(known_[k]);
      add(Loading::loaded, k, 0, t, 1.0, s, -1.0);
      add(Loading::wrong_sign, k, 0, t, -1.0, s, -1.0);
      add(Loading::twice, k, 0, t, 2.0, s, -1.0);
      if (!S.empty()) {
        add(Loading::wrong_sign, k, 0, t, -1.0, s, 1.0);
        add(Loading::twice, k, 0, t, 2.0, s, -2.0);
        add(Loading::in_addition, k, 0, t, 1.0, s, 0.0);
      }
      for (int n = -most_points; n <= most_points; ++n)
        if (n != 0 && std::abs(n) + 1 < static_cast<int>(known_[k].position.size()))
          add(Loading::offset, k, n, values(known_[k].shifted(n)), 1.0, s, -1.0);
    }
  }

  std::optional<TableChange> best() const {
    if (all_.empty()) return std::nullopt;
    const Candidate* best = &all_.front();
    for (const Candidate& c : all_)
      if (c.chi2 < best->chi2) best = &c;
    // An offset that the readings cannot distinguish from none is reported as loaded.
    for (const Candidate& c : all_)
      if (c.loading == Loading::loaded && best->loading == Loading::offset &&
          c.table == best->table && c.chi2 - best->chi2 < distinct)
        best = &c;
    const auto dof = static_cast<double>(d_.x.size() - constants());
    // The F distribution applies because the noise of single runs is an estimate.
    const double p = d_.dof_of_noise > 0.0 ? math::f_upper(best->chi2 / dof, dof, d_.dof_of_noise)
                                           : math::chi2_upper(best->chi2, dof);
    const double scale = std::max(1.0, best->chi2 / dof);
    std::vector<double> left = d_.value;
    for (std::size_t i = 0; i < left.size(); ++i) left[i] -= best->h[i];
    const double inf = HUGE_VAL;
    const auto beyond_noise = [&](double rms) {
      return std::sqrt(std::max(0.0, rms * rms - mean_variance()));
    };
    const bool small =
        beyond_noise(rms_of(d_, left, inf)) <= most_left * rms_of(d_, best->h, inf) &&
        beyond_noise(rms_of(d_, left, 0.0)) <= most_left * rms_of(d_, best->h, 0.0);
    const bool is_noise =
        p > least_p && rms_of(d_, left, 0.0) < most_noise * rms_of(d_, d_.value, 0.0);
    if (!is_noise && !small) return std::nullopt;
    // A change of scale can look like a table that is a line, so the slope of the table must be
    // much larger than usual changes of scale.
    const bool by_shape = chi2_of(d_, d_.value, inf) - best->chi2 > clear * scale;
    const bool by_size = is_noise && chi2_of(d_, d_.value, u_slope_) - best->chi2 > clear &&
                         std::fabs(fitted(d_, best->h, inf)[2]) > slope_seen * u_slope_;
    if (!by_shape && !by_size) return std::nullopt;
    for (const Candidate& c : all_)
      if (!c.same_name(*best) && !(c.chi2 - best->chi2 > distinct * scale) && !is_alike(c, *best))
        return std::nullopt;
    return TableChange{best->loading,         best->table,
                       best->points,          rms_of(d_, d_.value, 0.0),
                       rms_of(d_, left, 0.0), p};
  }

  std::optional<TableChange> nearest() const {
    std::optional<TableChange> out;
    for (const Candidate& c : all_) {
      if (c.loading != Loading::loaded) continue;
      std::vector<double> left = d_.value;
      for (std::size_t i = 0; i < left.size(); ++i) left[i] -= c.h[i];
      const double rms = rms_of(d_, left, 0.0);
      if (!out || rms < out->left)
        out = TableChange{c.loading, c.table, 0, rms_of(d_, d_.value, 0.0), rms, NAN};
    }
    return out;
  }

 private:
  std::vector<double> values(const TableCurve& t) const {
    std::vector<double> out;
    for (std::size_t i = 0; i < d_.x.size(); ++i) out.push_back(t.at(d_.x[i], d_.direction[i]));
    return out;
  }

  void add(Loading loading, std::size_t table, int points, const std::vector<double>& t,
           double of_t, const std::vector<double>& s, double of_s) {
    Candidate c{loading, table, points, {}, 0.0};
    std::vector<double> r = d_.value;
    for (std::size_t i = 0; i < r.size(); ++i) {
      c.h.push_back(of_t * t[i] + of_s * s[i]);
      r[i] -= c.h[i];
    }
    // A change of less than twice the noise is not identifiable.
    if (rms_of(d_, c.h, 0.0) < 2.0 * std::sqrt(mean_variance())) return;
    c.chi2 = chi2_of(d_, r, u_slope_);
    all_.push_back(std::move(c));
  }

  /// Whether `a` need not be distinguished from the best candidate `b`: offsets of one table that
  /// differ by a point, or any offset if `b` is the table itself.
  static bool is_alike(const Candidate& a, const Candidate& b) {
    const auto is_offset = [](const Candidate& c) {
      return c.loading == Loading::offset || c.loading == Loading::loaded;
    };
    return is_offset(a) && is_offset(b) && a.table == b.table &&
           (b.loading == Loading::loaded || std::abs(a.points - b.points) <= 1);
  }

  double mean_variance() const {
    double sum = 0.0;
    for (const double v : d_.variance) sum += v / static_cast<double>(d_.variance.size());
    return sum;
  }

  std::size_t constants() const {
    return static_cast<std::size_t>(std::count(d_.direction.begin(), d_.direction.end(), 1) > 0) +
           static_cast<std::size_t>(std::count(d_.direction.begin(), d_.direction.end(), -1) > 0);
  }

  const CurveChange& d_;
  const std::vector<TableCurve>& known_;
  double u_slope_ = 0.0;
  std::vector<Candidate> all_{};
};

}  // namespace

double TableCurve::at(double x, int direction) const {
  if (position.empty()) return 0.0;
  const auto& v = direction < 0 && !minus.empty() ? minus : plus;
  if (turn > 0.0) x -= turn * std::floor((x - position.front()) / turn);
  if (x <= position.front()) return v.front();
  if (x >= position.back()) return v.back();
  const auto i = static_cast<std::size_t>(std::upper_bound(position.begin(), position.end(), x) -
                                          position.begin());
  const double part = (x - position[i - 1]) / (position[i] - position[i - 1]);
  return v[i - 1] + part * (v[i] - v[i - 1]);
}

void TableCurve::repeat_after(double length) {
  const auto closed = [](const std::vector<double>& v) {
    return v.empty() || v.front() == v.back();
  };
  if (position.size() > 2 && closed(plus) && closed(minus) &&
      std::fabs(position.back() - position.front() - length) < 1e-9 * length)
    turn = length;
}

TableCurve TableCurve::shifted(int points) const {
  TableCurve out = *this;
  const auto n = static_cast<int>(position.size());
  for (int i = 0; i < n; ++i) {
    const int other =
        turn > 0.0 ? (i - points % (n - 1) + n - 1) % (n - 1) : std::clamp(i - points, 0, n - 1);
    const auto from = static_cast<std::size_t>(other);
    const auto to = static_cast<std::size_t>(i);
    out.plus[to] = plus[from];
    if (!minus.empty()) out.minus[to] = minus[from];
  }
  return out;
}

namespace {

/// Returns std::nullopt unless the change is known at enough positions, over more than half of the
/// range of `after`.
std::optional<CurveChange> comparable(const MeasuredCurve& before, const MeasuredCurve& after,
                                      double resolution) {
  if (before.position.size() < 2 || after.position.size() < 2) return std::nullopt;
  CurveChange d = change_of(before, after, resolution);
  if (std::set<double>(d.x.begin(), d.x.end()).size() < fewest_places) return std::nullopt;
  if (!(d.length > 0.5 * (after.position.back() - after.position.front()))) return std::nullopt;
  return d;
}

Recognizing with_bases(const CurveChange& d, const std::optional<TableCurve>& active,
                       const std::vector<TableCurve>& known, double u_slope) {
  Recognizing all(d, known, u_slope);
  if (active) {
    all.with_base(*active);
  } else {
    all.with_base({});
    for (const TableCurve& one : known) all.with_base(one);
  }
  return all;
}

}  // namespace

std::optional<TableChange> recognize(const MeasuredCurve& before, const MeasuredCurve& after,
                                     const std::optional<TableCurve>& active,
                                     const std::vector<TableCurve>& known, double u_slope,
                                     double resolution) {
  const auto d = comparable(before, after, resolution);
  return d ? with_bases(*d, active, known, u_slope).best() : std::nullopt;
}

std::optional<TableChange> nearest(const MeasuredCurve& before, const MeasuredCurve& after,
                                   const std::optional<TableCurve>& active,
                                   const std::vector<TableCurve>& known, double resolution) {
  const auto d = comparable(before, after, resolution);
  return d ? with_bases(*d, active, known, HUGE_VAL).nearest() : std::nullopt;
}

}  // namespace nonio::statistics
