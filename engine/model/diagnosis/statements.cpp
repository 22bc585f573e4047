// SPDX-License-Identifier: Apache-2.0
#include "statements.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "nonio/math/distributions.h"
#include "nonio/sdk/axis_readings.h"

namespace nonio::model {

namespace {

// docs/dev/constants.md, M36.
constexpr double stated_below = 0.001;

/// Weighted sums of a column over cells or passes.
struct Sums {
  std::vector<double> sum, n;
  Sums(const std::vector<std::uint32_t>& of, std::size_t count, const std::vector<double>& weight,
       const std::vector<double>& x)
      : sum(count, 0.0), n(count, 0.0) {
    for (std::size_t i = 0; i < x.size(); ++i)
      sum[of[i]] += weight[i] * x[i], n[of[i]] += weight[i];
  }
  double mean(std::size_t k) const { return n[k] > 0.0 ? sum[k] / n[k] : 0.0; }
};

/// Less the mean of the repeats of each cell.
std::vector<double> within_cells(const Finding& f, std::vector<double> x) {
  const Sums cells(f.repeats.cell, f.repeats.cells, f.weight, x);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] -= cells.mean(f.repeats.cell[i]);
  return x;
}

/// Straight line of the zeros of passes over their times.
std::optional<Statement> drift(const Finding& f, double dof) {
  const auto read = readings_of(f.part.table, f.part.axes.front());
  if (!read || !(read->duration > 0.0) || !(dof > 2.0)) return std::nullopt;
  const Repeats& r = f.repeats;
  const Sums zero(r.pass, r.passes, f.weight, within_cells(f, f.part.table.deviation));
  const Sums time(r.pass, r.passes, f.weight, within_cells(f, read->t));
  double tt = 0.0, ty = 0.0, yy = 0.0;
  for (std::size_t p = 0; p < r.passes; ++p) {
    const double t = time.mean(p), y = zero.mean(p);
    tt += t * t, ty += t * y, yy += y * y;
  }
  if (!(tt > 0.0)) return std::nullopt;
  const double slope = ty / tt, s2 = std::max(yy - slope * ty, 0.0) / (dof - 1.0);
  Statement out{.what = Statement::What::drift};
  out.value = slope * read->duration;
  out.u = std::sqrt(s2 / tt) * read->duration;
  out.p = math::t_two_sided(math::test_ratio(out.value, out.u), dof - 1.0);
  return out.p < stated_below ? std::optional(out) : std::nullopt;
}

/// The reversal of each target, all of one sign, each by itself larger than chance gives.
std::optional<Statement> reversal(const Finding& f, double dof) {
  const Repeats& r = f.repeats;
  const std::vector<double>& y = f.part.table.deviation;
  const std::vector<double> e = within_cells(f, y);
  const Sums cells(r.cell, r.cells, f.weight, y);
  double squares = 0.0, used = 0.0, full = 0.0;
  for (std::size_t i = 0; i < e.size(); ++i) squares += f.weight[i] * e[i] * e[i];
  for (const double n : cells.n) used += n, full += n > 0.0 ? 1.0 : 0.0;
  if (!(used - full >= 1.0) || f.part.way.size() != y.size()) return std::nullopt;
  const double s2 = squares / (used - full);
  std::vector<std::array<std::optional<std::uint32_t>, 2>> of(r.targets);
  for (std::size_t i = 0; i < y.size(); ++i)
    if (f.weight[i] > 0.0 && f.part.way[i] != 0)
      of[r.target[i]][f.part.way[i] > 0 ? 0 : 1] = r.cell[i];
  Statement out{.what = Statement::What::reversal};
  out.low = std::numeric_limits<double>::infinity(), out.high = -out.low;
  double n = 0.0, sum = 0.0, variance = 0.0;
  for (const auto& [plus, minus] : of) {
    if (!plus || !minus) return std::nullopt;
    const double b = cells.mean(*plus) - cells.mean(*minus);
    const double v = s2 * (1.0 / cells.n[*plus] + 1.0 / cells.n[*minus]);
    out.p =
        std::max(n == 0.0 ? 0.0 : out.p, math::t_two_sided(math::test_ratio(b, std::sqrt(v)), dof));
    out.low = std::min(out.low, b), out.high = std::max(out.high, b);
    sum += b, variance += v, ++n;
  }
  if (n < 3.0 || !(out.low * out.high > 0.0)) return std::nullopt;
  out.value = sum / n;
  out.u = std::sqrt(variance / n);  // the zeros of passes are in all targets
  out.p = std::min(1.0, out.p * n);
  return out.p < stated_below ? std::optional(out) : std::nullopt;
}

}  // namespace

std::vector<Statement> statements_of(const Finding& f) {
  std::vector<Statement> out;
  const double dof = static_cast<double>(f.repeats.passes) - static_cast<double>(f.repeats.sides);
  if (f.part.kind != Part::Kind::axis || !(dof >= 3.0)) return out;
  for (const auto& one : {drift(f, dof), reversal(f, dof)})
    if (one) out.push_back(*one);
  return out;
}

}  // namespace nonio::model
