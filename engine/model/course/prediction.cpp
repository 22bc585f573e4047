// SPDX-License-Identifier: Apache-2.0
#include "nonio/model/prediction.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include "course.h"
#include "course_noise.h"
#include "nonio/math/distributions.h"
#include "nonio/sdk/channels.h"

namespace nonio::model {

namespace {

/// Columns of the coefficients, and of changes of the searched shapes, for each reading.
struct Linearised {
  MatrixXd columns, of_shapes;
};

void append(MatrixXd& to, const VectorXd& column) {
  to.conservativeResize(column.size(), to.cols() + 1);
  to.col(to.cols() - 1) = column;
}

Expected<Linearised> columns_in(const Part& part, const Fit& fit) {
  const auto n = static_cast<Index>(part.table.size());
  Linearised out{MatrixXd(n, 0), MatrixXd(n, 0)};
  auto parameter = fit.parameters.begin();
  for (const Term& term : fit.terms) {
    NONIO_TRY(const auto columns, term.effect->columns(part.table, term.axis, term.shape));
    VectorXd predicted = VectorXd::Zero(n);
    std::vector<double> coefficients;
    for (const auto& column : columns) {
      const VectorXd one = Eigen::Map<const VectorXd>(column.data(), n);
      append(out.columns, one);
      coefficients.push_back(parameter->value);
      predicted += parameter++->value * one;
    }
    for (std::size_t s = 0; s < term.shape.size(); ++s, ++parameter) {
      if (!(parameter->u > 0.0)) continue;  // given or discrete
      // A secant over the uncertainty, as a time constant cannot be negative.
      std::vector<double> shape = term.shape;
      shape[s] += parameter->u;
      NONIO_TRY(const auto other, term.effect->columns(part.table, term.axis, shape));
      VectorXd change = -predicted;
      for (std::size_t k = 0; k < other.size(); ++k)
        change += coefficients[k] * Eigen::Map<const VectorXd>(other[k].data(), n);
      append(out.of_shapes, change / parameter->u);
    }
  }
  return out;
}

/// Factor of the variance of readings with exponential correlation, minus their mean: for each time.
std::vector<double> about_mean(const std::vector<double>& time, double correlation_time) {
  const double duration = time.back() - time.front();
  std::vector<double> with_mean(time.size(), 0.0);  // correlation of a reading with the mean
  if (correlation_time > 0.0 && duration > 0.0)
    for (std::size_t i = 0; i < time.size(); ++i)
      with_mean[i] = correlation_time / duration *
                     (2.0 - std::exp((time.front() - time[i]) / correlation_time) -
                      std::exp((time[i] - time.back()) / correlation_time));
  double of_mean = 0.0;
  for (const double c : with_mean) of_mean += c / static_cast<double>(time.size());
  for (double& c : with_mean) c = std::max(0.0, 1.0 - 2.0 * c + of_mean);
  return with_mean;
}

/// Subtracts from readings, and from columns of the model, their means in each line of `part`, but
/// on the first line the values at the zero of the fit if that is kept. Returns the factor of the
/// variance of the correlated part for each reading.
std::vector<double> with_zeros(const Part& part, VectorXd& readings, MatrixXd& columns,
                               const std::optional<std::pair<double, Eigen::RowVectorXd>>& kept,
                               double correlation_time) {
  std::vector<double> share;
  const std::vector<double>& time = part.table.time;
  for (std::size_t from = 0; from < time.size();) {
    std::size_t to = from + 1;
    while (to < time.size() && part.table.line_of(to) == part.table.line_of(from)) ++to;
    const auto first = static_cast<Index>(from), count = static_cast<Index>(to - from);
    auto own = readings.segment(first, count);
    auto of_own = columns.middleRows(first, count);
    if (kept && from == 0) {
      own.array() -= kept->first;
      of_own.rowwise() -= kept->second;
      share.assign(to, 1.0);
    } else {
      own.array() -= own.mean();
      of_own.rowwise() -= of_own.colwise().mean().eval();
      const auto begin = time.begin();
      const std::vector<double> factor = about_mean(
          {begin + static_cast<std::ptrdiff_t>(from), begin + static_cast<std::ptrdiff_t>(to)},
          correlation_time);
      share.insert(share.end(), factor.begin(), factor.end());
    }
    from = to;
  }
  return share;
}

/// Finds where the errors exceed their uncertainty to the end, or from the beginning as those of a
/// start do: windows (a twentieth, at least 10 readings) with an RMS above 2 u. Of all ways to
/// divide the readings into a part where the model holds, with a zero of its own, and one where it
/// does not, that is taken in which the errors of the one and the length of the other are least.
void find_failure(const std::vector<double>& time, bool zero_kept, Prediction& p) {
  const std::size_t n = time.size(), window = std::max<std::size_t>(10, n / 20), count = n / window;
  constexpr double above = 4.0;  // (2 u)^2
  if (count < 2) return;
  // Sums of squares in units of u about any zero, up to each window.
  struct Sums {
    double w = 0.0, we = 0.0, wee = 0.0;
  };
  std::vector<Sums> up_to(count + 1);
  for (std::size_t k = 0; k < count; ++k) {
    Sums s = up_to[k];
    for (std::size_t i = k * window; i < (k + 1 == count ? n : (k + 1) * window); ++i) {
      const double w = 1.0 / (p.u[i] * p.u[i]);
      s.w += w, s.we += w * p.error[i], s.wee += w * p.error[i] * p.error[i];
    }
    up_to[k + 1] = s;
  }
  const auto holds = [&](std::size_t from, std::size_t to) {
    const double w = up_to[to].w - up_to[from].w, we = up_to[to].we - up_to[from].we,
                 wee = up_to[to].wee - up_to[from].wee;
    return zero_kept || !(w > 0.0) ? wee : wee - we * we / w;
  };
  const double failing = above * static_cast<double>(window);  // a window where it does not hold
  // A few readings with large errors are no part in which the model fails: docs/dev/constants.md, M73.
  const auto outside = [&](std::size_t begin, std::size_t end) {
    std::size_t many = 0;
    for (std::size_t i = begin; i < end; ++i) many += std::fabs(p.error[i]) > 2.0 * p.u[i] ? 1 : 0;
    return 4 * many > end - begin;
  };
  // At least two windows: in one of 20 the limit is exceeded by chance.
  double least = holds(0, count) - failing;
  std::size_t from = count, until = 0;
  for (std::size_t k = 0; k + 2 <= count; ++k)
    if (const double cost = holds(0, k) + static_cast<double>(count - k) * failing; cost < least)
      least = cost, from = k;
  if (from < count) least -= failing;
  for (std::size_t k = 2; k < count; ++k)
    if (const double cost = holds(k, count) + static_cast<double>(k) * failing; cost < least)
      least = cost, until = k;
  if (until > 0) {
    if (outside(0, until * window)) p.fails_until = time[until * window];
  } else if (from < count && outside(from * window, n)) {
    p.fails_from = time[from * window];
  }
}

/// The part with each channel related to its largest value in `seen`, as the parameters are.
Part related(Part unseen, const Part& seen) {
  for (auto& channel : unseen.table.channels) {
    const auto* known = seen.table.channel(channel.name);
    if (known == nullptr || known->value.empty()) continue;
    double largest = 0.0;
    for (const double v : known->value) largest = std::max(largest, std::fabs(v));
    channel.largest = largest;
  }
  return unseen;
}

/// Whether a channel of the model leaves the values that it had while the model was fitted.
bool leaves_range(const Part& seen, const std::vector<Term>& model, const Part& unseen) {
  std::set<std::string> used;
  for (const Term& term : model)
    for (const std::string& name : channels_of(term, seen.table)) used.insert(name);
  for (const auto& c : unseen.table.channels) {
    const auto* known = seen.table.channel(c.name);
    if (known == nullptr || !used.contains(c.name)) continue;
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

/// Errors, and u from the scatter and the parameters, of readings that were not used.
Expected<Prediction> applied(const Part& seen, const std::vector<Term>& model, const Part& unseen,
                             bool zero_kept) {
  NONIO_TRY(const auto fit, fit_course(seen, model));
  const auto known = columns_in(seen, fit), other = columns_in(unseen, fit);
  if (!known) return fail(known.error());
  if (!other) return fail(other.error());
  const CourseData data(seen);
  const auto means = [&](const MatrixXd& columns) {
    MatrixXd out(data.size(), columns.cols());
    for (Index k = 0; k < columns.cols(); ++k)
      out.col(k) = data.means(std::vector<double>(columns.col(k).begin(), columns.col(k).end()));
    return out;
  };
  CourseModel columns{means(known->columns)};
  for (const Parameter& p : fit.parameters)
    if (!p.shape) columns.of.push_back(p.quantity);
  columns.add(means(known->of_shapes), {Quantity::time});
  const CourseUncertainty unknown = uncertainty_of(data, columns);
  Prediction out;
  VectorXd x(known->columns.cols());
  Index at = 0;
  for (const Parameter& p : fit.parameters)
    if (!p.shape) x(at++) = p.value;
  VectorXd error = Eigen::Map<const VectorXd>(unseen.table.deviation.data(),
                                              static_cast<Index>(unseen.table.size()));
  std::vector<double> readings = unseen.table.deviation;
  without_zeros(readings, unseen.table);
  for (const double r : readings) out.sd += r * r / static_cast<double>(readings.size());
  out.sd = std::sqrt(out.sd);
  error -= other->columns * x;
  MatrixXd from(error.size(), columns.columns.cols());
  from << other->columns, other->of_shapes;
  std::optional<std::pair<double, Eigen::RowVectorXd>> kept;
  if (zero_kept)
    kept.emplace(fit.zero.back(),
                 columns.columns.bottomRows(data.size() - data.lines().back()).colwise().mean());
  const std::vector<double> share = with_zeros(unseen, error, from, kept, unknown.correlation_time);
  const auto floor = floor_of(fit.residual);
  // Of one reading, which is more than that of a mean of several.
  const double correlated = unknown.correlated * unknown.correlated,
               scatter =
                   std::max(unknown.s * unknown.s - correlated, floor ? floor->s * floor->s : 0.0),
               zero = unknown.zero * unknown.zero;
  const MatrixXd spread = math::product(from, unknown.covariance);
  for (Index i = 0; i < error.size(); ++i) {
    out.error.push_back(error(i));
    const bool kept_zero =
        kept && unseen.table.line_of(static_cast<std::size_t>(i)) == unseen.table.line_of(0);
    out.u.push_back(std::sqrt(correlated * share[static_cast<std::size_t>(i)] + scatter +
                              (kept_zero ? zero : 0.0) + spread.row(i).dot(from.row(i))));
  }
  out.rms = std::sqrt(error.squaredNorm() / static_cast<double>(error.size()));
  return out;
}

Part with_rows(const Part& part, const std::vector<char>& kept) {
  Part out = part;
  keep_rows(out.table, kept);
  for (auto& companion : out.companions) {
    std::size_t to = 0;
    for (std::size_t i = 0; i < kept.size(); ++i)
      if (kept[i] != 0) companion[to++] = companion[i];
    companion.resize(to);
  }
  return out;
}

/// Ratio of the errors to u of rows from `from` to `to`, predicted from the others; 0 if the others
/// do not determine the model.
double ratio(const Part& seen, const std::vector<Term>& model, std::size_t from, std::size_t to) {
  constexpr std::size_t enough = 6000;  // rows: eight for each mean value of the fit
  const std::size_t n = seen.table.size(), step = (n + enough - 1) / enough;
  std::vector<char> inside(n, 0), others(n, 0);
  for (std::size_t i = 0; i < n; i += step) (i >= from && i < to ? inside : others)[i] = 1;
  if (std::count(inside.begin(), inside.end(), 1) < 2) return 0.0;
  const auto one = applied(with_rows(seen, others), model, with_rows(seen, inside), false);
  if (!one) return 0.0;
  double errors = 0.0, expected = 0.0;
  for (std::size_t i = 0; i < one->error.size(); ++i)
    errors += one->error[i] * one->error[i], expected += one->u[i] * one->u[i];
  return expected > 0.0 ? std::sqrt(errors / expected) : 0.0;
}

/// Ratio of the errors to u where parts of the time are predicted from the others, at least 1: by as
/// much a model that does not hold everywhere makes u too small (Birge 1932). Root mean square over
/// blocks, or over the two ends, whichever is larger: the use of a model is mostly extrapolation. As
/// it comes from so few parts, it is enlarged by Student's factor for that number (GUM G.3).
double error_over_u(const Part& seen, const std::vector<Term>& model) {
  const std::size_t n = seen.table.size();
  double blocks = 0.0;
  for (std::size_t b = 0; b < CourseData::blocks; ++b) {
    const double one =
        ratio(seen, model, n * b / CourseData::blocks, n * (b + 1) / CourseData::blocks);
    blocks += one * one / static_cast<double>(CourseData::blocks);
  }
  const double first = ratio(seen, model, 0, n * 2 / 5), last = ratio(seen, model, n * 3 / 5, n);
  const double found = std::max(std::sqrt(blocks), std::sqrt((first * first + last * last) / 2.0));
  constexpr auto parts = static_cast<double>(CourseData::blocks + 2);
  return std::max(1.0, 0.5 * math::coverage_factor(parts) * found);
}

}  // namespace

Expected<Prediction> predict(const Part& seen, const std::vector<Term>& model, const Part& unseen,
                             bool zero_kept) {
  auto out = applied(seen, model, related(unseen, seen), zero_kept);
  if (!out) return out;
  const double factor = error_over_u(seen, model);
  std::size_t inside = 0;
  for (std::size_t i = 0; i < out->u.size(); ++i) {
    out->u[i] *= factor;
    if (std::fabs(out->error[i]) <= 2.0 * out->u[i]) ++inside;
  }
  out->inside = static_cast<double>(inside) / static_cast<double>(out->u.size());
  find_failure(unseen.table.time, zero_kept, *out);
  out->outside = leaves_range(seen, model, unseen);
  return out;
}

}  // namespace nonio::model
