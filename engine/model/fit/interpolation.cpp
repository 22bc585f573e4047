// SPDX-License-Identifier: Apache-2.0
#include "interpolation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "nonio/sdk/axis_readings.h"

namespace nonio::model {

namespace {

// With more gaps, several share a column, with alternating signs.
constexpr std::size_t most_columns = 50;

/// Rows of one line, ordered by time, with and without a temperature.
struct TemperatureCourse {
  std::vector<std::uint32_t> known, blank;
};

/// Consecutive blank rows, and their temperature errors, K, for one standard uncertainty.
struct Gap {
  std::vector<std::uint32_t> row;
  std::vector<double> off;
};

std::vector<TemperatureCourse> temperature_courses(const Observations& o, const AxisReadings& r) {
  std::vector<TemperatureCourse> out(lines_of(o));
  std::vector<char> is_blank(o.size(), 0);
  for (const std::uint32_t i : r.interpolated) is_blank[i] = 1;
  for (std::uint32_t i = 0; i < o.size(); ++i)
    if (r.moved[i])
      (is_blank[i] ? out[line_of(o, i)].blank : out[line_of(o, i)].known).push_back(i);
  const auto earlier = [&](std::uint32_t a, std::uint32_t b) { return r.t[a] < r.t[b]; };
  for (TemperatureCourse& c : out) {
    std::stable_sort(c.known.begin(), c.known.end(), earlier);
    std::stable_sort(c.blank.begin(), c.blank.end(), earlier);
  }
  return out;
}

/// Distance of known temperatures from a straight line between two others (`inside`), or from a
/// constant (`beyond`), that are at least `span` apart.
class Wrong {
 public:
  Wrong(const TemperatureCourse& course, const AxisReadings& r) : known_(course.known), r_(r) {}

  /// Returns the error in the middle of a gap, K; NaN if it is unknown.
  double inside(double span) const {
    double sum = 0.0, count = 0.0;
    for_stretches(span, 2, [&](std::size_t a, std::size_t b, double scale) {
      for (std::size_t k = a + 1; k < b; ++k) {
        const double x = share(a, b, k), bulge = 4.0 * x * (1.0 - x);
        if (bulge < 0.5) continue;
        const double off = K(k) - K(a) - (K(b) - K(a)) * x;
        sum += off * off * scale * scale / (bulge * bulge), ++count;
      }
    });
    return count < fewest ? nan : std::sqrt(sum / count);
  }

  /// At a time `span`, s, after the last known temperature, or before the first; K; NaN if unknown.
  double beyond(double span) const {
    double sum = 0.0, count = 0.0;
    for_stretches(span, 1, [&](std::size_t a, std::size_t b, double scale) {
      sum += (K(b) - K(a)) * (K(b) - K(a)) * scale * scale, ++count;
    });
    return count < fewest ? nan : std::sqrt(sum / count);
  }

 private:
  static constexpr double fewest = 3.0;
  static constexpr double nan = std::numeric_limits<double>::quiet_NaN();

  double K(std::size_t k) const { return r_.K[known_[k]]; }
  double t(std::size_t k) const { return r_.t[known_[k]]; }
  double share(std::size_t a, std::size_t b, std::size_t k) const {
    return (t(k) - t(a)) / (t(b) - t(a));
  }

  /// The second index is the first one that is at least `span` and `fewest_on` temperatures later.
  /// The error of a longer stretch is scaled down in proportion, which assumes no jumps.
  template <typename Use>
  void for_stretches(double span, std::size_t fewest_on, const Use& use) const {
    std::size_t b = 0;
    for (std::size_t a = 0; a < known_.size(); ++a) {
      while (b < known_.size() && (b < a + fewest_on || t(b) - t(a) < span)) ++b;
      if (b == known_.size()) return;
      if (t(b) > t(a)) use(a, b, std::min(span / (t(b) - t(a)), 1.0));
    }
  }

