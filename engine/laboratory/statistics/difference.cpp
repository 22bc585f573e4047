// SPDX-License-Identifier: Apache-2.0
#include "laboratory/statistics/difference.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "laboratory/statistics/gls.h"
#include "laboratory/statistics/trend.h"
#include "nonio/math/distributions.h"

namespace nonio::statistics {
namespace {

/// after - before of what each source makes of them.
std::map<std::string, double> left_of_common(const Point& before, const Point& after) {
  std::map<std::string, double> out;
  for (const Common& c : before.common) out[c.source] -= c.u;
  for (const Common& c : after.common) out[c.source] += c.u;
  return out;
}

VectorXd vector_of(const std::vector<double>& v) {
  return Eigen::Map<const VectorXd>(v.data(), static_cast<Index>(v.size()));
}

Expected<void> check_curve(const Curve& c, const std::string& which) {
  const std::size_t n = c.values.size();
  if (n == 0) return fail(which + ": expected values, found none");
  if (c.covariance.size() != n * n)
    return fail(which + ": expected a covariance of " + std::to_string(n) + " rows");
  const auto finite = [](double v) { return std::isfinite(v); };
  if (!std::all_of(c.values.begin(), c.values.end(), finite) ||
      !std::all_of(c.covariance.begin(), c.covariance.end(), finite))
    return fail(which + ": expected numbers, found what is not a number");
  for (const Curve::Shared& s : c.common)
    if (s.u.size() != n || !std::all_of(s.u.begin(), s.u.end(), finite))
      return fail(which + ": expected the uncertainty of " + s.source + " of each value");
  return {};
}

MatrixXd covariance_of_difference(const Curve& before, const Curve& after) {
  const auto n = static_cast<Index>(before.values.size());
  MatrixXd V = (vector_of(before.covariance) + vector_of(after.covariance)).reshaped(n, n);
  std::map<std::string, VectorXd> left;
  for (const Curve::Shared& s : before.common)
    left.try_emplace(s.source, VectorXd::Zero(n)).first->second -= vector_of(s.u);
  for (const Curve::Shared& s : after.common)
    left.try_emplace(s.source, VectorXd::Zero(n)).first->second += vector_of(s.u);
  for (const auto& [source, u] : left) V += u * u.transpose();
  return V;
}

/// In units of each value's own u, so that values of unlike units count alike.
void put_chi2(const VectorXd& d, const MatrixXd& V, CurveDifference& out) {
  constexpr double rank = 1e-9;
  const VectorXd scale = V.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd R = math::scaled_columns(math::scaled_rows(scale, V), scale);
  const math::Spectrum of_R = math::spectrum(R);
  const VectorXd along = math::transposed_times(of_R.vectors, scale.cwiseProduct(d));
  for (Index k = 0; k < along.size(); ++k) {
    const double l = of_R.values(k);
    if (!(l > rank * of_R.values(along.size() - 1))) continue;
    out.chi2 += along(k) * along(k) / l;
    out.dof += 1.0;
  }
  out.p = math::chi2_upper(out.chi2, out.dof);
}

}  // namespace

Expected<Difference> difference(const Point& before, const Point& after, double expected,
                                double u_expected) {
  Series both;
  both.points = {before, after};
  both.points[1].time = both.points[0].time;  // a difference has no order
  if (auto sound = check(both); !sound) return fail(sound.error());
  if (!std::isfinite(expected) || !std::isfinite(u_expected) || u_expected < 0.0)
    return fail("expected a difference and its uncertainty, found what is not a number");
  double variance = before.u * before.u + after.u * after.u + u_expected * u_expected;
  for (const auto& [source, u] : left_of_common(before, after)) variance += u * u;
  Difference out{after.value - before.value - expected, std::sqrt(variance), 1.0};
  out.p = normal_two_sided(out.zeta());
  return out;
}

Expected<Curve> seen_through(const Curve& coefficients,
                             const std::vector<std::vector<double>>& basis) {
  if (auto sound = check_curve(coefficients, "coefficients"); !sound) return fail(sound.error());
  const auto n = static_cast<Index>(coefficients.values.size());
  MatrixXd B(static_cast<Index>(basis.size()), n);
  for (Index i = 0; i < B.rows(); ++i) {
    const std::vector<double>& row = basis[static_cast<std::size_t>(i)];
    if (row.size() != coefficients.values.size())
      return fail("expected a number of each coefficient at place " + std::to_string(i + 1));
    B.row(i) = vector_of(row).transpose();
  }
  const MatrixXd C = math::product_transposed(
      math::product(B, vector_of(coefficients.covariance).reshaped(n, n)), B);
  const VectorXd y = math::times(B, vector_of(coefficients.values));
  Curve out;
  out.values.assign(y.begin(), y.end());
  for (Index i = 0; i < C.rows(); ++i)
    for (Index j = 0; j < C.cols(); ++j) out.covariance.push_back(C(i, j));
  for (const Curve::Shared& s : coefficients.common) {
    const VectorXd u = math::times(B, vector_of(s.u));
    out.common.push_back({s.source, {u.begin(), u.end()}});
  }
  return out;
}

Expected<CurveDifference> difference(const Curve& before, const Curve& after,
                                     const std::vector<double>& expected) {
  if (auto sound = check_curve(before, "before"); !sound) return fail(sound.error());
  if (auto sound = check_curve(after, "after"); !sound) return fail(sound.error());
  if (before.values.size() != after.values.size() ||
      (!expected.empty() && expected.size() != after.values.size()))
    return fail("expected curves of the same places, found another number of them");
  VectorXd d = vector_of(after.values) - vector_of(before.values);
  if (!expected.empty()) d -= vector_of(expected);
  const MatrixXd V = covariance_of_difference(before, after);
  CurveDifference out;
  double most = -1.0;
  for (Index i = 0; i < d.size(); ++i) {
    if (!(V(i, i) > 0.0) || !std::isfinite(d(i)))
      return fail("place " + std::to_string(i + 1) + ": expected an uncertainty above 0");
    out.values.push_back(d(i));
    out.u.push_back(std::sqrt(V(i, i)));
    const double ratio = std::fabs(d(i)) / out.u.back();
    if (ratio > most) most = ratio, out.largest = static_cast<std::size_t>(i);
  }
  out.p_largest = std::min(1.0, static_cast<double>(d.size()) * normal_two_sided(most));
  put_chi2(d, V, out);
  return out;
}

Expected<TableCheck> check_table(const Point& as_found, const Point& as_left, double promised,
                                 double u_promised) {
  NONIO_TRY(const auto compared, difference(as_found, as_left, promised, u_promised));
  TableCheck out{compared};
  out.as_promised = !(compared.p < named_below);
  double variance = as_found.u * as_found.u;
  for (const Common& c : as_found.common) variance += c.u * c.u;
  if (std::fabs(as_found.value) > 2.0 * std::sqrt(variance))
    out.taken = 1.0 - std::fabs(as_left.value) / std::fabs(as_found.value);
  return out;
}

}  // namespace nonio::statistics
