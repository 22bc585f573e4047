// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/targets.h"

#include <simdjson.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>

namespace nonio::assessment {
namespace dom = simdjson::dom;
namespace kernel = nonio::statistics;

namespace {

constexpr const char* targets_source = "targets ";

std::vector<double> numbers(const dom::object& o, const char* name) {
  std::vector<double> out;
  if (dom::array list; o[name].get(list) == simdjson::SUCCESS)
    for (const double x : list) out.push_back(x);
  return out;
}

std::vector<double> whole(const std::vector<double>& upper, std::size_t n) {
  if (upper.size() != n * (n + 1) / 2) return {};
  std::vector<double> out(n * n);
  std::size_t k = 0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i; j < n; ++j, ++k) out[i * n + j] = out[j * n + i] = upper[k];
  return out;
}

StoredFit fit_in(const dom::object& o, const char* name, const kernel::Stretch& span) {
  const dom::object fit = o[name];
  StoredFit out{fit["beyond"], fit["dof"], {span, numbers(fit, "coefficients"), {}, {}}};
  out.residuals = numbers(fit, "residuals");
  const std::size_t n = out.curve.coefficients.size();
  out.curve.covariance = whole(numbers(fit, "upper"), n);
  out.curve.share = whole(numbers(fit, "share"), n);
  if (out.curve.covariance.size() != n * n || out.curve.share.size() != n * n)
    out.curve = {span, {}, {}, {}};
  const auto values = numbers(fit, "sinusoids"), variances = numbers(fit, "variances"),
             shares = numbers(fit, "shares");
  if (variances.size() == values.size() && shares.size() == values.size())
    for (std::size_t i = 0; i < values.size(); ++i)
      out.sinusoids.push_back({values[i], variances[i], shares[i]});
  return out;
}

StoredTargets targets_in(const dom::object& o) {
  StoredTargets out{.digest = std::string(std::string_view(o["targets"])),
                    .span = {o["from"], o["to"]},
                    .other_variance = numbers(o, "other_variance"),
                    .share = numbers(o, "share")};
  out.mean = fit_in(o, "mean", out.span), out.reversal = fit_in(o, "reversal", out.span);
  return out;
}

std::string name_in(const std::string& quantity) {
  const auto dot = quantity.rfind('.');
  return dot == std::string::npos ? quantity : quantity.substr(dot + 1);
}

std::optional<std::size_t> degree_of(const std::string& kind) {
  if (kind == "B_mean") return 0;
  if (kind == "scale") return 1;
  if (kind == "curve_2") return 2;
  if (kind == "curve_3") return 3;
  return std::nullopt;
}

/// Returns the index of a sinusoid: the first two have the period of one turn, the last two that of
/// the drive.
std::optional<std::size_t> sinusoid_of(const std::string& kind, std::size_t count) {
  if (count < 2) return std::nullopt;
  for (const auto& [name, at] :
       {std::pair("turn_cos", std::size_t{0}), std::pair("turn_sin", std::size_t{1}),
        std::pair("cyclic_cos", count - 2), std::pair("cyclic_sin", count - 1)})
    if (kind == name) return at;
  return std::nullopt;
}

/// Returns the factor from the coefficient of P1 (um, stretch in mm) to the scale in um/m,
/// otherwise 1.
double factor_of(const std::string& kind, const kernel::Stretch& over) {
  constexpr double mm_per_m = 1000.0;
  return kind == "scale" ? 2.0 * mm_per_m / over.length() : 1.0;
}

/// Number of targets and degrees of freedom. Fits of equal kind are compared target by target.
using Kind = std::pair<std::size_t, double>;
Kind kind_of(const StoredFit& f) { return {f.residuals.size(), f.dof}; }

/// Returns the pooled variance of the machine error about the fits, without that of the readings;
/// at least 0.
double beyond_of(const std::vector<PointTargets>& targets) {
  double sum = 0.0, dof = 0.0;
  for (const PointTargets& t : targets) sum += t.fit.dof * t.fit.beyond, dof += t.fit.dof;
  return dof > 0.0 ? std::max(0.0, sum / dof) : 0.0;
}

double of_squares(const std::vector<double>& v) {
  return std::inner_product(v.begin(), v.end(), v.begin(), 0.0);
}

/// Returns half the variance of the difference between residuals of two fits of equal kind, without
/// the part of the readings. `divisor` is the ratio of median to mean of chi-square if a median of
/// many results is taken, otherwise 1.
double half_difference(const StoredFit& a, const StoredFit& b, double divisor) {
  std::vector<double> d(a.residuals.size());
  std::transform(a.residuals.begin(), a.residuals.end(), b.residuals.begin(), d.begin(),
                 std::minus<>());
  const double noise =
      of_squares(a.residuals) + of_squares(b.residuals) - a.dof * (a.beyond + b.beyond);
  return (of_squares(d) / divisor - noise) / (2.0 * a.dof);
}

/// Enlarges a variance with few degrees of freedom, so that a normal test at 1 in 2,000 equals a
/// test with Student's distribution. Source: D. L. Wallace 1959, t^2 = dof (exp(z^2/dof) - 1).
double of_few(double variance, double dof) {
  constexpr double z2 = 12.1;
  return variance * dof / z2 * std::expm1(z2 / dof);
}

/// Returns the variance of each point due to the choice of its targets, at most `beyond`.
/// Successive points of equal kind give estimates (`half_difference`). The result is the mean,
/// enlarged by `of_few`, of the median of all estimates, which a single change of the machine
/// hardly affects, and of the estimates with the two nearest points. A kind with fewer than four
/// points gets `beyond`.
std::vector<double> drawn_anew(const std::vector<PointTargets>& targets, double beyond) {
  constexpr std::size_t fewest = 4;
  std::map<Kind, std::vector<std::size_t>> kinds;
  for (std::size_t i = 0; i < targets.size(); ++i)
    if (!targets[i].fit.residuals.empty() && targets[i].fit.dof > 0.0)
      kinds[kind_of(targets[i].fit)].push_back(i);
  std::vector<double> out(targets.size(), beyond);
  for (const auto& [kind, at] : kinds) {
    if (at.size() < fewest) continue;
    const double dof = kind.second, median = std::pow(1.0 - 2.0 / (9.0 * dof), 3);
    const auto half = [&targets, &at = at](std::size_t a, std::size_t b, double divisor) {
      return half_difference(targets[at[a]].fit, targets[at[b]].fit, divisor);
    };
    std::vector<double> halves;
    for (std::size_t k = 1; k < at.size(); ++k) halves.push_back(half(k - 1, k, median));
    const auto middle = halves.begin() + static_cast<std::ptrdiff_t>(halves.size() / 2);
    std::nth_element(halves.begin(), middle, halves.end());
    const double pooled = std::max(0.0, *middle), pairs = static_cast<double>(halves.size());
    for (std::size_t k = 0; k < at.size(); ++k) {
      const std::size_t one = k > 0 ? k - 1 : 2, other = k + 1 < at.size() ? k + 1 : k - 2;
      const double own = std::max(0.0, half(k, one, 1.0) + half(k, other, 1.0)) / 2.0;
      out[at[k]] = std::min(beyond, of_few((pooled + own) / 2.0, dof * (1.0 + pairs / 2.0)));
    }
  }
  return out;
}

}  // namespace