  const std::vector<std::uint32_t>& known_;
  const AxisReadings& r_;
};

/// Returns false if too few temperatures are known to estimate the interpolation error.
bool add_gaps(const TemperatureCourse& course, const AxisReadings& r, std::vector<Gap>& gaps) {
  const Wrong wrong(course, r);
  const auto& known = course.known;
  std::size_t at = known.size() + 1;  // index of the first known temperature after the last gap
  for (const std::uint32_t i : course.blank) {
    const auto after = std::upper_bound(known.begin(), known.end(), r.t[i],
                                        [&](double t, std::uint32_t k) { return t < r.t[k]; });
    const auto behind = static_cast<std::size_t>(after - known.begin());
    if (behind != at) gaps.emplace_back();
    at = behind;
    Gap& gap = gaps.back();
    double off = 0.0;
    if (behind == 0 || behind == known.size()) {
      const double span = std::fabs(r.t[i] - r.t[behind == 0 ? known.front() : known.back()]);
      off = span > 0.0 ? wrong.beyond(span) : 0.0;
    } else {
      const double from = r.t[known[behind - 1]], to = r.t[known[behind]];
      const double x = (r.t[i] - from) / (to - from);
      off = 4.0 * x * (1.0 - x) * wrong.inside(to - from);
    }
    if (!std::isfinite(off)) return false;
    gap.row.push_back(i);
    gap.off.push_back(off);
  }
  return true;
}

/// Terms with their linear parameters, and their joint prediction for each reading.
struct Said {
  std::vector<Term> terms;
  std::vector<VectorXd> linear;

  Expected<VectorXd> of(const Observations& o) const {
    VectorXd sum = VectorXd::Zero(static_cast<Index>(o.size()));
    for (std::size_t t = 0; t < terms.size(); ++t) {
      NONIO_TRY(const auto columns, columns_of(o, terms[t], terms[t].shape));
      if (columns.cols() == linear[t].size()) sum += columns * linear[t];
    }
    return sum;
  }
};

/// Returns the terms of this axis whose prediction depends on the interpolated material
/// temperatures.
Expected<Said> warmed(const Observations& filled, const AxisReadings& r,
                      const std::vector<Term>& terms, const std::vector<VectorXd>& linear,
                      const std::string& axis) {
  Observations warmer = filled;
  for (const std::uint32_t i : r.interpolated) warmer.material[i] += 1.0;
  Said out;
  for (std::size_t t = 0; t < terms.size(); ++t) {
    if (terms[t].axis.name != axis) continue;
    const Said one{{terms[t]}, {linear[t]}};
    const auto before = one.of(filled), after = one.of(warmer);
    if (!before) return fail(before.error());
    if (!after) return fail(after.error());
    if (*before == *after) continue;
    out.terms.push_back(terms[t]);
    out.linear.push_back(linear[t]);
  }
  return out;
}

/// m or rad, for one standard uncertainty of a gap. More than `most_columns` gaps share columns.
Expected<MatrixXd> columns_of_gaps(const Observations& filled, const Said& said,
                                   const std::vector<Gap>& gaps) {
  NONIO_TRY(const auto as_fitted, said.of(filled));
  const std::size_t columns = std::min(gaps.size(), most_columns);
  MatrixXd out(static_cast<Index>(filled.size()), static_cast<Index>(columns));
  Observations other = filled;
  for (std::size_t c = 0; c < columns; ++c) {
    other.material = filled.material;
    for (std::size_t g = c, k = 0; g < gaps.size(); g += columns, ++k)
      for (std::size_t j = 0; j < gaps[g].row.size(); ++j)
        other.material[gaps[g].row[j]] += (k % 2 == 0 ? 1.0 : -1.0) * gaps[g].off[j];
    NONIO_TRY(const auto wrong, said.of(other));
    out.col(static_cast<Index>(c)) = wrong - as_fitted;
  }
  return out;
}

}  // namespace

Expected<MatrixXd> wrong_by_interpolation(const Observations& o, const std::vector<Term>& terms,
                                          const std::vector<VectorXd>& linear) {
  MatrixXd out(static_cast<Index>(o.size()), 0);
  if (o.material.size() != o.size() ||
      std::all_of(o.material.begin(), o.material.end(), [](double x) { return std::isfinite(x); }))
    return out;
  std::vector<std::string> done;
  for (const Term& term : terms) {
    const std::string& axis = term.axis.name;
    if (std::find(done.begin(), done.end(), axis) != done.end()) continue;
    done.push_back(axis);
    const auto r = readings_of(o, term.axis);
    if (!r || r->interpolated.empty()) continue;
    Observations filled = o;
    for (std::size_t i = 0; i < o.size(); ++i)
      if (r->moved[i]) filled.material[i] = 20.0 + r->K[i];
    NONIO_TRY(const auto said, warmed(filled, *r, terms, linear, axis));
    if (said.terms.empty()) continue;
    std::vector<Gap> gaps;
    for (const TemperatureCourse& course : temperature_courses(o, *r))
      if (!add_gaps(course, *r, gaps))
        return fail(
            "too few temperatures are known for the uncertainty of those interpolated between "
            "them");
    NONIO_TRY(const auto wrong, columns_of_gaps(filled, said, gaps));
    out.conservativeResize(Eigen::NoChange, out.cols() + wrong.cols());
    out.rightCols(wrong.cols()) = wrong;
  }
  return out;
}

}  // namespace nonio::model
