// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "host/reading/plausibility.h"
#include "host/reading/plausibility_strokes.h"

namespace nonio::host::reading {
namespace {

/// Strokes that go up and are called -, or down and are called +. A file that is sorted by target,
/// with strokes mixed or all going one way, says nothing of it; nor do targets that all were
/// approached from one side, whichever came first.
void against_order(const std::vector<Stroke>& strokes, std::vector<Finding>& out) {
  bool up = false, down = false, plus = false, minus = false;
  std::size_t judged = 0;
  std::vector<const Stroke*> wrong;
  for (const Stroke& s : strokes) {
    if (!s.alone || s.sense == 0 || s.direction == 0) continue;
    (s.sense > 0 ? up : down) = true;
    (s.direction > 0 ? plus : minus) = true;
    ++judged;
    if (s.sense != s.direction) wrong.push_back(&s);
  }
  if (!up || !down || !plus || !minus || wrong.empty()) return;
  out.push_back({.id = "plausibility.direction-against-order",
                 .attention = true,
                 .evidence = {{"passes", static_cast<double>(wrong.size()), Quantity::count},
                              {"of", static_cast<double>(judged), Quantity::count}},
                 .texts = {{"which", name_of(*wrong.front())}}});
}

using Reversals = std::map<std::uint32_t, std::map<double, double>>;  // by run and target

Reversals reversals_of(const std::vector<Stroke>& strokes) {
  std::map<std::uint32_t, const Stroke*> plus, minus;
  for (const Stroke& s : strokes) (s.direction > 0 ? plus : minus)[s.run] = &s;
  Reversals out;
  for (const auto& [run, up] : plus) {
    const auto down = minus.find(run);
    if (down == minus.end()) continue;
    std::map<double, double> by_target;
    for (std::size_t i = 0; i < up->target.size(); ++i) by_target[up->target[i]] = up->deviation[i];
    for (std::size_t i = 0; i < down->second->target.size(); ++i)
      if (const auto at = by_target.find(down->second->target[i]); at != by_target.end())
        out[run][at->first] = at->second - down->second->deviation[i];
  }
  return out;
}

/// A run whose reversal is that of the others with the other sign, and not a little.
void swapped(const Passes& passes, Quantity deviation, std::vector<Finding>& out) {
  const Reversals all = reversals_of(passes.strokes);
  const double step = passes.step;
  for (const auto& [run, own] : all) {
    std::map<double, std::vector<double>> others;
    for (const auto& [other, by_target] : all)
      if (other != run)
        for (const auto& [target, value] : by_target) others[target].push_back(value);
    double kept = 0.0, turned = 0.0, mean = 0.0, own_mean = 0.0, scatter = 0.0, freedom = 0.0;
    double n = 0.0;
    for (const auto& [target, value] : own) {
      const auto at = others.find(target);
      if (at == others.end()) continue;
      double middle = 0.0;
      for (const double v : at->second) middle += v / static_cast<double>(at->second.size());
      for (const double v : at->second) scatter += (v - middle) * (v - middle);
      freedom += static_cast<double>(at->second.size()) - 1.0;
      kept += (value - middle) * (value - middle);
      turned += (value + middle) * (value + middle);
      mean += middle;
      own_mean += value;
      n += 1.0;
    }
    if (n < 3.0) continue;
    mean /= n;
    own_mean /= n;
    const double s = std::max(std::sqrt(freedom > 0.0 ? scatter / freedom : turned / n), step);
    // The whole run turned round agrees with the others as they agree among themselves.
    if (step <= 0.0 || kept < 25.0 * turned || turned / n > 9.0 * s * s ||
        std::fabs(mean) < 5.0 * s / std::sqrt(n))
      continue;
    out.push_back({.id = "plausibility.directions-swapped",
                   .attention = true,
                   .evidence = {{"run", static_cast<double>(run), Quantity::count},
                                {"reversal", own_mean, deviation},
                                {"others", mean, deviation}}});
    return;
  }
}

/// Means over targets, and how the readings scatter about them.
class Curve {
 public:
  void add(const Stroke& s, double weight = 1.0) {
    for (std::size_t i = 0; i < s.target.size(); ++i) {
      Cell& cell = cells_[s.target[i]];
      cell.count += weight;
      cell.sum += weight * s.deviation[i];
      cell.squares += weight * s.deviation[i] * s.deviation[i];
    }
  }
  Curve without(const Stroke& s) const {
    Curve rest = *this;
    rest.add(s, -1.0);
    std::erase_if(rest.cells_, [](const auto& one) { return one.second.count < 0.5; });
    return rest;
  }
  template <class Visit>
  void each(const Visit& visit) const {
    for (const auto& [target, cell] : cells_) visit(target, cell.sum / cell.count);
  }
  std::optional<double> mean(double target) const {
    const auto at = cells_.find(target);
    if (at == cells_.end()) return std::nullopt;
    return at->second.sum / at->second.count;
  }
  /// Readings behind a mean, at most targets.
  double depth() const {
    double count = 0.0;
    for (const auto& one : cells_) count += one.second.count;
    return cells_.empty() ? 1.0 : count / static_cast<double>(cells_.size());
  }
  /// Sum of squares about the means, and its degrees of freedom.
  std::pair<double, double> scatter() const {
    double sum = 0.0, freedom = 0.0;
    for (const auto& [target, cell] : cells_) {
      if (cell.count < 1.5) continue;
      sum += std::max(0.0, cell.squares - cell.sum * cell.sum / cell.count);
      freedom += cell.count - 1.0;
    }
    return {sum, freedom};
  }

