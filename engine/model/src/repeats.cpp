// SPDX-License-Identifier: Apache-2.0
#include "repeats.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "design.h"
#include "nonio/math/distributions.h"
#include "nonio/math/statistics.h"

namespace nonio::model {

namespace {

/// Names things by their first appearance.
template <class Key>
class Numbers {
 public:
  std::uint32_t operator()(const Key& key) {
    return known_.try_emplace(key, static_cast<std::uint32_t>(known_.size())).first->second;
  }
  std::size_t size() const { return known_.size(); }

 private:
  std::map<Key, std::uint32_t> known_;
};

std::vector<std::vector<std::uint32_t>> members(const std::vector<std::uint32_t>& group,
                                                std::size_t groups) {
  std::vector<std::vector<std::uint32_t>> out(groups);
  for (std::size_t i = 0; i < group.size(); ++i)
    out[group[i]].push_back(static_cast<std::uint32_t>(i));
  return out;
}

}  // namespace

Repeats::Repeats(const Observations& o) {
  const std::size_t n = o.size();
  Numbers<std::tuple<std::uint32_t, std::vector<double>>> target_number;
  Numbers<std::tuple<std::uint32_t, std::vector<std::int8_t>>> cell_number, side_number;
  Numbers<std::tuple<std::uint32_t, std::uint32_t>> pass_number;
  std::vector<double> place(o.axes.size());
  std::vector<std::int8_t> from(o.axes.size());
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t a = 0; a < o.axes.size(); ++a) {
      place[a] = o.axes[a].position[i];
      from[a] = o.axes[a].approach.empty() ? std::int8_t{0} : o.axes[a].approach[i];
    }
    const std::uint32_t line = line_of(o, i);
    target.push_back(target_number({line, place}));
    cell.push_back(cell_number({target.back(), from}));
    const std::uint32_t of_side = side_number({line, from});
    pass.push_back(pass_number({of_side, o.run.empty() ? 1 : o.run[i]}));
    if (pass.back() == side.size()) side.push_back(of_side);
  }
  targets = target_number.size();
  cells = cell_number.size();
  passes = pass_number.size();
  sides = side_number.size();
  order.assign(n, 0.0);
  for (const auto& rows : members(pass, passes))
    for (std::size_t k = 0; k < rows.size() && rows.size() > 1; ++k)
      order[rows[k]] = 2.0 * static_cast<double>(k) / static_cast<double>(rows.size() - 1) - 1.0;
}

