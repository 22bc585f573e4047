// SPDX-License-Identifier: Apache-2.0
#include "pass_model.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <limits>

#include "nonio/math/statistics.h"

namespace nonio::math {
namespace {

struct Sums {
  double n = 0, z = 0, zz = 0, r = 0, zr = 0;
};

void keep_distinct(std::vector<std::uint32_t>& x) {
  std::sort(x.begin(), x.end());
  x.erase(std::unique(x.begin(), x.end()), x.end());
}

/// The readings of a target are sorted by run, so the next run number is tried first.
class PlaceOfRun {
 public:
  explicit PlaceOfRun(const std::vector<std::uint32_t>& runs) : runs_(runs) {}
  /// Returns runs.size() if the list does not contain the run.
  std::size_t of(std::uint32_t run) {
    if (next_ >= runs_.size() || runs_[next_] != run)
      next_ = static_cast<std::size_t>(std::lower_bound(runs_.begin(), runs_.end(), run) -
                                       runs_.begin());
    const std::size_t at = next_;
    if (at == runs_.size() || runs_[at] != run) return runs_.size();
    ++next_;
    return at;
  }

 private:
  const std::vector<std::uint32_t>& runs_;
  std::size_t next_ = 0;
};

// Memory grows with the number of runs, not of readings.
std::vector<std::uint32_t> runs_of(const AxisTest& test) {
  std::vector<std::uint32_t> runs, fresh;
  const auto take_fresh = [&] {
    runs.insert(runs.end(), fresh.begin(), fresh.end());
    fresh.clear();
    keep_distinct(runs);
  };
  PlaceOfRun place(runs);
  for (const auto& reading : test.readings()) {
    if (place.of(reading.run) < runs.size()) continue;
    fresh.push_back(reading.run);
    if (fresh.size() >= std::max<std::size_t>(4096, runs.size())) take_fresh();
  }
  take_fresh();
  return runs;
}

void index_readings(const AxisTest& test, PassModel& m) {
  const auto runs = runs_of(test);
  for (const std::uint32_t run : runs) {
    m.passes.push_back({run, false});
    m.passes.push_back({run, true});
  }
  PlaceOfRun place(runs);
  m.pass.resize(test.readings().size());
  m.target.resize(test.readings().size());
  for (std::size_t i = 0; i < test.targets.size(); ++i)
    for (const bool minus : {false, true}) {
      const auto part = minus ? test.minus(i) : test.plus(i);
      const std::size_t first = first_reading(test, i, minus);
      for (std::size_t k = 0; k < part.size(); ++k) {
        m.pass[first + k] = static_cast<std::uint32_t>(2 * place.of(part[k].run) + (minus ? 1 : 0));
        m.target[first + k] = static_cast<std::uint32_t>(i);
      }
    }
}

// Returns the largest absolute mean that was subtracted, m or rad.
double take_target_means(const AxisTest& test, PassModel& m) {
  double largest = 0.0;
  for (std::size_t i = 0; i < test.targets.size(); ++i)
    for (const bool minus : {false, true}) {
      const std::size_t first = first_reading(test, i, minus);
      const std::size_t count = (minus ? test.minus(i) : test.plus(i)).size();
      // the second round removes the rounding error of the first
      for (int twice = 0; twice < 2; ++twice) {
        double sum = 0.0, n = 0.0;
        for (std::size_t k = first; k < first + count; ++k)
          if (!std::isnan(m.e[k])) sum += m.e[k], n += 1.0;
        if (n == 0.0) break;
        for (std::size_t k = first; k < first + count; ++k) m.e[k] -= sum / n;
        largest = std::max(largest, std::fabs(sum / n));
      }
    }
  return largest;
}

double take_passes(const AxisTest& test, PassModel& m, bool slopes) {
  std::vector<Sums> sums(m.passes.size());
  for (std::size_t k = 0; k < m.e.size(); ++k) {
    if (std::isnan(m.e[k])) continue;
    Sums& s = sums[m.pass[k]];
    const double z = test.targets[m.target[k]] - m.middle;
    s.n += 1.0, s.z += z, s.zz += z * z, s.r += m.e[k], s.zr += z * m.e[k];
  }
  std::vector<double> offset(sums.size(), 0.0), slope(sums.size(), 0.0);
  const double reach = test.length() / 2.0;
  double largest = 0.0;
  for (std::size_t p = 0; p < sums.size(); ++p) {
    const Sums& s = sums[p];
    if (s.n == 0.0) continue;
    const double spread = s.zz - s.z * s.z / s.n;
    if (slopes && s.n >= 3.0 && spread > 1e-6 * reach * reach)
      slope[p] = (s.zr - s.z * s.r / s.n) / spread;
    offset[p] = (s.r - slope[p] * s.z) / s.n;
    m.passes[p].offset += offset[p];
    m.passes[p].slope += slope[p];
    largest = std::max(largest, std::fabs(offset[p]) + std::fabs(slope[p]) * reach);
  }
  for (std::size_t k = 0; k < m.e.size(); ++k)
    m.e[k] -= offset[m.pass[k]] + slope[m.pass[k]] * (test.targets[m.target[k]] - m.middle);
  return largest;
}

void sum_up(const AxisTest& test, PassModel& m, bool slopes) {
  for (std::size_t k = 0; k < m.e.size(); ++k)
    if (!std::isnan(m.e[k])) ++m.passes[m.pass[k]].readings;
  for (std::size_t d = 0; d < 2; ++d) {
    PassModel::Side& side = m.side[d];
    double offset = 0.0, slope = 0.0;
    for (std::size_t p = d; p < m.passes.size(); p += 2)
      if (m.passes[p].readings > 0)
        ++side.passes, offset += m.passes[p].offset, slope += m.passes[p].slope;
    for (std::size_t p = d; p < m.passes.size() && side.passes > 0; p += 2) {
      m.passes[p].offset -= offset / static_cast<double>(side.passes);
      m.passes[p].slope -= slope / static_cast<double>(side.passes);
    }
    for (std::size_t i = 0; i < test.targets.size(); ++i) {
      const std::size_t first = first_reading(test, i, d == 1);
      const std::size_t count = (d == 1 ? test.minus(i) : test.plus(i)).size();
      std::size_t n = 0;
      for (std::size_t k = first; k < first + count; ++k)
        if (!std::isnan(m.e[k])) ++n, side.squares += m.e[k] * m.e[k];
      side.readings += n;
      if (n > 0) ++side.targets;
    }
    const double per_pass = slopes ? 2.0 : 1.0;
    side.dof = static_cast<double>(side.readings) - static_cast<double>(side.targets) -
               per_pass * (static_cast<double>(side.passes) - 1.0);
  }
}

}  // namespace

std::size_t first_reading(const AxisTest& test, std::size_t i, bool minus) {
  const auto part = minus ? test.minus(i) : test.plus(i);
  return static_cast<std::size_t>(part.data() - test.readings().data());
}

double joined_dof(double a, double dof_a, double b, double dof_b) {
  const double sum = a + b;
  if (!(sum > 0.0)) return dof_a + dof_b;
  return sum * sum / ((a > 0.0 ? a * a / dof_a : 0.0) + (b > 0.0 ? b * b / dof_b : 0.0));
}

namespace {

PassModel fitted(const AxisTest& test, bool slopes, std::span<const std::size_t> left_out) {
  PassModel m;
  index_readings(test, m);
  m.middle = mean(test.targets);
  m.e.reserve(test.readings().size());
  for (const auto& reading : test.readings()) m.e.push_back(reading.deviation);
  for (const std::size_t k : left_out) m.e[k] = std::numeric_limits<double>::quiet_NaN();
  take_target_means(test, m);
  double size = 0.0;
  for (const double e : m.e)
    if (!std::isnan(e)) size = std::max(size, std::fabs(e));
  // Equal runs need one round, others converge geometrically; long tests have a limit of rounds.
  const double readings = static_cast<double>(m.e.size());
  const int most_rounds = static_cast<int>(std::clamp(2e8 / std::max(readings, 1.0), 4.0, 60.0));
  for (int round = 0; round < most_rounds; ++round) {
    take_passes(test, m, slopes);
    if (take_target_means(test, m) <= 1e-9 * size) break;
  }
  sum_up(test, m, slopes);
  return m;
}

bool same_bits(const AxisTest& a, const AxisTest& b) {
  const auto same = [](const auto& x, const auto& y) {
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof x[0]) == 0;
  };
  static_assert(sizeof(AxisTest::Reading) == sizeof(double) + 2 * sizeof(std::uint32_t),
                "no padding");
  if (!same(a.targets, b.targets) || !same(a.readings(), b.readings())) return false;
  for (std::size_t i = 0; i < a.targets.size(); ++i)
    if (a.plus(i).size() != b.plus(i).size() || a.minus(i).size() != b.minus(i).size())
      return false;
  return true;
}

struct Fitted {
  AxisTest test;
  bool slopes = false;
  std::vector<std::size_t> left_out;
  PassModel model;
};

}  // namespace

// Findings, reversal and each table need the fits of the same few tests. A cached fit is returned
// only for identical bits; the limit on readings bounds the memory (32 bytes per reading).
PassModel fit_passes(const AxisTest& test, bool slopes, std::span<const std::size_t> left_out) {
  constexpr std::size_t most_kept = 8, most_readings = 24'000'000;
  thread_local std::deque<Fitted> kept;
  for (const Fitted& known : kept)
    if (known.slopes == slopes && std::ranges::equal(known.left_out, left_out) &&
        same_bits(known.test, test))
      return known.model;
  const std::size_t own = test.readings().size();
  if (own == 0 || own > most_readings) return fitted(test, slopes, left_out);
  std::size_t readings = own;
  for (const Fitted& known : kept) readings += known.test.readings().size();
  while (!kept.empty() && (kept.size() >= most_kept || readings > most_readings)) {
    readings -= kept.front().test.readings().size();
    kept.pop_front();
  }
  return kept
      .emplace_back(
          Fitted{test, slopes, {left_out.begin(), left_out.end()}, fitted(test, slopes, left_out)})
      .model;
}

}  // namespace nonio::math