std::vector<std::optional<StoredTargets>> read_targets(const std::vector<std::string>& texts) {
  std::vector<std::optional<StoredTargets>> out(texts.size());
  dom::parser parser;
  for (std::size_t i = 0; i < texts.size(); ++i) try {
      out[i] = targets_in(parser.parse(texts[i]));
    } catch (const simdjson::simdjson_error& e) {
      if (e.error() == simdjson::MEMALLOC) throw std::bad_alloc();
    }
  return out;
}

PointTargets targets_of(const StoredTargets& t, const std::string& quantity, std::size_t place) {
  return {t.digest, t.span, place < t.other_variance.size() ? t.other_variance[place] : 0.0,
          place < t.share.size() ? t.share[place] : 0.0,
          name_in(quantity) == "B_mean" ? t.reversal : t.mean};
}

Compared compared(std::vector<kernel::Point> points, const std::vector<PointTargets>& targets,
                  const std::string& quantity) {
  Compared out{std::move(points)};
  if (targets.size() < out.points.size() || out.points.empty()) return out;
  const std::vector<PointTargets> of(
      targets.begin(), targets.begin() + static_cast<std::ptrdiff_t>(out.points.size()));
  if (std::all_of(of.begin(), of.end(),
                  [&](const PointTargets& t) { return t.digest == of.front().digest; }))
    return out;
  kernel::Stretch over = of.front().span;
  for (const PointTargets& t : of) over = kernel::common_stretch(over, t.span);
  if (!(over.length() > 0.0)) return out;
  const std::string kind = name_in(quantity);
  const auto degree = degree_of(kind);
  const double beyond = beyond_of(of), factor = factor_of(kind, over);
  const std::vector<double> drawn = drawn_anew(of, beyond);
  for (std::size_t i = 0; i < of.size(); ++i) {
    kernel::Point& p = out.points[i];
    double share = of[i].share;
    if (degree && *degree < of[i].fit.curve.coefficients.size()) {
      const kernel::CoefficientOver c = kernel::coefficient_over(of[i].fit.curve, over, *degree);
      p.value = factor * c.value;
      p.u = std::sqrt(factor * factor * c.variance + of[i].other_variance);
      share = factor * factor * c.share;
      out.over = over;
    } else if (const auto at = sinusoid_of(kind, of[i].fit.sinusoids.size())) {
      const kernel::CoefficientOver& c = of[i].fit.sinusoids[*at];
      p.value = c.value, p.u = std::sqrt(c.variance + of[i].other_variance), share = c.share;
    }
    const double anew = drawn[i];
    if (anew * share > 0.0)
      p.common.push_back({targets_source + of[i].digest, std::sqrt(anew * share)});
    if ((beyond - anew) * share > 0.0) {
      const auto [targets_of_kind, dof] = kind_of(of[i].fit);
      p.common.push_back({targets_source + std::to_string(targets_of_kind) + ' ' +
                              std::to_string(std::lround(dof)),
                          std::sqrt((beyond - anew) * share)});
    }
  }
  return out;
}

bool is_targets(const std::string& source) { return source.starts_with(targets_source); }

}  // namespace nonio::assessment
