// SPDX-License-Identifier: Apache-2.0
#include "picture_data.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

namespace nonio::pdf_report {
namespace {

struct Mean {
  double sum = 0.0;
  std::size_t n = 0;
  void add(double v) { sum += v, ++n; }
  double value() const { return sum / static_cast<double>(n); }
};

/// z with Phi(z) = p, by Newton's method on Phi(z) = erfc(-z/sqrt 2)/2 from 0, which Phi's
/// curvature makes monotone on either side.
double normal_quantile(double p) {
  double z = 0.0;
  for (int i = 0; i < 60; ++i) {
    const double density = std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi);
    const double step = (std::erfc(-z / std::numbers::sqrt2) / 2 - p) / density;
    z -= step;
    if (std::fabs(step) < 1e-12) break;
  }
  return z;
}

int direction_of(const ModelFit& fit, std::size_t row) {
  return row < fit.direction.size() ? fit.direction[row] : 0;
}

}  // namespace

bool counts(const ModelFit& fit, std::size_t row) {
  return row >= fit.weight.size() || fit.weight[row] >= 0.5;
}

Trace mean_by_target(const ModelFit& fit, int direction) {
  std::map<double, Mean> means;
  for (std::size_t i = 0; i < fit.size(); ++i)
    if (direction_of(fit, i) == direction && counts(fit, i))
      means[fit.target[i]].add(fit.residual[i]);
  Trace out;
  for (const auto& [target, mean] : means) out.x.push_back(target), out.y.push_back(mean.value());
  return out;
}

Trace mean_by_run(const ModelFit& fit) {
  std::map<std::uint32_t, Mean> means;
  for (std::size_t i = 0; i < fit.size() && i < fit.run.size(); ++i)
    if (counts(fit, i)) means[fit.run[i]].add(fit.residual[i]);
  Trace out;
  for (const auto& [run, mean] : means) out.x.push_back(run), out.y.push_back(mean.value());
  return out;
}

Trace mean_by_part(const ModelFit& fit, const std::vector<double>& x) {
  double low = INFINITY, high = -INFINITY;
  std::size_t n = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (std::isfinite(x[i]) && counts(fit, i))
      low = std::min(low, x[i]), high = std::max(high, x[i]), ++n;
  if (!(low < high) || n < 12) return {};
  const auto parts = std::min<std::size_t>(12, n / 6);
  std::vector<Mean> across(parts), up(parts);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !counts(fit, i)) continue;
    const auto k = std::min(parts - 1, static_cast<std::size_t>((x[i] - low) / (high - low) *
                                                                static_cast<double>(parts)));
    across[k].add(x[i]);
    up[k].add(fit.residual[i]);
  }
  Trace out;
  for (std::size_t k = 0; k < parts; ++k)
    if (up[k].n >= 3) out.x.push_back(across[k].value()), out.y.push_back(up[k].value());
  return out;
}

Reversal reversal_of(const ModelFit& fit) {
  std::map<double, std::pair<Mean, Mean>> targets;
  for (std::size_t i = 0; i < fit.size(); ++i) {
    if (!counts(fit, i)) continue;
    auto& [plus, minus] = targets[fit.target[i]];
    if (direction_of(fit, i) > 0) plus.add(fit.residual[i]);
    if (direction_of(fit, i) < 0) minus.add(fit.residual[i]);
  }
  Reversal out;
  for (const auto& [target, means] : targets) {
    const auto& [plus, minus] = means;
    if (plus.n == 0 || minus.n == 0) continue;
    out.values.x.push_back(target);
    out.values.y.push_back(plus.value() - minus.value());
    out.spread.push_back(
        std::sqrt(1.0 / static_cast<double>(plus.n) + 1.0 / static_cast<double>(minus.n)));
  }
  return out;
}

std::vector<double> phase_of(const ModelFit& fit, double period) {
  std::vector<double> out;
  out.reserve(fit.size());
  for (const double p : fit.target) {
    double phase = p - period * std::floor(p / period);
    if (period - phase < 1e-9 * period) phase = 0.0;  // a multiple, but for its last digit
    out.push_back(phase);
  }
  return out;
}

bool one_phase(const std::vector<double>& phase, double period) {
  double sine = 0, cosine = 0;
  for (const double p : phase) {
    sine += std::sin(2 * std::numbers::pi * p / period);
    cosine += std::cos(2 * std::numbers::pi * p / period);
  }
  const double middle = std::atan2(sine, cosine) / (2 * std::numbers::pi);
  return std::all_of(phase.begin(), phase.end(), [&](double p) {
    return std::fabs(std::remainder(p / period - middle, 1.0)) <= 0.01;
  });
}

Normal normal_plot(const ModelFit& fit) {
  constexpr std::size_t outer = 300, inner = 1000;
  const std::size_t n = fit.size();
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return fit.residual[a] < fit.residual[b]; });
  const std::size_t step = n > 2 * outer + inner ? (n - 2 * outer) / inner : 1;
  Normal out;
  for (std::size_t i = 0; i < n; ++i) {
    if (i >= outer && i + outer < n && i % step != 0) continue;
    out.values.x.push_back(
        normal_quantile((static_cast<double>(i) + 0.5) / static_cast<double>(n)));
    out.values.y.push_back(fit.residual[order[i]]);
    out.row.push_back(order[i]);
  }
  return out;
}

}  // namespace nonio::pdf_report
