// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>

#include "nonio/math/budget.h"

namespace nonio::math {
namespace {

/// Variance of one input in a result, and the sum of the fourth powers of its independent parts.
struct Parts {
  double variance = 0.0, fourth = 0.0;
  void add(double part) { variance += part * part, fourth += std::pow(part, 4); }
};

class Variance {
 public:
  Variance(const ReadingModel& model, const ReadingModel::Input& input, std::span<const double> J)
      : model_(model), input_(input), J_(J) {}

  /// Returns the variance that the repetition already contains: by the residuals of the fit, and by
  /// the random walk of the input.
  double seen_elsewhere() const {
    double variance = 0.0;
    std::size_t first = 0;
    for (std::size_t l = 0; l < model_.lines.size(); ++l) {
      const BudgetLine& line = model_.lines[l];
      double each = line.in_residuals ? input_.seen * input_.seen : 0.0;
      if (input_.is.correlation == Correlation::walk)
        each += std::pow(input_.of_line[l], 2) * line.walk_seen;
      for (const double J : J_.subspan(first, line.length.size())) variance += each * J * J;
      first += line.length.size();
    }
    return variance;
  }

  Parts all(bool in_residuals = false) const {
    if (!input_.patterns.empty()) return in_residuals ? Parts{} : of_patterns();
    // sums by group; a single one for inputs common to the instrument
    std::map<std::size_t, double> sums;
    Parts out;
    std::size_t first = 0;
    for (std::size_t l = 0; l < model_.lines.size(); ++l) {
      const BudgetLine& line = model_.lines[l];
      const auto part = J_.subspan(first, line.length.size());
      first += line.length.size();
      const double u = input_.of_line[l];
      if (u == 0.0 || (in_residuals && !line.in_residuals)) continue;
      switch (input_.is.correlation) {
        case Correlation::readings:
          for (std::size_t i = 0; i < part.size(); ++i) out.add(u * part[i] * factor(line, i));
          break;
        case Correlation::walk:
          out.variance += u * u * (line.visits.empty() ? walk(part) : walk(line, part));
          break;
        case Correlation::lines:
          sums[line.group] += u * sum(line, part);
          break;
        case Correlation::device:
          sums[0] += u * sum(line, part);
      }
    }
    const Parts grouped = of_groups(sums);
    return {out.variance + grouped.variance, out.fourth + grouped.fourth};
  }

 private:
  double factor(const BudgetLine& line, std::size_t i) const {
    if (input_.is.with_length) return line.length[i];
    return i == 0 && line.zeroed ? 0.0 : 1.0;
  }
  double sum(const BudgetLine& line, std::span<const double> J) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < J.size(); ++i) sum += J[i] * factor(line, i);
    return sum;
  }
  Parts of_groups(const std::map<std::size_t, double>& sums) const {
    Parts each, all;
    double total = 0.0;
    for (const auto& [group, value] : sums) each.add(value), total += value;
    all.add(total);
    if (!input_.together) return each.variance < all.variance ? all : each;
    const double t = *input_.together;
    return {(1.0 - t) * each.variance + t * all.variance,
            (1.0 - t) * (1.0 - t) * each.fourth + t * t * all.fourth};
  }
  static double walk(std::span<const double> J) {
    double variance = 0.0, rest = 0.0;
    for (std::size_t i = J.size(); i-- > 1;) rest += J[i], variance += rest * rest;
    return J.size() < 2 ? 0.0 : variance / static_cast<double>(J.size() - 1);
  }
  static double walk(const BudgetLine& line, std::span<const double> J) {
    double variance = 0.0, rest = 0.0;
    for (std::size_t v = line.visits.size(); v-- > 0;) {
      const BudgetLine::Visit& visit = line.visits[v];
      rest += visit.weight * J[visit.reading];
      variance += (visit.time - (v > 0 ? line.visits[v - 1].time : 0.0)) * rest * rest;
    }
    return variance;
  }
  Parts of_patterns() const {
    Parts out;
    for (const auto& pattern : input_.patterns) {
      double sum = 0.0;
      for (std::size_t i = 0; i < J_.size(); ++i) sum += J_[i] * pattern[i];
      out.add(sum);
    }
    return out;
  }

  const ReadingModel& model_;
  const ReadingModel::Input& input_;
  std::span<const double> J_;
};

}  // namespace

bool ReadingModel::Input::of_each_reading() const {
  return is.correlation == Correlation::readings && is.quantity != Quantity::small_angle &&
         patterns.empty();
}

std::size_t ReadingModel::readings() const {
  std::size_t n = 0;
  for (const BudgetLine& line : lines) n += line.length.size();
  return n;
}

Shares ReadingModel::shares(std::span<const double> row) const {
  Shares out;
  for (const Input& input : inputs) {
    const Variance of(*this, input, row);
    const Parts all = of.all();
    out.u.push_back(std::sqrt(all.variance));
    out.in_residuals.push_back(
        std::sqrt(input.of_each_reading() ? of.all(true).variance : of.seen_elsewhere()));
    out.rectangular.push_back(input.is.distribution == Distribution::rectangular
                                  ? std::sqrt(std::sqrt(all.fourth))
                                  : 0.0);
  }
  double variance = 0.0, fourth = 0.0;
  std::size_t i = 0;
  for (const BudgetLine& line : lines) {
    double sum = 0.0;
    for (std::size_t k = 0; k < line.length.size(); ++k, ++i)
      if (k > 0 || !line.zeroed) sum += row[i] * row[i];
    const double own = line.u * line.u * sum;
    variance += own;
    fourth += own * own / line.dof;
  }
  if (std::any_of(lines.begin(), lines.end(), [](const BudgetLine& l) { return l.u > 0.0; }))
    out.dof = fourth > 0.0 ? variance * variance / fourth : INFINITY;
  return out;
}

void ReadingModel::see_residuals(std::span<const std::vector<double>> rows, double dof) {
  if (!(dof > 0.0)) return;
  for (Input& input : inputs) {
    if (input.of_each_reading()) continue;
    double sum = 0.0;
    for (const auto& row : rows) sum += Variance(*this, input, row).all().variance;
    input.seen = std::sqrt(sum / dof);
  }
}

}  // namespace nonio::math
