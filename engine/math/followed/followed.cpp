// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/followed.h"

#include <algorithm>
#include <cmath>

#include "common/constants.h"
#include "dense.h"
#include "run_components.h"
#include "target_fit.h"

namespace nonio::math {
namespace {

// largest gap between targets that cover a turn, rad
constexpr double largest_gap = full_turn / 3.0;
/// Largest ratio of the variance of a sinusoid to that with evenly spread phases.
constexpr double most_inflated = 2.0;
constexpr std::size_t fewest_for_curve = 5, fewest_for_sinusoid = 10;

struct Following {
  const AxisTest& test;
  RunComponents components;
  FollowedAxis out{};
  std::vector<TargetWeights> weights{};
  std::vector<double> periods{};
};

void add_followed(Following& work, std::string name, Quantity quantity, TargetWeights weights) {
  Followed f{std::move(name), value_of(work.test, weights), quantity};
  work.out.quantities.push_back(std::move(f));
  work.weights.push_back(std::move(weights));
}

Quantity deviation_along(const AxisTest& test) {
  return test.rotary ? Quantity::angular_deviation : Quantity::deviation;
}

void add_scale(Following& work) {
  const AxisTest& test = work.test;
  const Eigen::VectorXd slope = fit_rows(legendre_columns(test, 2)).row(1) * (2.0 / test.length());
  add_followed(work, "scale", Quantity::deviation_per_length, of_means(test, slope));
}

void add_curve(Following& work) {
  const AxisTest& test = work.test;
  if (test.targets.size() < fewest_for_curve) return;
  const Eigen::MatrixXd curve = fit_rows(legendre_columns(test, 4));
  add_followed(work, "curve_2", deviation_along(test), of_means(test, curve.row(2)));
  add_followed(work, "curve_3", deviation_along(test), of_means(test, curve.row(3)));
}

/// `others`: columns that are fitted together with the sinusoid.
void add_sinusoid(Following& work, const std::string& name, double period,
                  const Eigen::MatrixXd& others) {
  const AxisTest& test = work.test;
  const auto targets = static_cast<double>(test.targets.size());
  if (test.targets.size() < fewest_for_sinusoid || test.length() < period / 2.0) return;
  const Eigen::MatrixXd X = with_sinusoid(others, test, period);
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(X);
  if (qr.rank() < X.cols()) return;
  const Eigen::MatrixXd rows = fit_rows(X).bottomRows(2);
  for (int c = 0; c < 2; ++c)
    if (rows.row(c).squaredNorm() > most_inflated * 2.0 / targets) return;
  add_followed(work, name + "_cos", deviation_along(test), of_means(test, rows.row(0)));
  add_followed(work, name + "_sin", deviation_along(test), of_means(test, rows.row(1)));
  work.periods.push_back(period);
}

bool covers_a_turn(const AxisTest& test) {
  if (full_turn - test.length() > largest_gap) return false;
  for (std::size_t i = 1; i < test.targets.size(); ++i)
    if (test.targets[i] - test.targets[i - 1] > largest_gap) return false;
  return true;
}

std::optional<double> drive_period(const Axis* axis, bool rotary) {
  if (axis == nullptr) return {};
  if (!rotary) return axis->screw_pitch;
  return axis->teeth ? std::optional(full_turn / *axis->teeth) : std::nullopt;
}

void add_shapes(Following& work, const Axis* axis, Across across) {
  const AxisTest& test = work.test;
  const bool turn = test.rotary && covers_a_turn(test);
  const Eigen::MatrixXd others = turn ? legendre_columns(test, 1) : legendre_columns(test, 4);
  if (turn) add_sinusoid(work, "turn", full_turn, others);
  // the slope of deviations across the axis is an error of the set-up
  if (!test.rotary && across == Across::no) add_scale(work);
  if (!test.rotary) add_curve(work);
  const auto period = drive_period(axis, test.rotary);
  if (period && *period > 0.0) add_sinusoid(work, "cyclic", *period, others);
}

void put_uncertainties(Following& work) {
  const std::size_t n = work.weights.size();
  const auto& C = work.out.covariance = covariance_of(work.test, work.components, work.weights);
  for (std::size_t i = 0; i < n; ++i) work.out.quantities[i].u = std::sqrt(C[i * n + i]);
}

void put_other_targets(Following& work) {
  OtherTargets to;
  for (const Followed& f : work.out.quantities) to.of_readings.push_back(f.u * f.u);
  for (std::size_t i = 0; i < work.weights.size(); ++i)
    to.share.push_back(
        share_of_targets(work.test, work.weights[i], work.out.quantities[i].name == "B_mean"));
  to.mean = fit_means(work.test, work.components, work.periods);
  if (work.test.bidirectional()) to.reversal = fit_reversal(work.test, work.components);
  work.out.other_targets = std::move(to);
}

void of_the_scale(Following& work, const Campaign& c, const std::string& name,
                  std::optional<double> material) {
  auto& all = work.out.quantities;
  const auto found =
      std::find_if(all.begin(), all.end(), [](const Followed& f) { return f.name == "scale"; });
  if (found == all.end()) return;
  const auto stated = [&](const std::optional<double>& value, const std::string& key) {
    if (value && std::isfinite(*value)) return *value;
    work.out.not_stated.push_back(key);
    return 0.0;
  };
  const Environment& e = c.environment;
  const Axis* axis = c.machine.axis(name);
  const double L = work.test.length(),
               alpha = stated(axis != nullptr ? axis->expansion : std::nullopt,
                              "machine.axes." + name + ".expansion_um_per_m_K");
  const double beam = stated(e.misalignment, "environment.misalignment_mm"),
               sensor = stated(e.temperature_range, "environment.temperature_range_K"),
               range = stated(e.expansion_range, "environment.expansion_range_um_per_m_K");
  found->of_instrument = stated(c.instrument.U_per_length, "instrument.U_per_m_um") / 2.0;
  double square = std::pow(of_limit * beam * beam / (2.0 * L * L), 2) +
                  std::pow(of_full_range * sensor * alpha, 2);
  const double each_kelvin = of_full_range * range;
  if (material)
    found->of_expansion = each_kelvin * (*material - 20.0);
  else
    square += std::pow(
        each_kelvin * stated(e.temperature_difference, "environment.temperature_difference_K"), 2);
  const std::size_t n = all.size(), i = static_cast<std::size_t>(found - all.begin());
  work.out.covariance[i * n + i] += square;
  found->u = std::sqrt(work.out.covariance[i * n + i]);
}

void add_scatter(Following& work) {
  const PooledScatter scatter = pooled_scatter(work.test, work.components);
  if (!(scatter.s > rounding) || !(scatter.u_ln > 0.0)) return;
  const std::size_t n = work.out.quantities.size();
  std::vector<double> larger((n + 1) * (n + 1), 0.0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) larger[i * (n + 1) + j] = work.out.covariance[i * n + j];
  larger.back() = scatter.u_ln * scatter.u_ln;
  work.out.covariance = std::move(larger);
  work.out.quantities.push_back({"ln_s",
                                 std::log(scatter.s * unit_of(deviation_along(work.test)).per_si),
                                 Quantity::number, scatter.u_ln});
}

}  // namespace

FollowedAxis followed_quantities(const AxisTest& test, const Campaign& campaign,
                                 const std::string& axis, std::optional<double> material,
                                 Across across) {
  if (test.targets.size() < 3 || test.most_approaches() < 2) return {};
  Following work{test, run_components(test)};
  const bool scatters =
      std::any_of(std::begin(work.components.reading), std::end(work.components.reading),
                  [](double v) { return v > 0.0; });
  if (work.components.runs < 2.0 || !scatters) return {};
  add_shapes(work, campaign.machine.axis(axis), across);
  if (test.bidirectional()) add_followed(work, "B_mean", deviation_along(test), of_reversal(test));
  put_uncertainties(work);
  put_other_targets(work);
  if (across == Across::no) of_the_scale(work, campaign, axis, material);
  add_scatter(work);
  return std::move(work.out);
}

}  // namespace nonio::math
