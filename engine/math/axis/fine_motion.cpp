// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/fine_motion.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "common/constants.h"
#include "eigen/dense.h"
#include "statistics/path_noise.h"

namespace nonio::math {

namespace {

constexpr double periods_asked = 2.0;
constexpr double steps_of_period = 20.0;
// docs/dev/constants.md, A20: an amplitude below noise_alone times its u may be noise alone, which
// is distributed according to Rayleigh. Its u is then multiplied by of_noise.
constexpr double noise_alone = 3.0, of_noise = 1.25;
// tolerance for the rounding of printed targets, as a fraction of a period
constexpr double as_written = 1e-6;

std::pair<double, double> extent(std::span<const Pass> passes) {
  double length = INFINITY, step = 0.0;
  for (const Pass& p : passes) {
    const auto [low, high] = std::minmax_element(p.position.begin(), p.position.end());
    length = std::min(length, *high - *low);
    for (std::size_t i = 1; i < p.position.size(); ++i)
      step = std::max(step, std::fabs(p.position[i] - p.position[i - 1]));
  }
  return {length, step};
}

struct Design {
  Eigen::MatrixXd X;
  Eigen::VectorXd y;
  /// index of each reading for path_noise, ascending; passes are 10000 apart
  std::vector<int> place;
  std::vector<double> phase;
};

constexpr Eigen::Index waves = 4;

Design design_of(std::span<const Pass> passes, double period, double step) {
  std::size_t n = 0;
  for (const Pass& p : passes) n += p.position.size();
  Design out;
  const auto lines = static_cast<Eigen::Index>(2 * passes.size());
  out.X = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(n), lines + waves);
  out.y.resize(static_cast<Eigen::Index>(n));
  constexpr int apart = 10000;
  Eigen::Index row = 0, line = 0;
  int place = 0;
  for (const Pass& p : passes) {
    const double first = p.position.front(), last = p.position.back();
    for (std::size_t i = 0; i < p.position.size(); ++i, ++row) {
      const double x = p.position[i];
      out.X(row, line) = 1.0;
      out.X(row, line + 1) = 2.0 * (x - first) / (last - first) - 1.0;
      for (Eigen::Index k = 1; k <= 2; ++k) {
        const double angle = full_turn * static_cast<double>(k) * x / period;
        out.X(row, lines + 2 * k - 2) = std::cos(angle);
        out.X(row, lines + 2 * k - 1) = std::sin(angle);
      }
      out.y(row) = p.deviation[i];
      if (i > 0)
        place +=
            std::max(1, static_cast<int>(std::lround(std::fabs(x - p.position[i - 1]) / step)));
      out.place.push_back(place);
      out.phase.push_back(x / period - std::floor(x / period));
    }
    line += 2, place += apart;
  }
  return out;
}

/// Sets folded, range, s, u_folded and dof. `left`: deviations minus the lines of the passes.
void fold(const Design& d, const Eigen::VectorXd& left, std::size_t passes, std::size_t n,
          PeriodicError& out) {
  std::vector<double> sum(n, 0.0), count(n, 0.0);
  // A phase that rounds up to the whole period belongs to the first bin.
  const auto bin_of = [&](std::size_t i) {
    const auto bin = static_cast<std::size_t>(std::lround(d.phase[i] * static_cast<double>(n)));
    return bin < n ? bin : 0;
  };
  for (std::size_t i = 0; i < d.phase.size(); ++i)
    sum[bin_of(i)] += left(at(i)), count[bin_of(i)] += 1.0;
  std::vector<double> mean(n, not_given);
  double fewest = INFINITY, used = 0.0;
  for (std::size_t j = 0; j < n; ++j) {
    if (count[j] == 0.0) continue;
    mean[j] = sum[j] / count[j];
    fewest = std::min(fewest, count[j]), used += 1.0;
  }
  double squares = 0.0;
  for (std::size_t i = 0; i < d.phase.size(); ++i) {
    const double e = left(at(i)) - mean[bin_of(i)];
    squares += e * e;
  }
  out.dof = static_cast<double>(d.phase.size()) - used - 2.0 * static_cast<double>(passes);
  out.s = out.dof > 0.0 ? std::sqrt(squares / out.dof) : not_given;
  out.u_folded = out.s / std::sqrt(fewest);
  std::erase_if(mean, [](double v) { return std::isnan(v); });
  const auto [low, high] = std::minmax_element(mean.begin(), mean.end());
  out.range = *high - *low;
  out.folded = std::move(mean);
}

}  // namespace

