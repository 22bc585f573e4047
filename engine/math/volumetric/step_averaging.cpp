// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "nonio/math/distributions.h"
#include "step_estimate.h"

namespace nonio::math {
namespace {

using Index = Eigen::Index;

/// A move of an axis over one interval. The reading before the first move is the zero of the pass.
struct Increment {
  std::size_t pass = 0, after = 0;  ///< after: number of moves up to and including this one
};

/// Returns the move of `axis` over interval i (from position i to i + 1) in a pass.
Increment increment(const StepDiagonals& d, std::size_t pass, std::size_t axis, std::size_t i) {
  const std::size_t place =
      static_cast<std::size_t>(std::find(d.order.begin(), d.order.end(), axis) - d.order.begin());
  const std::size_t cycle = d.passes[pass].sign[axis] > 0 ? i : d.n - 1 - i;
  return {pass, 3 * cycle + place + 1};
}

double read(const StepDiagonals& d, std::size_t pass, std::size_t moves) {
  return moves == 0 ? 0.0 : d.passes[pass].reading[moves - 1];
}

double size_of(const StepDiagonals& d, const Increment& r) {
  return read(d, r.pass, r.after) - read(d, r.pass, r.after - 1);
}

std::size_t line_of(const StepDiagonals::Pass& p) {
  return (p.sign[0] * p.sign[1] > 0 ? 0U : 1U) + (p.sign[0] * p.sign[2] > 0 ? 0U : 2U);
}

std::array<double, 4> shares(const StepDiagonals& d) {
  std::array<double, 4> count{}, share{};
  for (const auto& p : d.passes) ++count[line_of(p)];
  for (std::size_t k = 0; k < 4; ++k) share[k] = count[k] > 0 ? 1.0 / count[k] : NAN;
  return share;
}

/// From the readings of all passes, each with its zero first, to the function values.
Eigen::MatrixXd averaging(const StepDiagonals& d) {
  const std::size_t each = 3 * d.n + 1;
  const auto share = shares(d);
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(static_cast<Index>(9 * d.n),
                                            static_cast<Index>(each * d.passes.size()));
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t along = 0; along < 3; ++along)
      for (std::size_t i = 0; i < d.n; ++i) {
        const auto row = static_cast<Index>(function_column(axis, along, i + 1, d.n));
        if (i > 0) W.row(row) = W.row(row - 1);
        for (std::size_t k = 0; k < d.passes.size(); ++k) {
          const auto& pass = d.passes[k];
          const double c = share[line_of(pass)] * pass.sign[axis] * pass.sign[along] *
                           d.diagonal() / (4.0 * d.travel[along]);
          const auto column = static_cast<Index>(k * each + increment(d, k, axis, i).after);
          W(row, column) += c;
          W(row, column - 1) -= c;
        }
      }
  return W;
}

/// Corrects the slopes of two straightnesses that share a plane: the totals of the diagonals
/// determine their sum, whatever the set-up, and their difference is a rotation of the frame.
///   sigma_pq = L / (4 T_p T_q) sum of e_p e_q D;   E_qp (far end) = 0, E_pq (far end) = sigma T_q
void slopes_from_totals(const StepDiagonals& d, std::size_t p, std::size_t q, Eigen::MatrixXd& W) {
  const std::size_t each = 3 * d.n + 1;
  const auto share = shares(d);
  Eigen::RowVectorXd end = Eigen::RowVectorXd::Zero(W.cols());
  for (std::size_t k = 0; k < d.passes.size(); ++k) {
    const auto& pass = d.passes[k];
    const double c =
        share[line_of(pass)] * pass.sign[p] * pass.sign[q] * d.diagonal() / (4.0 * d.travel[p]);
    end[static_cast<Index>(k * each)] -= c;
    end[static_cast<Index>(k * each + each - 1)] += c;
  }
  const auto tilt = [&](std::size_t axis, std::size_t along, const Eigen::RowVectorXd& far) {
    const Eigen::RowVectorXd by =
        far - W.row(static_cast<Index>(function_column(axis, along, d.n, d.n)));
    for (std::size_t i = 1; i <= d.n; ++i)
      W.row(static_cast<Index>(function_column(axis, along, i, d.n))) +=
          by * (static_cast<double>(i) / static_cast<double>(d.n));
  };
  tilt(p, q, Eigen::RowVectorXd::Zero(W.cols()));
  tilt(q, p, end);
}

/// Returns the check sums of each axis in the order of its intervals; NaN if a reading is missing.
std::array<std::vector<double>, 3> check_sums(const StepDiagonals& d) {
  const auto share = shares(d);
  std::array<std::vector<double>, 3> sums;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t i = 0; i < d.n; ++i) {
      double sum = 0.0;
      for (std::size_t k = 0; k < d.passes.size(); ++k) {
        const auto& s = d.passes[k].sign;
        sum += share[line_of(d.passes[k])] * s[(axis + 1) % 3] * s[(axis + 2) % 3] *
               size_of(d, increment(d, k, axis, i));
      }
      sums[axis].push_back(sum);
    }
  return sums;
}

/// Returns the ratio of the variance of a check sum to that of a reading.
double check_gain(const StepDiagonals& d) {
  double sum = 0.0;
  for (const double share : shares(d)) sum += 2.0 * share;
  return sum;
}