 private:
  struct Cell {
    double count = 0.0, sum = 0.0, squares = 0.0;
  };
  std::map<double, Cell> cells_;
};

/// What makes `one` the same curve as `other`: nothing, its other end first, its other sign.
enum class Turned { not_at_all, order, sign };

/// Sums of squares of what is left between two curves: as they are, turned round, turned over.
struct Likeness {
  double same = 0.0, order = 0.0, sign = 0.0;
};

Likeness likeness(const std::vector<double>& a, const std::vector<double>& b,
                  const std::vector<double>& from_the_end) {
  Likeness out;
  for (std::size_t i = 0; i < a.size(); ++i) {
    out.same += (a[i] - b[i]) * (a[i] - b[i]);
    out.order += (from_the_end[i] - b[i]) * (from_the_end[i] - b[i]);
    out.sign += (a[i] + b[i]) * (a[i] + b[i]);
  }
  return out;
}

Turned turned(const Curve& one, const Curve& other, double step) {
  constexpr std::size_t fewest = 7;
  std::vector<double> at, a, b;
  one.each([&](double target, double mean) {
    const auto there = other.mean(target);
    if (!there) return;
    at.push_back(target);
    a.push_back(mean);
    b.push_back(*there);
  });
  if (at.size() < fewest) return Turned::not_at_all;
  const auto [own, own_freedom] = one.scatter();
  const auto [sum, freedom] = other.scatter();
  if (own_freedom + freedom <= 0.0) return Turned::not_at_all;
  const double s = std::max(std::sqrt((own + sum) / (own_freedom + freedom)), step);
  const double noise = s * s * (1.0 / one.depth() + 1.0 / other.depth());
  std::vector<double> from_the_end(a.rbegin(), a.rend());
  take_line_out(at, a);
  take_line_out(at, b);
  take_line_out(at, from_the_end);
  const Likeness whole = likeness(a, b, from_the_end);
  // What the first reading of each pass alone has (a slide that sticks) is at both ends too.
  const auto inner = [](std::vector<double>& v) { v.erase(v.begin()), v.pop_back(); };
  inner(at), inner(a), inner(b), inner(from_the_end);
  take_line_out(at, a), take_line_out(at, b), take_line_out(at, from_the_end);
  const Likeness within = likeness(a, b, from_the_end);
  const auto n = static_cast<double>(at.size() + 2);
  const auto fits = [&](double sum_of_squares, double sum_within) {
    return whole.same > 12.0 * sum_of_squares && sum_of_squares < 6.0 * noise * n &&
           whole.same > 20.0 * noise * n && within.same > 3.0 * sum_within;
  };
  return fits(whole.order, within.order) ? Turned::order
         : fits(whole.sign, within.sign) ? Turned::sign
                                         : Turned::not_at_all;
}

void push_turned(Turned how, const std::string& which, std::vector<Finding>& out) {
  if (how == Turned::not_at_all) return;
  out.push_back({.id = how == Turned::order ? "plausibility.pass-order-turned"
                                            : "plausibility.pass-sign-turned",
                 .attention = true,
                 .texts = {{"which", which}}});
}

/// What the curves of both directions allow besides a mistake in the file.
enum class Opposed { no_mistake, either, mistake };

/// A direction that was turned as a whole differs from the other as a reversal does that varies along the
/// axis. A mistake turns the slope too: a slope in common refutes it. What is left of the mean curve then
/// is nothing (sign), so a drive that winds up explains it as well; or it is even about the middle (order)
/// while the reversal is odd, which only a mistake explains, unless the mean curve is nothing or a whole
/// turn, where an eccentricity is even too.
Opposed opposed(const Curve& minus, const Curve& plus, Turned how, double step, bool rotary) {
  std::vector<double> a, b;
  minus.each([&](double target, double mean) {
    if (const auto there = plus.mean(target)) a.push_back(mean), b.push_back(*there);
  });
  const auto [sum_a, freedom_a] = minus.scatter();
  const auto [sum_b, freedom_b] = plus.scatter();
  const double s = std::max(std::sqrt((sum_a + sum_b) / (freedom_a + freedom_b)), step);
  const double noise = s * s * (1.0 / minus.depth() + 1.0 / plus.depth());
  const auto n = static_cast<double>(a.size());
  const auto about_mean = [&](const auto& value) {
    double sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += value(i), squares += value(i) * value(i);
    return squares - sum * sum / n;
  };
  const bool order = how == Turned::order;
  const double turned_back =
      about_mean([&](std::size_t i) { return (order ? a[a.size() - 1 - i] : -a[i]) - b[i]; });
  if (turned_back > 6.0 * noise * n) return Opposed::no_mistake;
  const double in_common = about_mean([&](std::size_t i) { return a[i] + b[i]; });
  return order && !rotary && in_common > 20.0 * noise * n ? Opposed::mistake : Opposed::either;
}

/// One pass against the others of its direction; else all of one direction against the other.
void turned_passes(const Passes& passes, bool rotary, std::vector<Finding>& out) {
  const auto& [strokes, step] = passes;
  std::map<int, Curve> by_direction;
  for (const Stroke& s : strokes) by_direction[s.direction].add(s);
  for (const Stroke& own : strokes) {
    Curve one;
    one.add(own);
    const Turned how = turned(one, by_direction[own.direction].without(own), step);
    if (how != Turned::not_at_all) return push_turned(how, name_of(own), out);
  }
  const Turned how = turned(by_direction[-1], by_direction[1], step);
  if (how == Turned::not_at_all) return;
  const Opposed kind = opposed(by_direction[-1], by_direction[1], how, step, rotary);
  if (kind == Opposed::mistake) push_turned(how, "-", out);
  if (kind == Opposed::either) out.push_back({.id = "plausibility.directions-opposed"});
}

/// Standard deviation about the median without the two readings farthest off it.
double size_of(const Stroke& s) {
  std::vector<double> values = s.deviation;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  const double median = *middle;
  for (double& v : values) v = std::fabs(v - median);
  std::sort(values.begin(), values.end());
  values.resize(values.size() - 2);
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// A pass whose deviations are of another order of magnitude than those of the others.
void another_size(const Passes& passes, Quantity deviation, std::vector<Finding>& out) {
  constexpr std::size_t fewest_readings = 6, fewest_passes = 3;
  constexpr double ratio = 8.0, chance = 1e-7;
  std::vector<std::pair<double, const Stroke*>> sizes;
  for (const Stroke& s : passes.strokes)
    if (s.deviation.size() >= fewest_readings) sizes.emplace_back(size_of(s), &s);
  if (sizes.size() < fewest_passes) return;
  std::vector<double> all;
  for (const auto& one : sizes) all.push_back(one.first);
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  const double others = *middle, step = passes.step;
  if (step <= 0.0) return;
  for (const auto& [size, s] : sizes) {
    const double larger = std::max(size, others), smaller = std::min(size, others);
    if (larger < 10.0 * step || larger < ratio * smaller) continue;
    // As little scatter as that by chance: of so many readings without a curve of their own.
    const auto freedom = static_cast<double>(s->deviation.size()) - 3.0;
    if (std::pow(smaller / larger, freedom) * static_cast<double>(sizes.size()) > chance) continue;
    return out.push_back({.id = "plausibility.pass-of-another-size",
                          .attention = true,
                          .evidence = {{"size", size, deviation}, {"others", others, deviation}},
                          .texts = {{"which", name_of(*s)}}});
  }
}

}  // namespace

void implausible_passes(const Passes& passes, const Observations& o, bool with_directions,
                        std::vector<Finding>& out) {
  implausible_copies(passes, o, out);
  if (!with_directions || o.lines.size() > 1) return;
  const Quantity deviation = o.angular ? Quantity::angular_deviation : Quantity::deviation;
  against_order(passes.strokes, out);
  implausible_values(passes, o, out);
  const std::size_t before = out.size();
  swapped(passes, deviation, out);
  if (out.size() == before) turned_passes(passes, o.angular, out);
  another_size(passes, deviation, out);
  if (out.size() == before && o.size() <= most_sorted) implausible_halves(passes, o.angular, out);
}

}  // namespace nonio::host::reading