Saturated saturate(const Repeats& r, const std::vector<double>& y,
                   const std::vector<double>& weight) {
  const std::size_t n = y.size();
  const auto cells = members(r.cell, r.cells), passes = members(r.pass, r.passes);
  const auto w = [&](std::uint32_t i) { return weight.empty() ? 1.0 : weight[i]; };
  Saturated out;
  out.e = y;
  // Columns of a pass over `order`: 1, z, z^2 as far as the pass is long enough.
  std::vector<MatrixXd> basis(r.passes);  // orthonormal in the weighted rows
  std::vector<MatrixXd> value(r.passes);  // the same columns at all rows
  std::vector<Index> columns(r.passes, 0);
  for (std::size_t p = 0; p < r.passes; ++p) {
    const auto& rows = passes[p];
    const auto used = std::count_if(rows.begin(), rows.end(), [&](auto i) { return w(i) > 0.0; });
    const Index k = used >= 10 ? 3 : used >= 6 ? 2 : used >= 1 ? 1 : 0;
    MatrixXd b(static_cast<Index>(rows.size()), k);
    for (std::size_t i = 0; i < rows.size(); ++i)
      for (Index c = 0; c < k; ++c)
        b(static_cast<Index>(i), c) = std::pow(r.order[rows[i]], static_cast<double>(c));
    // Gram-Schmidt with the weights, carried out on all rows.
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
    basis[p] = std::move(wb);
    value[p] = std::move(b);
    columns[p] = k;
  }
  VectorXd part;
  double before = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 200; ++round) {
    for (const auto& rows : cells) {
      double sum = 0.0, weights = 0.0;
      for (const auto i : rows) sum += w(i) * out.e[i], weights += w(i);
      if (weights > 0.0)
        for (const auto i : rows) out.e[i] -= sum / weights;
    }
    double squares = 0.0;
    for (std::size_t p = 0; p < r.passes; ++p) {
      const auto& rows = passes[p];
      part.resize(static_cast<Index>(rows.size()));
      for (std::size_t i = 0; i < rows.size(); ++i) part(static_cast<Index>(i)) = out.e[rows[i]];
      part -= value[p] * (basis[p].transpose() * part);
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
  for (const auto& rows : cells)
    cells_used += std::any_of(rows.begin(), rows.end(), [&](auto i) { return w(i) > 0.0; });
  out.dof = used - cells_used;
  // What the passes of a side have in common is in its cells already.
  std::vector<Index> common(r.sides, 0);
  for (std::size_t p = 0; p < r.passes; ++p) {
    out.dof -= static_cast<double>(columns[p]);
    common[r.side[p]] = std::max(common[r.side[p]], columns[p]);
  }
  for (const Index k : common) out.dof += static_cast<double>(k);
  return out;
}

std::optional<NoiseFloor> noise_floor(const Saturated& s) {
  if (!(s.dof >= 3.0)) return std::nullopt;
  const double floor = std::sqrt(s.squares / s.dof);
  return NoiseFloor{floor, floor / std::sqrt(2.0 * s.dof), s.dof};
}

namespace {

/// What is left when the median of its target and the running median of its pass are taken out of
/// each reading, twice: no model, and a misread value spoils no other.
std::vector<double> polished(const Repeats& r, const std::vector<double>& y) {
  const auto targets = members(r.target, r.targets), passes = members(r.pass, r.passes);
  std::vector<double> e = y, some;
  for (int round = 0; round < 3; ++round) {
    for (const auto& rows : targets) {
      if (rows.size() < 3) continue;
      some.clear();
      for (const auto i : rows) some.push_back(e[i]);
      const double m = math::median(some);
      for (const auto i : rows) e[i] -= m;
    }
    for (const auto& rows : passes) {
      std::vector<double> smooth(rows.size(), 0.0);
      for (std::size_t k = 0; k < rows.size(); ++k) {
        some.clear();
        for (std::size_t j = k >= 3 ? k - 3 : 0; j < std::min(k + 4, rows.size()); ++j)
          if (j != k || rows.size() == 1) some.push_back(e[rows[j]]);
        smooth[k] = math::median(some);
      }
      for (std::size_t k = 0; k < rows.size(); ++k) e[rows[k]] -= smooth[k];
    }
  }
  return e;
}

double median_of_others(const std::vector<std::uint32_t>& rows, std::uint32_t i,
                        const std::vector<double>& e) {
  std::vector<double> others;
  for (const auto k : rows)
    if (k != i) others.push_back(e[k]);
  return others.empty() ? 0.0 : math::median(others);
}

}  // namespace

std::vector<Suspect> suspects_of(const Observations&, const Repeats& r,
                                 const std::vector<double>& y) {
  const std::size_t n = y.size();
  if (n < 10) return {};
  const std::vector<double> e = polished(r, y);
  // Taking out medians takes out noise too: measured, 1.1 to 1.25 with 4 to 10 readings a target.
  const double s_rough = 1.2 * math::robust_deviation(e);
  if (!(s_rough > 0.0)) return {};
  const auto targets = members(r.target, r.targets);
  std::vector<double> weight(n, 1.0);
  std::vector<std::uint32_t> flagged;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double apart = e[i] - median_of_others(targets[r.target[i]], i, e);
    if (std::fabs(e[i]) > 3.5 * s_rough && std::fabs(apart) > 3.5 * s_rough) {
      flagged.push_back(i);
      weight[i] = 0.0;
    }
  }
  if (flagged.empty() || flagged.size() > n / 4) return {};
  const Saturated left = saturate(r, y, weight);
  const auto floor = noise_floor(left);
  const bool known = floor && floor->dof >= 8.0;
  const double s = known ? floor->s : s_rough;
  const double dof = known ? floor->dof : static_cast<double>(n) / 4.0;
  std::vector<double> in_cell(r.cells, 0.0);
  for (std::size_t i = 0; i < n; ++i) in_cell[r.cell[i]] += weight[i];
  std::vector<Suspect> out;
  for (const auto i : flagged) {
    const double others = in_cell[r.cell[i]];
    const bool repeated = known && others > 0.0;
    const double residual = repeated ? left.e[i] : e[i];
    // A pass adds about 3 of its readings' worth of uncertainty, a cell 1 of its own.
    const double sigma = s * std::sqrt(1.0 + (repeated ? 1.0 / others + 0.2 : 0.3));
    const double t = residual / sigma;
    if (math::t_two_sided(t, dof) * static_cast<double>(n) > 0.01) continue;
    double least = 3.0;  // smallest t that would be named
    while (math::t_two_sided(least, dof) * static_cast<double>(n) > 0.01) least += 0.01;
    out.push_back({i, residual, t, least * sigma});
  }
  return out;
}

}  // namespace nonio::model
