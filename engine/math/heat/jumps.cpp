// SPDX-License-Identifier: Apache-2.0
//
// A body with the time constant tau that is heated suddenly moves by A (1 - q), A (1 - q) q, ... in
// successive intervals of length dt, with q = exp(-dt/tau). A change of one interval that exceeds
// its neighbours by more than 1/q is therefore faster than any body with this time constant. For a
// change that is spread over two intervals, because a sensor averages, the limit is (1 + q)/q^2.
#include <algorithm>
#include <cmath>
#include <limits>

#include "nonio/math/thermal.h"

namespace nonio::math {

namespace {

// docs/dev/constants.md, M58.
constexpr double fastest = 0.5;          // time constant of a body / interval between readings
constexpr double share_of_range = 0.05;  // smallest jump / range of the displacement
constexpr std::size_t most_jumps = 5, neighbours = 5;

double median(std::vector<double> x) {
  const auto middle = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2);
  std::nth_element(x.begin(), middle, x.end());
  return *middle;
}

class Jumps {
 public:
  explicit Jumps(const Track& k) : k_(k) {
    std::vector<double> interval;
    for (std::size_t i = 1; i < k.size(); ++i) interval.push_back(k.time[i] - k.time[i - 1]);
    const double usual_interval = median(interval);
    for (std::size_t i = 1; i < k.size(); ++i) {
      // In a longer interval heat moves a machine farther.
      const double longer = usual_interval > 0.0 ? interval[i - 1] / usual_interval : 1.0;
      change_.push_back((k.d[i] - k.d[i - 1]) / std::max(longer, 1.0));
    }
    const auto [low, high] = std::minmax_element(k.d.begin(), k.d.end());
    least_ = share_of_range * (*high - *low);
    double digit = std::numeric_limits<double>::infinity();
    std::vector<double> sizes;
    for (const double c : change_) {
      sizes.push_back(std::fabs(c));
      if (c != 0.0) digit = std::min(digit, sizes.back());
    }
    usual_ = std::max(2.0 * median(std::move(sizes)), digit);
  }

  std::vector<Jump> found(const std::function<bool(double, double)>& moves_at_once) const {
    std::vector<Jump> out;
    for (std::size_t i = 0; i < change_.size(); ++i) {
      const std::size_t width = stands_out(i, 1) ? 1 : stands_out(i, 2) ? 2 : 0;
      if (width == 0) continue;
      const std::size_t before = i > 0 ? i - 1 : 0, after = std::min(i + width + 1, k_.size() - 1);
      if (moves_at_once && moves_at_once(k_.time[before], k_.time[after])) continue;
      // The reading in between belongs to the side that it is closer to.
      const bool late = width == 2 && std::fabs(change_[i]) < std::fabs(change_[i + 1]);
      out.push_back({late ? i + 1 : i, k_.d[i + width] - k_.d[i]});
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

  const Track& k_;
  std::vector<double> change_;
  double least_ = 0.0;  ///< smallest jump, m
  double usual_ = 0.0;  ///< change by noise or by one digit, m
};

}  // namespace

std::vector<Jump> jumps_of(const Track& track,
                           const std::function<bool(double, double)>& moves_at_once) {
  return track.size() < 3 ? std::vector<Jump>() : Jumps(track).found(moves_at_once);
}

}  // namespace nonio::math