/// Sums for lines through the check sums of each axis, with a common slope.
struct LineThrough {
  std::array<double, 3> mean{}, centre{}, count{};
  double slope = 0.0, sxx = 0.0, rest = 0.0, total = 0.0;
};

template <class Take>
void each_sum(const std::array<std::vector<double>, 3>& sums, const Take& take) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t i = 0; i < sums[axis].size(); ++i)
      if (std::isfinite(sums[axis][i])) take(axis, static_cast<double>(i), sums[axis][i]);
}

LineThrough line_through(const std::array<std::vector<double>, 3>& sums) {
  LineThrough l;
  each_sum(sums, [&](std::size_t a, double i, double y) {
    l.count[a] += 1.0;
    l.total += 1.0;
    l.mean[a] += y;
    l.centre[a] += i;
  });
  for (std::size_t a = 0; a < 3; ++a)
    if (l.count[a] > 0.0) {
      l.mean[a] /= l.count[a];
      l.centre[a] /= l.count[a];
    }
  double sxy = 0.0;
  each_sum(sums, [&](std::size_t a, double i, double y) {
    l.sxx += (i - l.centre[a]) * (i - l.centre[a]);
    sxy += (i - l.centre[a]) * (y - l.mean[a]);
  });
  if (l.sxx > 0.0) l.slope = sxy / l.sxx;
  each_sum(sums, [&](std::size_t a, double i, double y) {
    const double e = y - l.mean[a] - l.slope * (i - l.centre[a]);
    l.rest += e * e;
  });
  return l;
}

}  // namespace

std::optional<Estimated> close_lengths(const StepDiagonals& d,
                                       const std::vector<AxisSeries>& series, double u) {
  const auto share = shares(d);
  Estimated sum;
  double variance = 0.0;
  for (std::size_t k = 0; k < d.passes.size(); ++k)
    sum.value += share[line_of(d.passes[k])] / 4.0 * d.passes[k].reading.back();
  for (const double s : share) variance += 2.0 * u * u * s / 16.0;
  std::array<bool, 3> used{};
  for (const AxisSeries& s : series) {
    if (s.position.size() < 2 || used[s.axis]) continue;
    const double first = s.position.front(), last = s.position.back();
    if (!(last - first > 0.9 * d.travel[s.axis])) continue;
    const double part = d.travel[s.axis] / d.diagonal(),
                 stretch = d.travel[s.axis] / (last - first);
    sum.value -= part * stretch * (s.deviation.back() - s.deviation.front());
    variance += 2.0 * std::pow(part * stretch * (s.u > 0.0 ? s.u : u), 2);
    used[s.axis] = true;
  }
  sum.u = std::sqrt(variance);
  if (!used[0] || !used[1] || !used[2] || !std::isfinite(sum.value)) return std::nullopt;
  return sum;
}

StepChecks check_step_diagonals(const StepDiagonals& d) {
  const LineThrough l = line_through(check_sums(d));
  StepChecks c;
  c.count = static_cast<std::size_t>(l.total);
  const double dof = l.total - 4.0;
  if (!(dof > 0.0)) return c;
  const double s = std::sqrt(l.rest / dof);
  c.u_reading = s / std::sqrt(check_gain(d));
  c.constant = l.mean;
  c.trend = l.slope;
  if (!(s > 0.0)) return c;
  for (std::size_t a = 0; a < 3; ++a)
    if (l.count[a] > 0.0)
      c.p_constant =
          std::min(c.p_constant, 3.0 * t_two_sided(l.mean[a] * std::sqrt(l.count[a]) / s, dof));
  c.p_trend = t_two_sided(l.slope * std::sqrt(l.sxx) / s, dof);
  return c;
}

Expected<StepSolution> average_step_diagonals(const StepDiagonals& d, const StepChoices& choices,
                                              const ReadingModel* model) {
  for (const double share : shares(d))
    if (!std::isfinite(share)) return fail("expected the four body diagonals, found fewer");
  const std::size_t each = 3 * d.n + 1;
  Eigen::VectorXd readings(static_cast<Index>(each * d.passes.size()));
  for (std::size_t k = 0; k < d.passes.size(); ++k)
    for (std::size_t t = 0; t < each; ++t)
      readings[static_cast<Index>(k * each + t)] = read(d, k, t);
  if (!readings.allFinite())
    return fail("averaging needs every reading; expected " +
                std::to_string(3 * d.n * d.passes.size()) + ", some are missing");
  StepSolution out;
  const StepChecks checks = check_step_diagonals(d);
  out.u_reading = choices.u_reading > 0.0 ? choices.u_reading : checks.u_reading;
  out.dof = static_cast<double>(checks.count) - 4.0;
  out.unknowns = out.rank = 9 * d.n;
  Eigen::MatrixXd W = averaging(d);
  slopes_from_totals(d, 0, 1, W);
  slopes_from_totals(d, 0, 2, W);
  slopes_from_totals(d, 1, 2, W);
  const bool known = choices.set_up_known;
  if (model != nullptr && model->readings() != each * d.passes.size())
    return fail("expected a model of the readings of all passes");
  present(d, W * readings, out.u_reading * out.u_reading * (W * W.transpose()), {model, W},
          {known, known, known}, out);
  return out;
}

}  // namespace nonio::math
