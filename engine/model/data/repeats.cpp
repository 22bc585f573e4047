// SPDX-License-Identifier: Apache-2.0
#include "repeats.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <unordered_map>

#include "noise.h"
#include "nonio/math/distributions.h"
#include "nonio/math/statistics.h"

namespace nonio::model {

namespace {

/// Divides each group of `before` by the values `by`; groups are numbered by first appearance.
std::vector<std::uint32_t> divided(const std::vector<std::uint32_t>& before,
                                   const std::vector<std::uint64_t>& by, std::size_t& groups) {
  struct Hash {
    std::size_t operator()(const std::pair<std::uint32_t, std::uint64_t>& key) const {
      std::uint64_t h = (key.second ^ (std::uint64_t{key.first} << 32)) * 0x9e3779b97f4a7c15ULL;
      return static_cast<std::size_t>(h ^ (h >> 32));
    }
  };
  std::unordered_map<std::pair<std::uint32_t, std::uint64_t>, std::uint32_t, Hash> known;
  std::vector<std::uint32_t> out(before.size());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = known.try_emplace({before[i], by[i]}, static_cast<std::uint32_t>(known.size()))
                 .first->second;
  groups = known.size();
  return out;
}

/// The rows of each group, in their order, stored in one array.
class Members {
 public:
  Members(const std::vector<std::uint32_t>& group, std::size_t groups)
      : first_(groups + 1, 0), rows_(group.size()) {
    for (const std::uint32_t g : group) ++first_[g + 1];
    for (std::size_t g = 0; g < groups; ++g) first_[g + 1] += first_[g];
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < group.size(); ++i)
      rows_[next[group[i]]++] = static_cast<std::uint32_t>(i);
  }
  std::size_t size() const { return first_.size() - 1; }
  std::span<const std::uint32_t> operator[](std::size_t g) const {
    return {rows_.data() + first_[g], first_[g + 1] - first_[g]};
  }

 private:
  std::vector<std::size_t> first_;
  std::vector<std::uint32_t> rows_;
};

/// May reorder the values.
double median_of(std::span<double> x) {
  const std::size_t half = x.size() / 2;
  if (x.size() <= 8)
    std::sort(x.begin(), x.end());
  else
    std::nth_element(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(half), x.end());
  if (x.size() % 2 == 1) return x[half];
  const double lower = *std::max_element(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(half));
  return lower + (x[half] - lower) / 2.0;
}

}  // namespace

Repeats::Repeats(const Observations& o) {
  const std::size_t n = o.size();
  std::vector<std::uint64_t> by(n);
  std::vector<std::uint32_t> line(n), of_side;
  for (std::size_t i = 0; i < n; ++i) line[i] = line_of(o, i);
  target = line;
  for (const auto& axis : o.axes) {
    // Adding 0.0 converts -0.0 to 0.0.
    for (std::size_t i = 0; i < n; ++i)
      by[i] = std::bit_cast<std::uint64_t>(axis.position[i] + 0.0);
    target = divided(target, by, targets);
  }
  cell = target, cells = targets;
  of_side = divided(line, std::vector<std::uint64_t>(n, 0), sides);
  for (const auto& axis : o.axes) {
    if (axis.approach.empty()) continue;
    for (std::size_t i = 0; i < n; ++i) by[i] = static_cast<std::uint64_t>(axis.approach[i] + 1);
    cell = divided(cell, by, cells);
    of_side = divided(of_side, by, sides);
  }
  for (std::size_t i = 0; i < n; ++i) by[i] = o.run.empty() ? 1 : o.run[i];
  pass = divided(of_side, by, passes);
  side.resize(passes);
  for (std::size_t i = 0; i < n; ++i) side[pass[i]] = of_side[i];
  order.assign(n, 0.0);
  const Members of_pass(pass, passes);
  for (std::size_t p = 0; p < passes; ++p) {
    const auto rows = of_pass[p];
    for (std::size_t k = 0; k < rows.size() && rows.size() > 1; ++k)
      order[rows[k]] = 2.0 * static_cast<double>(k) / static_cast<double>(rows.size() - 1) - 1.0;
  }
}

