// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/channels.h"

#include <algorithm>
#include <cmath>

namespace nonio {

namespace {

std::vector<double> at_samples(const Observations::Channel& c, double tau) {
  std::vector<double> y(c.value.size(), 0.0);
  double before = 0.0, step = -1.0, decay = 0.0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double x = c.value[i] - c.value.front();
    if (i > 0 && tau > 0.0) {
      const double h = c.time[i] - c.time[i - 1];
      if (h != step) decay = std::exp(-h / tau), step = h;
      // For x = before + slope t the stationary solution is x - slope tau; the difference from it
      // decays.
      const double shift = h > 0.0 ? (x - before) / h * tau : 0.0;
      y[i] = decay * (y[i - 1] - before + shift) + x - shift;
    } else {
      y[i] = i > 0 ? x : 0.0;
    }
    before = x;
  }
  return y;
}

}  // namespace

std::vector<double> lagged(const Observations::Channel& channel, double tau,
                           const std::vector<double>& time) {
  std::vector<double> out(time.size(), 0.0);
  if (channel.value.empty()) return out;
  const std::vector<double> y = at_samples(channel, tau);
  const std::vector<double>& t = channel.time;
  std::size_t k = 0;
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (k >= t.size() || t[k] > time[i])
      k = static_cast<std::size_t>(std::upper_bound(t.begin(), t.end(), time[i]) - t.begin());
    while (k < t.size() && t[k] <= time[i]) ++k;
    if (k == 0) continue;
    if (k == t.size()) {
      // The channel keeps its last value, to which the lag converges.
      const double x = channel.value.back() - channel.value.front();
      out[i] = tau > 0.0 ? x + (y.back() - x) * std::exp(-(time[i] - t.back()) / tau) : x;
      continue;
    }
    const double share = (time[i] - t[k - 1]) / (t[k] - t[k - 1]);
    out[i] = y[k - 1] + share * (y[k] - y[k - 1]);
  }
  return out;
}

std::vector<double> lagged(const Observations& o, std::string_view name, double tau) {
  std::vector<double> out(o.size(), 0.0);
  if (o.time.size() != o.size()) return out;
  const Observations::Channel* const first = o.channel(name);
  for (const Observations::Channel& c : o.channels) {
    if (c.name != name || c.value.empty() || first->value.empty()) continue;
    std::vector<std::size_t> rows;
    std::vector<double> time;
    for (std::size_t i = 0; i < o.size(); ++i)
      if (c.lines.empty() || std::binary_search(c.lines.begin(), c.lines.end(), o.line_of(i)))
        rows.push_back(i), time.push_back(o.time[i]);
    const std::vector<double> own = lagged(c, tau, time);
    for (std::size_t k = 0; k < rows.size(); ++k)
      out[rows[k]] = own[k] + c.value.front() - first->value.front();
  }
  return out;
}

std::vector<double> time_constants_for(const std::vector<double>& time) {
  constexpr std::size_t least_times = 12, most = 18;
  constexpr double usual = 7200.0;  // s; docs/dev/constants.md, M53
  std::vector<double> t = time;
  std::sort(t.begin(), t.end());
  t.erase(std::unique(t.begin(), t.end()), t.end());
  if (t.size() < least_times) return {};
  const double duration = t.back() - t.front();
  const double interval = duration / static_cast<double>(t.size() - 1);
  std::vector<double> out;
  for (double tau = std::max(duration / 12.0, std::min(duration / 4.0, usual));
       tau >= 4.0 * interval && out.size() + 1 < most; tau *= std::sqrt(0.5))
    out.push_back(tau);
  out.push_back(0.0);
  std::reverse(out.begin(), out.end());
  return out;
}

}  // namespace nonio
