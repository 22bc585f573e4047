// SPDX-License-Identifier: Apache-2.0
#include "nonio/model/prediction.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "course.h"
#include "course_noise.h"
#include "nonio/sdk/channels.h"

namespace nonio::model {

namespace {

Expected<MatrixXd> columns_in(const Part& part, const std::vector<Term>& terms) {
  MatrixXd out(static_cast<Index>(part.table.size()), 0);
  for (const Term& term : terms) {
    const auto columns = term.effect->columns(part.table, term.axis, term.shape);
    if (!columns) return fail(columns.error());
    for (const auto& column : *columns) {
      out.conservativeResize(Eigen::NoChange, out.cols() + 1);
      out.col(out.cols() - 1) =
          Eigen::Map<const VectorXd>(column.data(), static_cast<Index>(column.size()));
    }
  }
  return out;
}

void centre(MatrixXd& columns) {
  for (Index k = 0; k < columns.cols(); ++k) columns.col(k).array() -= columns.col(k).mean();
}

/// Start of the first window (a twentieth, at least 10 readings) with an RMS error above 2 u.
std::optional<double> fails_from(const std::vector<double>& time, const Prediction& p) {
  const std::size_t n = time.size(), window = std::max<std::size_t>(10, n / 20);
  for (std::size_t from = 0; from + window <= n; from += window) {
    double squares = 0.0;
    for (std::size_t i = from; i < from + window; ++i)
      squares += p.error[i] * p.error[i] / (p.u[i] * p.u[i]);
    if (squares > 4.0 * static_cast<double>(window)) return time[from];
  }
  return std::nullopt;
}

bool leaves_range(const Part& seen, const Part& unseen) {
  for (const auto& c : unseen.table.channels) {
    const auto* known = seen.table.channel(c.name);
    if (known == nullptr) continue;
    const auto in = [](const Part& part, const Observations::Channel& channel) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (std::size_t i = 0; i < channel.time.size(); ++i)
        if (channel.time[i] >= part.table.time.front() && channel.time[i] <= part.table.time.back())
          low = std::min(low, channel.value[i]), high = std::max(high, channel.value[i]);
      return std::pair(low, high);
    };
    const auto [low, high] = in(seen, *known);
    const auto [least, most] = in(unseen, c);
    constexpr double margin = 0.1;
    if (least < low - margin * (high - low) || most > high + margin * (high - low)) return true;
  }
  return false;
}

}  // namespace

Expected<Prediction> predict(const Part& seen, const std::vector<Term>& model, const Part& unseen,
                             bool zero_kept) {
  const auto fit = fit_course(seen, model);
  if (!fit) return fail(fit.error());
  const auto known = columns_in(seen, fit->terms), other = columns_in(unseen, fit->terms);
  if (!known) return fail(known.error());
  if (!other) return fail(other.error());
  const CourseData data(seen);
  MatrixXd means(data.size(), known->cols());
  for (Index k = 0; k < known->cols(); ++k)
    means.col(k) = data.means(std::vector<double>(known->col(k).begin(), known->col(k).end()));
  CourseModel columns{means};
  for (const Parameter& p : fit->parameters)
    if (!p.shape) columns.of.push_back(p.quantity);
  const CourseUncertainty unknown = uncertainty_of(data, columns);
  Prediction out;
  VectorXd x(known->cols());
  Index at = 0;
  for (const Parameter& p : fit->parameters)
    if (!p.shape) x(at++) = p.value;
  VectorXd error = Eigen::Map<const VectorXd>(unseen.table.deviation.data(),
                                              static_cast<Index>(unseen.table.size()));
  const double mean = error.mean();
  out.sd = std::sqrt((error.array() - mean).square().mean());
  error -= *other * x;
  MatrixXd from = *other;
  if (!zero_kept) {
    error.array() -= error.mean();
    centre(from);
  } else {
    error.array() -= fit->zero.front();
    from.rowwise() -= means.colwise().mean();
  }
  const double variance = unknown.s * unknown.s + (zero_kept ? unknown.zero * unknown.zero : 0.0);
  const MatrixXd spread = math::product(from, unknown.covariance);
  std::size_t inside = 0;
  for (Index i = 0; i < error.size(); ++i) {
    out.error.push_back(error(i));
    out.u.push_back(std::sqrt(variance + spread.row(i).dot(from.row(i))));
    if (std::fabs(error(i)) <= 2.0 * out.u.back()) ++inside;
  }
  out.rms = std::sqrt(error.squaredNorm() / static_cast<double>(error.size()));
  out.inside = static_cast<double>(inside) / static_cast<double>(error.size());
  out.fails_from = fails_from(unseen.table.time, out);
  out.outside = leaves_range(seen, unseen);
  return out;
}

}  // namespace nonio::model
