// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/targets.h"

#include <simdjson.h>

#include <algorithm>
#include <cmath>
#include <map>

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

/// Both halves of a symmetric matrix from the upper one; empty if it is none of n rows.
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

/// A straightness is named by its direction: "straightness:Y.curve_2".
std::string name_in(const std::string& quantity) {
  const auto dot = quantity.rfind('.');
  return dot == std::string::npos ? quantity : quantity.substr(dot + 1);
}

/// Polynomial that a quantity is the coefficient of; none: it does not refer to the ends.
std::optional<std::size_t> degree_of(const std::string& kind) {
  if (kind == "B_mean") return 0;
  if (kind == "scale") return 1;
  if (kind == "curve_2") return 2;
  if (kind == "curve_3") return 3;
  return std::nullopt;
}

/// Which of the sinusoids beside the curve: a turn comes first, then what a drive makes.
std::optional<std::size_t> sinusoid_of(const std::string& kind, std::size_t count) {
  if (count < 2) return std::nullopt;
  for (const auto& [name, at] :
       {std::pair("turn_cos", std::size_t{0}), std::pair("turn_sin", std::size_t{1}),
        std::pair("cyclic_cos", count - 2), std::pair("cyclic_sin", count - 1)})
    if (kind == name) return at;
  return std::nullopt;
}

/// Of P1 over a stretch, in um and mm, to um/m.
double factor_of(const std::string& kind, const kernel::Stretch& over) {
  constexpr double mm_per_m = 1000.0;
  return kind == "scale" ? 2.0 * mm_per_m / over.length() : 1.0;
}

/// Variance that a machine has between its targets: of all points together, since it is the
/// machine's. Not below 0.
double beyond_of(const std::vector<PointTargets>& targets) {
  double sum = 0.0, dof = 0.0;
  for (const PointTargets& t : targets) sum += t.fit.dof * t.fit.beyond, dof += t.fit.dof;
  return dof > 0.0 ? std::max(0.0, sum / dof) : 0.0;
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
    if (beyond * share > 0.0)
      p.common.push_back({targets_source + of[i].digest, std::sqrt(beyond * share)});
  }
  return out;
}

bool is_targets(const std::string& source) { return source.starts_with(targets_source); }

}  // namespace nonio::assessment
