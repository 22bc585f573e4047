// SPDX-License-Identifier: Apache-2.0
// Intervals of many like machines: who was in tolerance after how long, and how they drift.
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "laboratory/statistics/gls.h"
#include "laboratory/statistics/intervals.h"
#include "nonio/math/distributions.h"

namespace nonio::statistics {
namespace {

constexpr int fewest_machines = 20;
constexpr std::size_t fewest_times = 3;

double log_likelihood(const Reliability& r, const std::vector<Tried>& all) {
  double out = 0.0;
  for (const Tried& t : all) {
    const double p = r.at(t.months);
    if (t.passed > 0) out += t.passed * std::log(p);
    if (t.passed < t.machines) out += (t.machines - t.passed) * std::log1p(-p);
  }
  return std::isnan(out) ? -std::numeric_limits<double>::infinity() : out;
}

/// Highest place of f between low and high: a grid, drawn closer five times.
template <class F>
double highest(double low, double high, const F& f) {
  constexpr int cells = 40, rounds = 9;
  double best = low, most = f(low);
  for (int round = 0; round < rounds; ++round) {
    const double step = (high - low) / cells;
    for (int k = 0; k <= cells; ++k)
      if (const double x = low + step * k, value = f(x); value > most) most = value, best = x;
    low = std::max(low, best - step), high = std::min(high, best + step);
  }
  return best;
}

/// Time at which `beyond` becomes true, within `longest`.
template <class F>
std::optional<double> first_time(double longest, const F& beyond) {
  constexpr int cells = 4096;
  if (beyond(0.0)) return 0.0;
  int k = 1;
  while (k <= cells && !beyond(longest * k / cells)) ++k;
  if (k > cells) return std::nullopt;
  double low = longest * (k - 1) / cells, high = longest * k / cells;
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2.0;
    (beyond(middle) ? high : low) = middle;
  }
  return high;
}

bool sound(const std::vector<Tried>& all) {
  return std::all_of(all.begin(), all.end(), [](const Tried& t) {
    return std::isfinite(t.months) && t.months > 0.0 && t.machines > 0 && t.passed >= 0 &&
           t.passed <= t.machines;
  });
}

struct Fleet {
  int machines = 0, passed = 0;
  std::set<double> times{};
};

Fleet fleet_of(const std::vector<Tried>& all) {
  Fleet out;
  for (const Tried& t : all) {
    out.machines += t.machines, out.passed += t.passed;
    out.times.insert(t.months);
  }
  return out;
}

/// AIC, less what all models have.
double cost(const Reliability& r) {
  return 2.0 * (r.model == Reliability::Model::exponential ? 1.0 : 2.0) - 2.0 * r.log_likelihood;
}

}  // namespace

double Reliability::at(double months) const {
  switch (model) {
    case Model::exponential:
      return std::exp(-a * months);
    case Model::weibull:
      return std::exp(-std::pow(a * months, b));
    case Model::random_walk:
      return 1.0 - normal_two_sided(1.0 / std::sqrt(a + b * months));
  }
  return 0.0;
}

std::optional<Reliability> likeliest(Reliability::Model model, const std::vector<Tried>& all) {
  const Fleet f = fleet_of(all);
  if (!sound(all) || f.times.size() < 2 || f.passed == 0 || f.passed == f.machines)
    return std::nullopt;
  const double scale = std::log(*f.times.rbegin());
  Reliability r{model};
  const auto value = [&] { return log_likelihood(r, all); };
  if (model == Reliability::Model::exponential) {
    r.a = std::exp(highest(-12.0 - scale, 5.0 - scale, [&](double x) {
      r.a = std::exp(x);
      return value();
    }));
  } else if (model == Reliability::Model::weibull) {
    const auto best_a = [&](double b) {
      r.b = b;
      r.a = std::exp(highest(-12.0 - scale, 5.0 - scale, [&](double x) {
        r.a = std::exp(x);
        return value();
      }));
      return value();
    };
    best_a(std::exp(
        highest(std::log(0.05), std::log(20.0), [&](double x) { return best_a(std::exp(x)); })));
  } else {
    const auto best_b = [&](double a) {
      r.a = a;
      r.b = std::exp(highest(-12.0 - scale, 8.0 - scale, [&](double x) {
        r.b = std::exp(x);
        return value();
      }));
      return value();
    };
    best_b(highest(0.0, 20.0, best_b));
  }
  r.log_likelihood = value();
  return r;
}

