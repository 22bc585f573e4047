// SPDX-License-Identifier: Apache-2.0
#include "fit/weights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "nonio/math/distributions.h"

namespace nonio::model {

namespace {

constexpr double equal_part = 0.5, largest_weight = 8.0;  // docs/dev/constants.md, M55
// docs/dev/constants.md, M72
constexpr double any_size = 0.5, least_deviation = 0.2, widest = 100.0;

/// How much more often an effect is named with the largest weight than with the smallest one.
class Gain {
 public:
  Gain(double u, double candidates) : u_(u) {
    const double level = named_below / std::max(candidates, 1.0);
    at_least_ = math::normal_quantile(1.0 - equal_part * level);
    at_most_ = math::normal_quantile(1.0 - largest_weight * level);
  }

  /// Of sizes that are equally likely on a logarithmic scale.
  double of_any() const {
    return mean([](double share) { return std::pow(widest, share); });
  }
  double of(double median, double deviation) const {
    const double spread = std::max(deviation, least_deviation * median);
    return mean([&](double share) {
      return std::max(median + spread * math::normal_quantile(share), 0.0) / u_;
    });
  }

 private:
  template <class Size>
  double mean(const Size& size) const {
    constexpr int steps = 40;
    double sum = 0.0;
    for (int k = 0; k < steps; ++k) {
      const double theta = size((k + 0.5) / steps);
      sum += normal_below(theta - at_most_) - normal_below(theta - at_least_);
    }
    return sum / steps;
  }

  double u_, at_least_, at_most_;
};

}  // namespace

void set_weights(std::span<Term> candidates, double u) {
  std::vector<double> expected;
  double sum = 0.0, counted = 0.0;
  for (const Term& t : candidates)
    if (t.frequency) ++counted;
  const Gain gain(u, counted);
  for (const Term& t : candidates) {
    double part = t.frequency.value_or(0.0);
    if (t.usual_size && u > 0.0)
      part *= any_size +
              (1.0 - any_size) * gain.of(t.usual_size->first, t.usual_size->second) / gain.of_any();
    expected.push_back(part);
    sum += part;
  }
  for (std::size_t i = 0; i < candidates.size(); ++i)
    candidates[i].weight =
        candidates[i].frequency && sum > 0.0
            ? std::min(equal_part + (1.0 - equal_part) * expected[i] * counted / sum,
                       largest_weight)
            : 1.0;
}

double normal_below(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

double evidence_of_weight(double weight) { return 2.0 * std::log(weight); }

}  // namespace nonio::model
