// SPDX-License-Identifier: Apache-2.0
#include "failed_channels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "nonio/sdk/channels.h"

namespace nonio::model {

namespace {

using Channel = Observations::Channel;

// docs/dev/constants.md, M59.
constexpr std::array start_values{85.0, no_thermometer, 0.0};  // degC
constexpr double far_apart = 5.0;                              // K, from the values around
constexpr double notable = 0.05;  // part of the readings or of the time
constexpr double least_spike = 2.0,
                 spike_in_changes = 20.0;  // K; median changes to the next reading
constexpr double moves_by = 5.0;           // median second differences of the displacement
constexpr std::size_t least_equal = 30, least_others = 2;
constexpr double others_move = 0.5, others_in_digits = 20.0;  // K; steps of the last digit
constexpr double ln_chance = -14.0;                           // of so many equal values

double range(const Channel& c, double from, double to) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  const auto begin = std::lower_bound(c.time.begin(), c.time.end(), from) - c.time.begin();
  for (auto i = static_cast<std::size_t>(begin); i < c.time.size() && c.time[i] <= to; ++i)
    low = std::min(low, c.value[i]), high = std::max(high, c.value[i]);
  return high > low ? high - low : 0.0;
}

void remove(Channel& c, const std::vector<char>& removed) {
  std::size_t to = 0;
  for (std::size_t i = 0; i < removed.size(); ++i)
    if (removed[i] == 0) c.time[to] = c.time[i], c.value[to++] = c.value[i];
  c.time.resize(to);
  c.value.resize(to);
}

/// Whether a displacement over time moves at this time more than it usually does from reading to
/// reading: then what a thermometer shows there is no failure.
class Movement {
 public:
  explicit Movement(const Part& part) : time_(part.table.time) {
    if (part.kind != Part::Kind::course) return;
    displacements_.push_back(changes_of(part.table.deviation));
    for (const std::vector<double>& companion : part.companions)
      displacements_.push_back(changes_of(companion));
  }

  bool at(double time) const {
    const auto row = std::lower_bound(time_.begin(), time_.end(), time) - time_.begin();
    return std::any_of(displacements_.begin(), displacements_.end(), [&](const Changes& d) {
      for (auto i = std::max<std::ptrdiff_t>(row - 2, 0); i <= row; ++i)  // of row i + 1
        if (i < static_cast<std::ptrdiff_t>(d.sizes.size()) &&
            d.sizes[static_cast<std::size_t>(i)] > d.limit)
          return true;
      return false;
    });
  }

 private:
  struct Changes {
    std::vector<double> sizes;  ///< second differences
    double limit;
  };

  static Changes changes_of(const std::vector<double>& y) {
    Changes out{{}, std::numeric_limits<double>::infinity()};
    for (std::size_t i = 1; i + 1 < y.size(); ++i)
      out.sizes.push_back(std::fabs(y[i - 1] - 2.0 * y[i] + y[i + 1]));
    std::vector<double> sorted = out.sizes;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    if (sorted.empty()) return out;
    std::nth_element(sorted.begin(), middle, sorted.end());
    if (*middle > 0.0) out.limit = moves_by * *middle;
    return out;
  }

  const std::vector<double>& time_;
  std::vector<Changes> displacements_;
};

/// Removes single readings far from the course of those around them, which a body that has warmed
/// cannot leave and reach again at once. If they are many, or the displacement moves at most of
/// them, the channel really changes so fast.
std::optional<ChannelLeft> without_spikes(Channel& c, const Movement& movement) {
  const std::size_t n = c.value.size();
  if (n < least_equal) return std::nullopt;
  std::vector<double> changes;
  for (std::size_t i = 1; i < n; ++i) changes.push_back(std::fabs(c.value[i] - c.value[i - 1]));
  const auto middle = changes.begin() + static_cast<std::ptrdiff_t>(changes.size() / 2);
  std::nth_element(changes.begin(), middle, changes.end());
  const double least = std::max(least_spike, spike_in_changes * *middle);
  std::vector<char> spike(n, 0);
  ChannelLeft left{c.name, ChannelLeft::Why::spikes_dropped};
  double largest = 0.0;
  std::size_t moved = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double before = c.value[i > 0 ? i - 1 : 1], after = c.value[i + 1 < n ? i + 1 : n - 2];
    const double off = std::min(std::fabs(c.value[i] - before), std::fabs(c.value[i] - after));
    const bool returns =
        (c.value[i] > before) == (c.value[i] > after) && std::fabs(after - before) < 0.5 * off;
    if (!returns || !(off > least)) continue;
    spike[i] = 1;
    ++left.readings;
    if (movement.at(c.time[i])) ++moved;
    if (off > largest) largest = off, left.value = c.value[i];
  }
  if (left.readings == 0 || 2 * moved > left.readings ||
      static_cast<double>(left.readings) > notable * static_cast<double>(n))
    return std::nullopt;
  remove(c, spike);
  return left;
}

