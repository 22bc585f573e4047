// SPDX-License-Identifier: Apache-2.0
#include "course.h"

#include <algorithm>
#include <cmath>

#include "course_data.h"
#include "nonio/math/distributions.h"
#include "nonio/sdk/channels.h"

namespace nonio::model {

std::vector<double> without_zeros(std::vector<double>& readings, const Observations& table) {
  std::vector<double> zero(std::max<std::size_t>(table.lines.size(), 1), 0.0),
      count(zero.size(), 0.0);
  for (std::size_t i = 0; i < readings.size(); ++i)
    zero[table.line_of(i)] += readings[i], count[table.line_of(i)] += 1.0;
  for (std::size_t k = 0; k < zero.size(); ++k) zero[k] /= std::max(count[k], 1.0);
  for (std::size_t i = 0; i < readings.size(); ++i) readings[i] -= zero[table.line_of(i)];
  return zero;
}

std::optional<NoiseFloor> floor_of(const std::vector<double>& residual) {
  if (residual.size() < 20) return std::nullopt;
  std::vector<double> d;
  for (std::size_t i = 1; i + 1 < residual.size(); ++i)
    d.push_back(std::fabs(residual[i - 1] - 2.0 * residual[i] + residual[i + 1]));
  const auto middle = d.begin() + static_cast<std::ptrdiff_t>(d.size() / 2);
  std::nth_element(d.begin(), middle, d.end());
  constexpr double of_normal = 0.674490;  // median of |x| for a standard normal x
  NoiseFloor out;
  out.s = *middle / of_normal / std::sqrt(6.0);
  out.dof = static_cast<double>(d.size()) / 3.0;
  out.u = out.s / std::sqrt(2.0 * out.dof);
  return out;
}

namespace {

/// F-test between classes. `fewer`: number of readings per independent reading.
std::optional<Place> place_of(Where where, const std::vector<double>& residual,
                              const std::vector<std::size_t>& classes, std::size_t count,
                              double fewer) {
  std::vector<double> sum(count, 0.0), number(count, 0.0);
  double squares = 0.0, mean = 0.0;
  for (const double r : residual) mean += r / static_cast<double>(residual.size());
  for (std::size_t i = 0; i < residual.size(); ++i) {
    sum[classes[i]] += residual[i] - mean;
    number[classes[i]] += 1.0;
    squares += (residual[i] - mean) * (residual[i] - mean);
  }
  double between = 0.0, used = 0.0, largest = 0.0;
  std::size_t largest_class = 0;
  for (std::size_t c = 0; c < count; ++c) {
    if (!(number[c] > 0.0)) continue;
    used += 1.0;
    between += sum[c] * sum[c] / number[c];
    if (std::fabs(sum[c] / number[c]) > largest)
      largest = std::fabs(sum[c] / number[c]), largest_class = c;
  }
  const double free_readings = static_cast<double>(residual.size()) / fewer;
  if (used < 2.0 || !(squares > 0.0) || !(free_readings > used + 1.0)) return std::nullopt;
  const double dof = used - 1.0, rest = free_readings - used;
  const double F = between / dof / ((squares - between) / rest);
  Place place;
  place.where = where;
  place.p = math::f_upper(F, dof, rest);
  place.share = std::max(0.0, (between - dof * (squares - between) / rest) / squares);
  place.rms = std::sqrt(place.share * squares / static_cast<double>(residual.size()));
  place.at = static_cast<double>(largest_class);  // index of the class with the largest |mean|
  return place;
}

std::vector<std::size_t> classes_of(const std::vector<double>& values, std::size_t count,
                                    double& low, double& width) {
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  low = *least;
  width = (*most - *least) / static_cast<double>(count);
  std::vector<std::size_t> out;
  for (const double v : values)
    out.push_back(width > 0.0 ? std::min(count - 1, static_cast<std::size_t>((v - low) / width))
                              : 0);
  return out;
}

/// 1 + 2 x sum of the autocorrelations, added in pairs until the first pair that is not positive.
double fewer_than(const VectorXd& residual) {
  const Index n = residual.size();
  const VectorXd r = residual.array() - residual.mean();
  const double squares = r.squaredNorm();
  double sum = 1.0;
  for (Index k = 1; 2 * k + 1 < n && k < n / 4; ++k) {
    const double pair = (r.head(n - 2 * k + 1).dot(r.tail(n - 2 * k + 1)) +
                         r.head(n - 2 * k).dot(r.tail(n - 2 * k))) /
                        squares;
    if (!(pair > 0.0)) break;  // Geyer 1992: the first pair that is not positive is noise
    sum += 2.0 * pair;
  }
  return sum;
}

/// The means of the bins of the search are tested, so differences within a bin are not found.
std::vector<Place> places_of(const Part& part, const std::vector<double>& all) {
  constexpr std::size_t classes = 8;
  const CourseData data(part);
  const auto in_bins = [&](const std::vector<double>& column) {
    const VectorXd means = data.means(column);
    return std::vector<double>(means.begin(), means.end());
  };
  const Observations& o = part.table;
  const std::vector<double> residual = in_bins(all);
  const auto spread = [](const std::vector<double>& r) {
    const auto v = Eigen::Map<const VectorXd>(r.data(), static_cast<Index>(r.size()));
    return (v.array() - v.mean()).square().mean();
  };
  const double of_bins = spread(residual) / std::max(spread(all), 1e-30);
  const double fewer =
      fewer_than(Eigen::Map<const VectorXd>(residual.data(), static_cast<Index>(residual.size())));
  std::vector<Place> out;
  const auto add = [&](const std::vector<double>& values, Where where, const std::string& line,
                       Quantity quantity) {
    double low = 0.0, width = 0.0;
    const auto of = classes_of(values, classes, low, width);
    auto place = place_of(where, residual, of, classes, fewer);
    if (!place) return;
    place->share *= of_bins;
    place->at = low + (*place->at + 0.5) * width;
    place->at_quantity = quantity;
    place->line = line;
    out.push_back(std::move(*place));
  };
  add(in_bins(o.time), {Factor::time}, "", Quantity::time);
  for (const auto& c : o.channels)
    add(in_bins(lagged(c, 0.0, o.time)), {Factor::channel}, c.name, Quantity::number);
  for (Place& place : out) {
    place.p = std::min(1.0, place.p * static_cast<double>(out.size()));
    if (place.where == Where{Factor::channel}) place.at.reset();
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Place& a, const Place& b) { return a.share > b.share; });
  return out;
}

}  // namespace

Comparison comparison_of_course(const Part& part, Fit fit) {
  Comparison out;
  for (std::size_t i = 0; i < fit.residual.size(); ++i)
    if (std::fabs(fit.residual[i]) > std::fabs(out.largest))
      out.largest = fit.residual[i], out.largest_row = i;
  out.floor = floor_of(fit.residual);
  out.cv_rms = left_out_rms(CourseData(part), fit.terms).front();
  out.places = places_of(part, fit.residual);
  for (const Place& place : out.places)
    if (place.p < place_p && out.seats.empty()) out.seats.push_back(place);
  out.fit = std::move(fit);
  return out;
}

Expected<Comparison> compare_course(const Part& part, const std::vector<Term>& model) {
  NONIO_TRY(auto fitted, fit_course(part, model));
  return comparison_of_course(part, std::move(fitted));
}

}  // namespace nonio::model