Proposal reliability(const std::vector<Tried>& all, double target) {
  const auto no = [](std::string why, double number) {
    return Proposal{
        Proposal::Method::reliability, std::nullopt, std::move(why), {{"machines", number}}};
  };
  const Fleet f = fleet_of(all);
  if (!(target > 0.0) || !(target < 1.0)) return no("no-target", f.machines);
  if (!sound(all) || f.machines < fewest_machines) return no("few-machines", f.machines);
  if (f.times.size() < fewest_times) return no("few-times", f.machines);
  if (f.passed == f.machines) return no("all-passed", f.machines);
  std::optional<Reliability> best;
  for (const auto model : {Reliability::Model::exponential, Reliability::Model::weibull,
                           Reliability::Model::random_walk})
    if (const auto r = likeliest(model, all); r && (!best || cost(*r) < cost(*best))) best = r;
  if (!best) return no("few-times", f.machines);
  const auto when =
      first_time(*f.times.rbegin(), [&](double t) { return t > 0.0 && best->at(t) <= target; });
  if (!when) return no("beyond-tried", f.machines);
  return {Proposal::Method::reliability,
          *when,
          "reliability",
          {{"machines", f.machines}, {"passed", f.passed}, {"target", target}}};
}

std::optional<Drift> drift_since_adjustment(const std::vector<double>& t,
                                            const std::vector<double>& d, int degree) {
  const auto n = static_cast<Index>(t.size());
  if (t.size() != d.size() || degree < 1 || n <= degree + 1) return std::nullopt;
  MatrixXd T(n, degree);
  VectorXd y(n);
  for (Index i = 0; i < n; ++i) {
    y(i) = d[static_cast<std::size_t>(i)];
    for (Index k = 0; k < degree; ++k)
      T(i, k) = std::pow(t[static_cast<std::size_t>(i)], static_cast<double>(k + 1));
  }
  if (!T.allFinite() || !y.allFinite()) return std::nullopt;
  const VectorXd unit = T.colwise().norm();  // of each power, for the rank
  if (!(unit.minCoeff() > 0.0)) return std::nullopt;
  const MatrixXd X = math::scaled_columns(T, unit.cwiseInverse());
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(X);
  if (qr.rank() < degree) return std::nullopt;
  Drift out;
  const VectorXd b = math::solution(qr, y).cwiseQuotient(unit);
  out.dof = static_cast<double>(n - degree);
  out.s = std::sqrt(math::squared_residual(y, T, b) / out.dof);
  const MatrixXd scaled = math::inverse(math::transposed_product(X, X));
  out.b.assign(b.begin(), b.end());
  for (Index i = 0; i < degree; ++i)
    for (Index j = 0; j < degree; ++j)
      out.C.push_back(out.s * out.s * scaled(i, j) / unit(i) / unit(j));
  return out;
}

double Drift::at(double t) const {
  double out = 0.0, power = 1.0;
  for (const double c : b) out += c * (power *= t);
  return out;
}

double Drift::u_prediction(double t) const {
  const std::size_t m = b.size();
  double variance = s * s;
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j < m; ++j)
      variance += C[i * m + j] * std::pow(t, static_cast<double>(i + j + 2));
  return std::sqrt(variance);
}

std::optional<double> until_uncertainty(const Drift& d, double u0, double most, double longest) {
  return first_time(longest, [&](double t) { return std::hypot(u0, d.u_prediction(t)) >= most; });
}

std::optional<double> until_limit(const Drift& d, double value, double u0, Limits limits,
                                  double confidence, double longest) {
  if ((!limits.lower && !limits.upper) || !(d.dof > 0.0) || !(confidence > 0.0) ||
      !(confidence < 1.0))
    return std::nullopt;
  const double sides = limits.lower && limits.upper ? 2.0 : 1.0;
  const double k = math::t_upper_quantile((1.0 - confidence) / sides, d.dof);
  return first_time(longest, [&](double t) {
    const double at = value + d.at(t), bound = k * std::hypot(u0, d.u_prediction(t));
    return (limits.upper && at + bound >= *limits.upper) ||
           (limits.lower && at - bound <= *limits.lower);
  });
}

Proposal drift_interval(const std::vector<double>& t, const std::vector<double>& d, int degree,
                        double value, double u0, Limits limits, double confidence) {
  constexpr double beyond_seen = 1.5;
  Proposal out{Proposal::Method::drift,
               std::nullopt,
               "few-readings",
               {{"readings", static_cast<double>(t.size())}}};
  const auto drift = drift_since_adjustment(t, d, degree);
  if (!drift) return out;
  out.why = "no-limit";
  if (!limits.lower && !limits.upper) return out;
  const double far = beyond_seen * *std::max_element(t.begin(), t.end());
  if (!(far > 0.0)) return out.why = "few-readings", out;
  const auto when = until_limit(*drift, value, u0, limits, confidence, far);
  out.why = !when ? "as-far-as-seen" : *when > 0.0 ? "drift-meets-limit" : "out-already";
  if (!when || *when > 0.0) out.months = when.value_or(far);
  return out;
}

}  // namespace nonio::statistics