/// Removes stretches of one of the start values that begin and end with a jump.
std::optional<ChannelLeft> without_start_values(Channel& c) {
  std::vector<char> start(c.value.size(), 0);
  ChannelLeft left{c.name, ChannelLeft::Why::start_value};
  for (std::size_t i = 0; i < c.value.size();) {
    std::size_t end = i + 1;
    while (end < c.value.size() && c.value[end] == c.value[i]) ++end;
    const bool known =
        std::find(start_values.begin(), start_values.end(), c.value[i]) != start_values.end();
    const auto jumps = [&](std::size_t other) {
      return std::fabs(c.value[other] - c.value[i]) > far_apart;
    };
    if (known && (i == 0 || jumps(i - 1)) && (end == c.value.size() || jumps(end))) {
      std::fill(start.begin() + static_cast<std::ptrdiff_t>(i),
                start.begin() + static_cast<std::ptrdiff_t>(end), 1);
      left.value = c.value[i];
      left.readings += end - i;
    }
    i = end;
  }
  if (left.readings == 0) return std::nullopt;
  const bool fails =
      static_cast<double>(left.readings) > notable * static_cast<double>(start.size());
  if (!fails) left.why = ChannelLeft::Why::start_values_dropped;
  remove(c, start);
  return left;
}

/// The longest stretch of equal values, if it is too long to be chance while all other thermometers
/// next to the same readings move.
std::optional<ChannelLeft> frozen(const Channel& c, const std::vector<Channel>& all) {
  const std::size_t n = c.value.size();
  std::size_t begin = 0, length = 0, equal = 0;
  double digit = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < n;) {
    std::size_t end = i + 1;
    while (end < n && c.value[end] == c.value[i]) ++end;
    if (end - i > length) begin = i, length = end - i;
    if (end < n) digit = std::min(digit, std::fabs(c.value[end] - c.value[i]));
    equal += end - i - 1;
    i = end;
  }
  if (length < least_equal) return std::nullopt;
  const double from = c.time[begin], to = c.time[begin + length - 1];
  if (to - from < notable * (c.time.back() - c.time.front())) return std::nullopt;
  if (length < n) {
    const double p =
        static_cast<double>(equal - (length - 1) + 1) / static_cast<double>(n - length + 2);
    if (static_cast<double>(length) * std::log(p) + std::log(static_cast<double>(n)) > ln_chance)
      return std::nullopt;
  }
  const double least = std::max(others_move, length < n ? others_in_digits * digit : 0.0);
  std::size_t others = 0;
  for (const Channel& other : all) {
    if (!other.is_temperature() || other.name == c.name || other.lines != c.lines) continue;
    if (range(other, from, to) < least) return std::nullopt;
    ++others;
  }
  if (others < least_others) return std::nullopt;
  ChannelLeft left{c.name, ChannelLeft::Why::frozen};
  left.value = c.value[begin], left.readings = length, left.from = from, left.to = to;
  return left;
}

}  // namespace

void leave_failed(Part& part) {
  Observations& o = part.table;
  const Movement movement(part);
  for (Channel& c : o.channels)
    if (c.is_temperature()) {
      const auto started = without_start_values(c);
      if (started) part.channels_left.push_back(*started);
      if (started && started->fails()) continue;
      if (auto spikes = without_spikes(c, movement)) part.channels_left.push_back(*spikes);
    }
  std::vector<ChannelLeft> stuck;
  for (const Channel& c : o.channels)
    if (c.is_temperature() && !c.value.empty())
      if (auto left = frozen(c, o.channels)) stuck.push_back(std::move(*left));
  part.channels_left.insert(part.channels_left.end(), stuck.begin(), stuck.end());
  std::erase_if(o.channels, [&](const Channel& c) {
    return c.value.empty() ||
           std::any_of(part.channels_left.begin(), part.channels_left.end(),
                       [&](const auto& left) { return left.name == c.name && left.fails(); });
  });
}

}  // namespace nonio::model
