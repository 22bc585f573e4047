// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/lengths.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "nonio/math/decision.h"

namespace nonio::math {

double LengthLimit::at(double L) const {
  const double grown = A + (K > 0.0 ? L / K : 0.0);
  if (!(B > 0.0)) return grown;
  return A > 0.0 || K > 0.0 ? std::min(grown, B) : B;
}

namespace {

using ByLength = std::map<std::pair<std::size_t, double>, std::vector<std::size_t>>;

ByLength by_length(const std::vector<LengthError>& all) {
  ByLength out;
  for (std::size_t i = 0; i < all.size(); ++i) out[{all[i].line, all[i].L}].push_back(i);
  return out;
}

constexpr std::uint32_t repeats_of_plan = 3;

}  // namespace

LengthAnswer judge_lengths(const std::vector<LengthError>& all, const LengthLimit& limit,
                           const std::vector<double>& U, bool by_2001, std::string_view rule,
                           const std::vector<double>& k) {
  constexpr std::size_t most_forgiven = 5;
  LengthAnswer out;
  std::vector<int> verdict(all.size());  // -1 inside, 0 indeterminate, 1 outside
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Decision one =
        decide(std::fabs(all[i].E), U[i], limit.at(all[i].L), rule, k.empty() ? 2.0 : k[i]);
    verdict[i] = one == Decision::conforms ? -1 : one == Decision::does_not_conform ? 1 : 0;
  }
  std::set<std::size_t> forgiven;
  if (by_2001)
    for (const auto& [length, rows] : by_length(all)) {
      std::vector<std::size_t> beyond;
      std::size_t more = 0, more_inside = 0;
      for (const std::size_t i : rows) {
        const bool later = all[i].repeat > repeats_of_plan;
        if (later)
          ++more, more_inside += verdict[i] < 0 ? 1 : 0;
        else if (verdict[i] > 0)
          beyond.push_back(i);
      }
      if (beyond.size() != 1) continue;
      if (more >= 10 && more_inside == more) forgiven.insert(beyond.front());
      if (more < 10) ++out.to_repeat;
    }
  if (forgiven.size() > most_forgiven || out.to_repeat + forgiven.size() > most_forgiven)
    forgiven.clear(), out.to_repeat = 0;
  std::pair<int, double> deciding(-1, -INFINITY);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (forgiven.contains(i)) continue;
    out.outside += verdict[i] > 0 ? 1 : 0;
    out.undecided += verdict[i] == 0 ? 1 : 0;
    // The error that decides: beyond its limit, else indeterminate, else with the smallest margin.
    const double guard = std::isfinite(U[i]) ? guard_band(U[i], rule, k.empty() ? 2.0 : k[i]) : 0.0;
    const std::pair row(
        verdict[i], std::fabs(all[i].E) - limit.at(all[i].L) + (verdict[i] > 0 ? -guard : guard));
    if (row > deciding) deciding = row, out.worst = i;
  }
  out.decision = out.to_repeat > 0 && out.outside == out.to_repeat ? Decision::cannot_be_decided
                 : out.outside > 0                                 ? Decision::does_not_conform
                 : out.undecided > 0                               ? Decision::cannot_be_decided
                                                                   : Decision::conforms;
  return out;
}

std::optional<RepeatRange> repeat_range(const std::vector<LengthError>& all) {
  std::optional<RepeatRange> out;
  for (const auto& [length, rows] : by_length(all)) {
    RepeatRange r{0.0, rows.front(), rows.front()};
    std::size_t n = 0;
    for (const std::size_t i : rows) {
      if (all[i].repeat > repeats_of_plan) continue;
      if (n++ == 0) r.low = r.high = i;
      if (all[i].E < all[r.low].E) r.low = i;
      if (all[i].E > all[r.high].E) r.high = i;
    }
    if (n < 2) continue;
    r.range = all[r.high].E - all[r.low].E;
    if (!out || r.range > out->range) out = r;
  }
  return out;
}

LengthPlan length_plan(const std::vector<LengthError>& all) {
  std::map<std::size_t, std::map<double, std::size_t>> positions;
  for (const LengthError& e : all) ++positions[e.line][e.L];
  LengthPlan out;
  out.positions = positions.size();
  out.lengths = out.repeats = all.size();
  for (const auto& [line, lengths] : positions) {
    out.lengths = std::min(out.lengths, lengths.size());
    for (const auto& [L, n] : lengths) out.repeats = std::min(out.repeats, n);
  }
  return out;
}

namespace {

/// The last column is the right-hand side. Returns false if the matrix is singular.
bool solve_four(std::array<std::array<double, 5>, 4>& A) {
  for (std::size_t c = 0; c < 4; ++c) {
    std::size_t pivot = c;
    for (std::size_t r = c; r < 4; ++r)
      if (std::fabs(A[r][c]) > std::fabs(A[pivot][c])) pivot = r;
    if (!(std::fabs(A[pivot][c]) > 1e-9)) return false;
    std::swap(A[c], A[pivot]);
    for (std::size_t r = 0; r < 4; ++r) {
      if (r == c) continue;
      const double f = A[r][c] / A[c][c];
      for (std::size_t k = c; k < 5; ++k) A[r][k] -= f * A[c][k];
    }
  }
  return true;
}

}  // namespace

std::optional<FormOfSphere> form_of_sphere(const std::vector<std::array<double, 3>>& points) {
  if (points.size() < 5) return {};
  FormOfSphere out;
  const auto n = static_cast<double>(points.size());
  for (const auto& p : points)
    for (std::size_t k = 0; k < 3; ++k) out.centre[k] += p[k] / n;
  for (int step = 0; step < 100; ++step) {
    std::array<std::array<double, 5>, 4> A{};
    for (const auto& p : points) {
      const std::array<double, 3> v{p[0] - out.centre[0], p[1] - out.centre[1],
                                    p[2] - out.centre[2]};
      const double d = std::hypot(v[0], v[1], v[2]);
      if (!(d > 0.0)) return {};
      const std::array<double, 4> row{-v[0] / d, -v[1] / d, -v[2] / d, -1.0};
      for (std::size_t a = 0; a < 4; ++a) {
        for (std::size_t b = 0; b < 4; ++b) A[a][b] += row[a] * row[b] / n;
        A[a][4] -= row[a] * (d - out.radius) / n;
      }
    }
    if (!solve_four(A)) return {};
    double move = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double by = A[k][4] / A[k][k];
      out.centre[k] += by, move = std::max(move, std::fabs(by));
    }
    out.radius += A[3][4] / A[3][3];
    if (!std::isfinite(out.radius)) return {};
    if (move < 1e-12 * std::max(1.0, out.radius)) break;
  }
  double low = INFINITY, high = -INFINITY, squares = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto& p = points[i];
    const double d = std::hypot(p[0] - out.centre[0], p[1] - out.centre[1], p[2] - out.centre[2]);
    if (d < low) low = d, out.innermost = i;
    if (d > high) high = d, out.outermost = i;
    squares += (d - out.radius) * (d - out.radius);
  }
  out.P = high - low;
  out.s = points.size() > 4 ? std::sqrt(squares / (n - 4.0)) : 0.0;
  return out;
}

}  // namespace nonio::math