PeriodicError periodic_error(std::span<const Pass> passes, double period) {
  using Answer = PeriodicError::Answer;
  PeriodicError out;
  if (passes.empty() || !(period > 0.0) ||
      std::any_of(passes.begin(), passes.end(),
                  [](const Pass& p) { return p.position.size() < 2; }))
    return out;
  const auto [length, step] = extent(passes);
  out.periods = length / period, out.step = step;
  if (out.periods < periods_asked - as_written) {
    out.answer = Answer::too_short;
    return out;
  }
  if (step > period * (1.0 / steps_of_period + as_written)) {
    out.answer = Answer::too_coarse;
    return out;
  }
  out.answer = Answer::given;
  Design d = design_of(passes, period, step);
  const PathNoise noise = path_noise(d.X, d.y * 1e6, d.place);
  Eigen::MatrixXd white = with_column(d.X, d.y);
  whiten(white, d.place, noise);
  const Eigen::Index k = d.X.cols();
  const Eigen::MatrixXd W = left_columns(white, k);
  const Eigen::VectorXd y = white.col(k);
  const Eigen::LDLT<Eigen::MatrixXd> normal(transposed_product(W, W));
  const Eigen::VectorXd beta = solution(normal, transposed_times(W, y));
  const double rss = squared_residual(y, W, beta);
  const Eigen::MatrixXd C = inverse(normal) * (rss / static_cast<double>(W.rows() - k));
  for (std::size_t h = 0; h < out.harmonics.size(); ++h) {
    const Eigen::Index c = k - waves + 2 * at(h);
    auto& wave = out.harmonics[h];
    const Eigen::Vector2d of = beta.segment<2>(c);
    wave.amplitude = of.norm();
    wave.phase = std::atan2(of[1], of[0]);
    if (wave.phase < 0.0) wave.phase += full_turn;
    const Eigen::Vector2d along =
        wave.amplitude > 0.0 ? Eigen::Vector2d(of / wave.amplitude) : Eigen::Vector2d(1.0, 0.0);
    wave.u = std::sqrt(std::max(0.0, along.dot(C.block<2, 2>(c, c) * along)));
    if (wave.amplitude < noise_alone * wave.u) wave.u *= of_noise;
  }
  const Eigen::VectorXd left = residual(d.y, left_columns(d.X, k - waves), beta.head(k - waves));
  const auto bins =
      static_cast<std::size_t>(std::max(steps_of_period, std::floor(period / step + 1e-3)));
  fold(d, left, passes.size(), bins, out);
  return out;
}

namespace {

// tolerance for the rounding of printed targets, as a fraction of a step
constexpr double same_size = 1e-3;
// smallest fraction of the commanded step that the axis must follow: docs/dev/constants.md, A21
constexpr double followed_from = 0.5;

/// Position at the end of a step in 1/1000 of a step, its direction, and whether it is the first
/// after a reversal.
using Place = std::tuple<long long, int, bool>;

void scatter_of(SmallSteps& out) {
  std::map<Place, std::vector<double>> places;
  const double unit = out.commanded / 1000.0;
  for (const SmallSteps::One& s : out.steps)
    places[{std::llround(s.position / unit), s.direction, s.first}].push_back(s.error);
  double squares = 0.0;
  for (const auto& [place, errors] : places) {
    double mean = 0.0;
    for (const double e : errors) mean += e / static_cast<double>(errors.size());
    for (const double e : errors) squares += (e - mean) * (e - mean);
    out.dof += static_cast<double>(errors.size()) - 1.0;
  }
  out.s = out.dof > 0.0 ? std::sqrt(squares / out.dof) : not_given;
}

struct OnePass {
  std::vector<std::pair<double, double>> at;
};

std::map<std::uint32_t, std::map<int, OnePass>> passes_of(
    std::span<const SteppedReading> readings) {
  std::map<std::tuple<std::uint32_t, int, double>, std::pair<double, double>> sums;
  for (const SteppedReading& r : readings) {
    // the key sorts the readings in the direction of motion
    auto& [sum, n] = sums[{r.run, r.direction, r.direction * r.position}];
    sum += r.deviation, n += 1.0;
  }
  std::map<std::uint32_t, std::map<int, OnePass>> out;
  for (const auto& [key, sum] : sums) {
    const auto& [run, direction, along] = key;
    out[run][direction].at.emplace_back(direction * along, sum.first / sum.second);
  }
  return out;
}

/// Returns false if the size of the step differs from that of the other steps.
bool add_step(const std::pair<double, double>& a, const std::pair<double, double>& b,
              std::uint32_t run, int direction, bool first, SmallSteps& out) {
  const double commanded = std::fabs(b.first - a.first);
  if (out.steps.empty()) out.commanded = commanded;
  if (std::fabs(commanded - out.commanded) > same_size * out.commanded) return false;
  out.steps.push_back(
      {direction * (b.second - a.second), first, run, b.first, direction, a.second, b.second});
  return true;
}

bool add_run(std::uint32_t run, const std::map<int, OnePass>& passes, SmallSteps& out) {
  for (const auto& [direction, pass] : passes)
    for (std::size_t i = 1; i < pass.at.size(); ++i)
      if (!add_step(pass.at[i - 1], pass.at[i], run, direction, false, out)) return false;
  if (passes.size() < 2 || out.steps.empty()) return true;
  // If a direction ends one step beyond the start of the other, the axis reverses there.
  for (const auto& [direction, pass] : passes) {
    const auto& end = pass.at.back();
    const auto& begin = passes.at(-direction).at.front();
    if (direction * (end.first - begin.first) > 0.5 * out.commanded &&
        !add_step(end, begin, run, -direction, true, out))
      return false;
  }
  return true;
}

}  // namespace

SmallSteps small_steps(std::span<const SteppedReading> readings) {
  SmallSteps out;
  for (const auto& [run, passes] : passes_of(readings))
    if (!add_run(run, passes, out)) {
      out.answer = SmallSteps::Answer::several_sizes;
      return out;
    }
  const auto extreme = [&](bool first, double sign) {
    std::size_t found = out.steps.size();
    for (std::size_t i = 0; i < out.steps.size(); ++i)
      if (out.steps[i].first == first &&
          (found == out.steps.size() || sign * out.steps[i].error > sign * out.steps[found].error))
        found = i;
    return found;
  };
  out.largest = extreme(false, 1.0), out.least = extreme(false, -1.0);
  out.least_first = extreme(true, -1.0);
  if (out.largest == out.steps.size()) return out;
  out.answer = SmallSteps::Answer::given;
  for (const auto& s : out.steps)
    out.not_followed += !s.first && out.commanded + s.error < followed_from * out.commanded;
  scatter_of(out);
  return out;
}

}  // namespace nonio::math