namespace {

/// 1, z, z^2 over `order`, as far as the pass is long enough; orthonormal with the row weights.
struct PassColumns {
  MatrixXd weighted, plain;
};

template <class Rows, class Weight>
PassColumns columns_of_pass(const Rows& rows, const std::vector<double>& order, const Weight& w) {
  const auto used = std::count_if(rows.begin(), rows.end(), [&](auto i) { return w(i) > 0.0; });
  const Index k = shared_columns(used);
  MatrixXd b(static_cast<Index>(rows.size()), k);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (Index c = 0; c < k; ++c)
      b(static_cast<Index>(i), c) = c == 0   ? 1.0
                                    : c == 1 ? order[rows[i]]
                                             : order[rows[i]] * order[rows[i]];
  // Gram-Schmidt with the weights, applied to all rows.
  MatrixXd wb = b;
  for (Index c = 0; c < k; ++c) {
    for (Index d = 0; d <= c; ++d)
      for (std::size_t i = 0; i < rows.size(); ++i)
        wb(static_cast<Index>(i), d) = w(rows[i]) * b(static_cast<Index>(i), d);
    for (Index d = 0; d < c; ++d) b.col(c) -= wb.col(d).dot(b.col(c)) * b.col(d);
    for (std::size_t i = 0; i < rows.size(); ++i)
      wb(static_cast<Index>(i), c) = w(rows[i]) * b(static_cast<Index>(i), c);
    const double norm = std::sqrt(wb.col(c).dot(b.col(c)));
    b.col(c) /= norm;
    wb.col(c) /= norm;
  }
  return {std::move(wb), std::move(b)};
}

}  // namespace

Saturated saturate(const Repeats& r, const std::vector<double>& y,
                   const std::vector<double>& weight) {
  const std::size_t n = y.size();
  const Members cells(r.cell, r.cells), passes(r.pass, r.passes);
  const auto w = [&](std::uint32_t i) { return weight.empty() ? 1.0 : weight[i]; };
  Saturated out;
  out.e = y;
  std::vector<PassColumns> shared;
  for (std::size_t p = 0; p < r.passes; ++p)
    shared.push_back(columns_of_pass(passes[p], r.order, w));
  VectorXd part;
  double before = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 200; ++round) {
    for (std::size_t c = 0; c < r.cells; ++c) {
      const auto rows = cells[c];
      double sum = 0.0, weights = 0.0;
      for (const auto i : rows) sum += w(i) * out.e[i], weights += w(i);
      if (weights > 0.0)
        for (const auto i : rows) out.e[i] -= sum / weights;
    }
    double squares = 0.0;
    for (std::size_t p = 0; p < r.passes; ++p) {
      const auto rows = passes[p];
      part.resize(static_cast<Index>(rows.size()));
      for (std::size_t i = 0; i < rows.size(); ++i) part(static_cast<Index>(i)) = out.e[rows[i]];
      part -= math::product(shared[p].plain, math::transposed_product(shared[p].weighted, part));
      for (std::size_t i = 0; i < rows.size(); ++i) {
        out.e[rows[i]] = part(static_cast<Index>(i));
        squares += w(rows[i]) * out.e[rows[i]] * out.e[rows[i]];
      }
    }
    out.squares = squares;
    if (!(squares < before * (1.0 - 1e-10))) break;
    before = squares;
  }
  double used = 0.0, cells_used = 0.0;
  for (std::uint32_t i = 0; i < n; ++i) used += w(i) > 0.0 ? 1.0 : 0.0;
  for (std::size_t c = 0; c < r.cells; ++c)
    cells_used += std::any_of(cells[c].begin(), cells[c].end(), [&](auto i) { return w(i) > 0.0; });
  out.dof = used - cells_used;
  // The part that all passes of a side share is already contained in the cell means.
  std::vector<Index> common(r.sides, 0);
  double of_passes = 0.0, of_sides = 0.0;
  for (std::size_t p = 0; p < r.passes; ++p) {
    const Index columns = shared[p].plain.cols();
    of_passes += static_cast<double>(columns);
    common[r.side[p]] = std::max(common[r.side[p]], columns);
  }
  for (const Index k : common) of_sides += static_cast<double>(k);
  out.dof -= of_passes - of_sides;
  out.share.assign(n, 0.0);
  for (std::size_t c = 0; c < r.cells; ++c) {
    double weights = 0.0;
    for (const auto i : cells[c]) weights += w(i);
    for (const auto i : cells[c])
      if (w(i) > 0.0) out.share[i] = 1.0 - w(i) / weights;
  }
  for (std::size_t p = 0; p < r.passes; ++p)
    for (Index i = 0; i < shared[p].plain.rows(); ++i)
      if (double& share = out.share[passes[p][static_cast<std::size_t>(i)]]; share > 0.0)
        share -=
            (1.0 - of_sides / of_passes) * shared[p].plain.row(i).dot(shared[p].weighted.row(i));
  return out;
}

