// SPDX-License-Identifier: Apache-2.0
//
// A body with the time constant tau that is heated suddenly moves by A (1 - q), A (1 - q) q, ... in
// successive intervals of length dt, with q = exp(-dt/tau). A change of one interval that exceeds
// its neighbours by more than 1/q is therefore faster than any body with this time constant. For a
// change that is spread over two intervals, because a sensor averages, the limit is (1 + q)/q^2.
#include "restarts.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nonio::model {

namespace {

// docs/dev/constants.md, M58.
constexpr double longer_than_interval = 10.0, usual_gap = 900.0, share_of_test = 0.01;
constexpr double shortest_segment = 0.1;   // median duration of segments / median gap
constexpr double fastest = 0.5;            // time constant of a body / interval between readings
constexpr double share_of_range = 0.05;    // smallest jump / range of the displacement
constexpr double change_of_source = 0.25;  // of the range of a speed or load
constexpr std::size_t most_jumps = 5, neighbours = 5;

double median(std::vector<double> x) {
  const auto middle = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2);
  std::nth_element(x.begin(), middle, x.end());
  return *middle;
}

std::vector<double> differences(const std::vector<double>& x) {
  std::vector<double> out;
  for (std::size_t i = 1; i < x.size(); ++i) out.push_back(x[i] - x[i - 1]);
  return out;
}

/// None if the readings were taken in bursts, which share a zero.
std::vector<std::size_t> rows_after_gaps(const std::vector<double>& time) {
  const std::vector<double> interval = differences(time);
  const double least = std::max(longer_than_interval * median(interval),
                                std::min(usual_gap, share_of_test * (time.back() - time.front())));
  std::vector<std::size_t> rows;
  std::vector<double> gaps, segments;
  double begin = time.front();
  for (std::size_t i = 1; i < time.size(); ++i) {
    if (!(interval[i - 1] > least)) continue;
    rows.push_back(i);
    gaps.push_back(interval[i - 1]);
    segments.push_back(time[i - 1] - begin);
    begin = time[i];
  }
  segments.push_back(time.back() - begin);
  if (!rows.empty() && median(segments) < shortest_segment * median(gaps)) rows.clear();
  return rows;
}

/// Whether a speed or a load changes at that time, which can move a machine at once.
bool source_changes(const Observations& o, double from, double to) {
  for (const auto& c : o.channels) {
    if (c.is_temperature() || c.value.empty()) continue;
    const auto at = [&](double t) {
      const auto after = std::upper_bound(c.time.begin(), c.time.end(), t);
      return std::max<std::ptrdiff_t>(after - c.time.begin() - 1, 0);
    };
    const auto [low, high] = std::minmax_element(c.value.begin(), c.value.end());
    const auto [least, most] =
        std::minmax_element(c.value.begin() + at(from), c.value.begin() + at(to) + 1);
    if (*most - *least > change_of_source * (*high - *low)) return true;
  }
  return false;
}

class Jumps {
 public:
  explicit Jumps(const Observations& o) : o_(o), change_(differences(o.deviation)) {
    const auto [low, high] = std::minmax_element(o.deviation.begin(), o.deviation.end());
    least_ = share_of_range * (*high - *low);
    double digit = std::numeric_limits<double>::infinity();
    std::vector<double> sizes;
    for (const double c : change_) {
      sizes.push_back(std::fabs(c));
      if (c != 0.0) digit = std::min(digit, sizes.back());
    }
    usual_ = std::max(2.0 * median(std::move(sizes)), digit);
  }

  std::vector<Restart> found() const {
    std::vector<Restart> out;
    for (std::size_t i = 0; i < change_.size(); ++i) {
      const std::size_t width = stands_out(i, 1) ? 1 : stands_out(i, 2) ? 2 : 0;
      if (width == 0) continue;
      const std::size_t before = i > 0 ? i - 1 : 0,
                        after = std::min(i + width + 1, o_.time.size() - 1);
      if (source_changes(o_, o_.time[before], o_.time[after])) continue;
      // The reading in between belongs to the side that it is closer to.
      const bool late = width == 2 && std::fabs(change_[i]) < std::fabs(change_[i + 1]);
      out.push_back({o_.time[late ? i + 1 : i], o_.time[late ? i + 2 : i + 1],
                     o_.deviation[i + width] - o_.deviation[i]});
      i += width;
    }
    // More jumps are how the machine moves.
    if (out.size() > most_jumps) out.clear();
    return out;
  }

 private:
  bool stands_out(std::size_t i, std::size_t width) const {
    if (i + width > change_.size()) return false;
    const double sum = change_[i] + (width == 2 ? change_[i + 1] : 0.0);
    if (std::fabs(sum) < least_ || (width == 2 && change_[i] * change_[i + 1] <= 0.0)) return false;
    std::vector<double> around;
    for (std::size_t k = i - std::min(i, neighbours); k < i; ++k) around.push_back(change_[k]);
    const std::size_t end = std::min(i + width + neighbours, change_.size());
    for (std::size_t k = i + width; k < end; ++k) around.push_back(change_[k]);
    if (around.size() < neighbours) return false;
    const double usual = median(around);
    double largest = usual_;
    for (const double c : around) largest = std::max(largest, std::fabs(c - usual));
    const double q = std::exp(-1.0 / fastest);
    const double ratio = width == 1 ? 1.0 / q : (1.0 + q) / (q * q);
    return std::fabs(sum - static_cast<double>(width) * usual) > ratio * largest;
  }

  const Observations& o_;
  std::vector<double> change_;
  double least_ = 0.0;  ///< smallest jump, m
  double usual_ = 0.0;  ///< change by noise or by one digit, m
};

}  // namespace

std::vector<Restart> restarts_of(const Part& part) {
  const Observations& o = part.table;
  if (o.size() < 3) return {};
  std::vector<Restart> out = Jumps(o).found();
  for (Restart& jump : out) jump.displacement = part.displacement;
  for (const std::size_t row : rows_after_gaps(o.time)) {
    std::erase_if(out, [&](const Restart& jump) { return jump.to == o.time[row]; });
    out.push_back({o.time[row - 1], o.time[row]});
  }
  return out;
}

void put_restarts(Part& part, std::vector<Restart> restarts) {
  std::stable_sort(restarts.begin(), restarts.end(),
                   [](const Restart& a, const Restart& b) { return a.to < b.to; });
  restarts.erase(std::unique(restarts.begin(), restarts.end(),
                             [](const Restart& a, const Restart& b) { return a.to == b.to; }),
                 restarts.end());
  Observations& o = part.table;
  o.lines.resize(restarts.size() + 1, o.lines.front());
  auto next = restarts.begin();
  for (std::size_t i = 0; i < o.size() && !restarts.empty(); ++i) {
    while (next != restarts.end() && next->to <= o.time[i]) ++next;
    o.line.push_back(static_cast<std::uint32_t>(next - restarts.begin()));
  }
  part.restarts = std::move(restarts);
}

}  // namespace nonio::model
