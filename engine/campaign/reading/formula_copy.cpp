// SPDX-License-Identifier: Apache-2.0
#include "campaign/reading/formula_copy.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "nonio/math/golden_section.h"

namespace nonio::reading {

namespace {

using Columns = Effect::Columns;

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

void take_out(const Columns& basis, std::vector<double>& v) {
  for (int twice = 0; twice < 2; ++twice)
    for (const auto& unit : basis) {
      const double part = dot(unit, v);
      for (std::size_t i = 0; i < v.size(); ++i) v[i] -= part * unit[i];
    }
}

void take_out_zeros(const Observations& o, std::vector<double>& v) {
  std::vector<double> sum(std::max<std::size_t>(o.lines.size(), 1)), count(sum.size());
  const auto line = [&](std::size_t i) { return o.line.empty() ? 0 : o.line[i]; };
  for (std::size_t i = 0; i < v.size(); ++i) sum[line(i)] += v[i], count[line(i)] += 1.0;
  for (std::size_t i = 0; i < v.size(); ++i) v[i] -= sum[line(i)] / count[line(i)];
}

/// Orthonormal basis (Gram-Schmidt, twice) of the columns without a zero for each line.
Columns span_of(const Observations& o, Columns columns) {
  constexpr double dependent = 1e-8;
  Columns basis;
  for (auto& v : columns) {
    const double whole = std::sqrt(dot(v, v));
    take_out_zeros(o, v);
    take_out(basis, v);
    const double left = std::sqrt(dot(v, v));
    if (!(left > dependent * whole)) continue;
    for (double& x : v) x /= left;
    basis.push_back(std::move(v));
  }
  return basis;
}

/// Largest sine of an angle between a vector of the first span and the second span; 1 if their
/// dimensions differ.
double apart(const Columns& a, const Columns& b) {
  if (a.size() != b.size()) return 1.0;
  double most = 0.0;
  for (auto v : a) {
    take_out(b, v);
    most = std::max(most, std::sqrt(dot(v, v)));
  }
  return most;
}

class Nearest {
 public:
  Nearest(const Observations& o, const Axis& axis, const Effect& effect, const Columns& own)
      : o_(o), axis_(axis), effect_(effect), own_(own) {}

  double at(const std::vector<double>& shape) const {
    const auto columns = effect_.columns(o_, axis_, shape);
    return columns ? apart(own_, span_of(o_, *columns)) : 1.0;
  }

  double over_grid() {
    std::size_t searched = effect_.shapes.size(), free = 0;
    for (std::size_t k = effect_.shapes.size(); k-- > 0;) {
      usual_.insert(usual_.begin(), effect_.shapes[k].usual.value_or(0.0));
      if (!effect_.shapes[k].usual) searched = k, ++free;
    }
    if (free == 0) return at(usual_);
    if (free > 1) return 1.0;  // the catalog has no effect with two searched shapes
    searched_ = searched;
    const auto grid = effect_.shapes[searched].grid(o_, axis_);
    double least = 1.0;
    std::size_t best = 0;
    for (std::size_t k = 0; k < grid.size(); ++k)
      if (const double d = with(grid[k]); d < least) least = d, best = k;
    if (grid.empty() || !effect_.shapes[searched].continuous) return least;
    return std::min(
        least, between(grid[best == 0 ? 0 : best - 1], grid[std::min(best + 1, grid.size() - 1)]));
  }

 private:
  double with(double value) const {
    std::vector<double> shape = usual_;
    shape[searched_] = value;
    return at(shape);
  }

  double between(double low, double high) const {
    const math::Bracket bracket =
        math::golden_section([&](double x) { return with(x); }, low, high, 60);
    return std::min(bracket.at_a, bracket.at_b);
  }

  const Observations& o_;
  const Axis& axis_;
  const Effect& effect_;
  const Columns& own_;
  std::vector<double> usual_{};
  std::size_t searched_ = 0;
};

}  // namespace

Expected<std::string> copy_of(const Observations& o, const Axis& axis, const Effect& own,
                              const std::vector<Effect>& catalogue) {
  constexpr double same = 1e-6;
  std::vector<double> shape;
  for (const auto& s : own.shapes) {
    const auto grid = s.grid(o, axis);
    if (grid.empty()) return std::string();
    shape.push_back(grid[grid.size() / 2]);
  }
  NONIO_TRY(auto columns, own.columns(o, axis, shape));
  const Columns span = span_of(o, std::move(columns));
  if (span.empty()) return std::string("zero");
  for (const Effect& effect : catalogue) {
    if (effect.info.name == own.info.name || !effect.applies || !effect.applies(o, axis)) continue;
    Nearest nearest(o, axis, effect, span);
    const bool alike = !shape.empty() && shape.size() == effect.shapes.size();
    if ((alike && nearest.at(shape) < same) || nearest.over_grid() < same) return effect.info.name;
  }
  return std::string();
}

}  // namespace nonio::reading