namespace {

/// Readings of a target, or of a cell if each cell of the target has at least four readings, so
/// that a reversal that differs between targets is not treated as scatter.
struct Groups {
  std::vector<std::uint32_t> of;
  std::size_t count;
  bool any_repeats = false;  ///< whether a group has at least three readings
  explicit Groups(const Repeats& r) : of(r.target), count(r.targets + r.cells) {
    std::vector<std::size_t> in_cell(r.cells, 0), in_group(count, 0);
    for (const std::uint32_t cell : r.cell) ++in_cell[cell];
    std::vector<char> by_cell(r.targets, 1);
    for (std::size_t i = 0; i < of.size(); ++i)
      if (in_cell[r.cell[i]] < 4) by_cell[r.target[i]] = 0;
    for (std::size_t i = 0; i < of.size(); ++i) {
      if (by_cell[r.target[i]] != 0) of[i] = static_cast<std::uint32_t>(r.targets) + r.cell[i];
      any_repeats = ++in_group[of[i]] >= 3 || any_repeats;
    }
  }
};

/// Subtracts, three times, the median of the target or cell (of at least three readings), then the
/// running median of adjacent readings of the pass; robust against outliers.
std::vector<double> polished(const Repeats& r, const std::vector<double>& y) {
  const Groups groups(r);
  const Members targets(groups.of, groups.count), passes(r.pass, r.passes);
  // The running median uses repeated targets, if any: other readings contain target errors.
  const auto is_usable = [&](std::uint32_t i) {
    return !groups.any_repeats || targets[groups.of[i]].size() >= 3;
  };
  std::vector<double> e = y, some, smooth;
  for (int round = 0; round < 3; ++round) {
    for (std::size_t t = 0; t < groups.count; ++t) {
      const auto rows = targets[t];
      if (rows.size() < 3) continue;
      some.clear();
      for (const auto i : rows) some.push_back(e[i]);
      const double m = median_of(some);
      for (const auto i : rows) e[i] -= m;
    }
    for (std::size_t p = 0; p < r.passes; ++p) {
      const auto rows = passes[p];
      smooth.assign(rows.size(), 0.0);
      for (std::size_t k = 0; k < rows.size(); ++k) {
        some.clear();
        for (std::size_t j = k >= 3 ? k - 3 : 0; j < std::min(k + 4, rows.size()); ++j)
          if ((j != k || rows.size() == 1) && is_usable(rows[j])) some.push_back(e[rows[j]]);
        smooth[k] = some.empty() ? 0.0 : median_of(some);
      }
      for (std::size_t k = 0; k < rows.size(); ++k) e[rows[k]] -= smooth[k];
    }
  }
  return e;
}

}  // namespace

std::vector<double> apart_from_others(const Repeats& r, const std::vector<std::uint32_t>& rows,
                                      const std::vector<double>& e) {
  const Groups groups(r);
  // Sort the values of each requested group; omitting one value shifts the later ones by one place.
  std::vector<std::size_t> asked(groups.count, 0);
  std::size_t lists = 0;
  for (const auto i : rows)
    if (asked[groups.of[i]] == 0) asked[groups.of[i]] = ++lists;
  std::vector<std::vector<double>> values(lists);
  for (std::size_t i = 0; i < e.size() && lists > 0; ++i)
    if (const std::size_t list = asked[groups.of[i]]; list > 0) values[list - 1].push_back(e[i]);
  for (auto& v : values) std::sort(v.begin(), v.end());
  std::vector<double> out;
  for (const auto i : rows) {
    const std::vector<double>& v = values[asked[groups.of[i]] - 1];
    const std::size_t others = v.size() - 1;
    const auto own =
        static_cast<std::size_t>(std::lower_bound(v.begin(), v.end(), e[i]) - v.begin());
    const auto other = [&](std::size_t k) { return v[k < own ? k : k + 1]; };
    // A reading with too few repeats, next to repeated targets, cannot contradict its repeats.
    const bool alone = others < (groups.any_repeats ? 2U : 1U);
    out.push_back(alone ? (groups.any_repeats ? 0.0 : e[i])
                        : e[i] - (others % 2 == 1
                                      ? other(others / 2)
                                      : (other(others / 2 - 1) + other(others / 2)) / 2.0));
  }
  return out;
}

namespace {

/// Residuals of a fit of the effects of the set-up, such as the tilt of a mirror, with Huber
/// weights. The deviations, if the model has no such effects or the fit fails.
std::vector<double> without_set_up(const Observations& o, const std::vector<Term>& model) {
  std::vector<Term> set_up;
  for (const Term& term : model)
    if (term.effect->is_nuisance) set_up.push_back(term);
  if (set_up.empty()) return o.deviation;
  std::vector<double> weight(o.size(), 1.0);
  std::vector<double> e = o.deviation;
  for (int round = 0; round < 8; ++round) {
    const auto fitted = fit_near(o, set_up, std::vector<char>(set_up.size(), 0), weight);
    if (!fitted) return o.deviation;
    e = fitted->residual;
    const double s = std::max(math::robust_deviation(e), 1e-12);
    for (std::size_t i = 0; i < e.size(); ++i) weight[i] = s / std::max(std::fabs(e[i]), s);
  }
  return e;
}

/// Ratio of the scatter near the target of a reading (median over adjacent targets) to s, because a
/// range with more scatter is not a series of outliers. 1 for a ratio up to 2, several axes, fewer
/// than 64 or more than 20000 readings, or if adjacent targets are more than two thirds.
std::vector<double> rougher_than(double s, const Observations& o, const std::vector<double>& e) {
  constexpr std::size_t fewest = 16;
  // docs/dev/constants.md, M27.
  constexpr double much = 2.0;
  std::vector<double> out(e.size(), 1.0);
  if (o.axes.size() != 1 || e.size() < 4 * fewest || e.size() > 20000) return out;
  const std::vector<double>& at = o.axes.front().position;
  std::vector<std::size_t> row(e.size());
  std::iota(row.begin(), row.end(), std::size_t{0});
  std::stable_sort(row.begin(), row.end(), [&](auto a, auto b) { return at[a] < at[b]; });
  // Use whole targets: three, and more until there are enough readings.
  std::vector<std::size_t> first;
  for (std::size_t k = 0; k < row.size(); ++k)
    if (k == 0 || at[row[k]] != at[row[k - 1]]) first.push_back(k);
  first.push_back(row.size());
  const std::size_t targets = first.size() - 1;
  std::vector<double> some;
  for (std::size_t t = 0; t < targets; ++t) {
    std::size_t low = t > 0 ? t - 1 : 0, high = std::min(t + 2, targets);
    while (first[high] - first[low] < fewest && (low > 0 || high < targets)) {
      low -= low > 0 ? 1 : 0;
      high += high < targets ? 1 : 0;
    }
    if (3 * (high - low) > 2 * targets) continue;
    some.clear();
    for (std::size_t k = first[low]; k < first[high]; ++k) some.push_back(std::fabs(e[row[k]]));
    const double ratio = 1.2 * 1.4826 * median_of(some) / s;
    if (ratio > much)
      for (std::size_t k = first[t]; k < first[t + 1]; ++k) out[row[k]] = ratio;
  }
  return out;
}

}  // namespace

std::vector<Suspect> suspects_of(const Observations& o, const Repeats& r,
                                 const std::vector<Term>& model) {
  const std::size_t n = o.size();
  // Without repeats and without an order in time, only an explanation can contradict a reading.
  if (n < 10 || (!o.order_known && !Groups(r).any_repeats)) return {};
  const std::vector<double> y = without_set_up(o, model);
  const std::vector<double> e = polished(r, y);
  const double display = digit_of(o) / std::sqrt(12.0);
  // The factor 1.2 corrects for the noise that the subtraction of medians removes: with 4 to 10
  // readings per target, it reduces the scatter by a measured factor of 1.1 to 1.25.
  const double s_rough = std::max(1.2 * math::robust_deviation(e), display);
  if (!(s_rough > 0.0)) return {};
  std::vector<double> weight(n, 1.0);
  std::vector<std::uint32_t> high, flagged;
  const std::vector<double> rougher = rougher_than(s_rough, o, e);
  for (std::uint32_t i = 0; i < n; ++i)
    // docs/dev/constants.md, M11.
    if (std::fabs(e[i]) > 3.5 * s_rough * rougher[i]) high.push_back(i);
  const std::vector<double> apart = apart_from_others(r, high, e);
  for (std::size_t k = 0; k < high.size(); ++k) {
    if (!(std::fabs(apart[k]) > 3.5 * s_rough * rougher[high[k]])) continue;
    flagged.push_back(high[k]);
    weight[high[k]] = 0.0;
  }
  if (flagged.empty() || flagged.size() > n / 4) return {};
  const Saturated left = saturate(r, y, weight);
  const bool known = left.dof >= 8.0;
  const double s = std::max(known ? std::sqrt(left.squares / left.dof) : s_rough, display);
  const double dof = known ? left.dof : static_cast<double>(n) / 4.0;
  std::vector<double> in_cell(r.cells, 0.0);
  for (std::size_t i = 0; i < n; ++i) in_cell[r.cell[i]] += weight[i];
  double least = 3.0;  // smallest significant t
  // docs/dev/constants.md, M12.
  while (math::t_two_sided(least, dof) * static_cast<double>(n) > 0.01) least += 0.01;
  std::vector<Suspect> out;
  for (const auto i : flagged) {
    const double others = in_cell[r.cell[i]];
    const bool repeated = known && others > 0.0;
    const double residual = repeated ? left.e[i] : e[i];
    // Pass terms increase the variance by about 0.2 of that of a reading, the cell mean by 1/n.
    const double sigma = s * rougher[i] * std::sqrt(1.0 + (repeated ? 1.0 / others + 0.2 : 0.3));
    const double t = residual / sigma;
    if (math::t_two_sided(t, dof) * static_cast<double>(n) > 0.01) continue;
    out.push_back({i, residual, t, least * sigma});
  }
  return out;
}

}  // namespace nonio::model
