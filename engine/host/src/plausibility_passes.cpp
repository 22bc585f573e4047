// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "plausibility.h"

namespace nonio::host {
namespace {

/// The readings that one direction of one run took along one line, in the order of the file.
struct Stroke {
  std::uint32_t line = 0, run = 0;
  int direction = 0;
  std::vector<double> target, deviation;
  std::size_t first = 0, last = 0;  ///< rows in the order in which they were taken
  int sense = 0;                    ///< +1: targets rise, -1: they fall; 0: neither
  bool alone = false;               ///< no row of another stroke between its own
};

/// Rows in the order in which they were taken: by their times, if all have one, else as they stand.
std::vector<std::size_t> order_of(const Observations& o) {
  std::vector<std::size_t> order(o.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto known = [](double t) { return std::isfinite(t); };
  if (!o.time.empty() && std::all_of(o.time.begin(), o.time.end(), known))
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return o.time[a] < o.time[b]; });
  else if (!o.source_line.empty())
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return o.source_line[a] < o.source_line[b];
    });
  return order;
}

int sense_of_targets(const std::vector<double>& targets) {
  bool rises = targets.size() > 1, falls = rises;
  for (std::size_t i = 1; i < targets.size(); ++i) {
    rises &= targets[i] > targets[i - 1];
    falls &= targets[i] < targets[i - 1];
  }
  return rises ? 1 : falls ? -1 : 0;
}

std::vector<Stroke> strokes_of(const Observations& o) {
  std::map<std::tuple<std::uint32_t, std::uint32_t, int>, std::size_t> known;
  std::vector<Stroke> strokes;
  const auto order = order_of(o);
  const auto& axis = o.axes.front();
  for (std::size_t at = 0; at < order.size(); ++at) {
    const std::size_t i = order[at];
    const int direction = axis.approach.empty() ? 0 : axis.approach[i];
    const auto [found, is_new] =
        known.try_emplace({o.line_of(i), o.run_of(i), direction}, strokes.size());
    if (is_new) {
      Stroke& fresh = strokes.emplace_back();
      fresh.line = o.line_of(i);
      fresh.run = o.run_of(i);
      fresh.direction = direction;
      fresh.first = at;
    }
    Stroke& s = strokes[found->second];
    s.last = at;
    s.target.push_back(axis.position[i]);
    s.deviation.push_back(o.deviation[i]);
  }
  for (Stroke& s : strokes) {
    s.alone = s.last - s.first + 1 == s.target.size();
    s.sense = sense_of_targets(s.target);
    // From here on by target: a copy is one whatever way it was gone.
    std::vector<std::pair<double, double>> rows;
    for (std::size_t i = 0; i < s.target.size(); ++i)
      rows.emplace_back(s.target[i], s.deviation[i]);
    std::stable_sort(rows.begin(), rows.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t i = 0; i < rows.size(); ++i)
      s.target[i] = rows[i].first, s.deviation[i] = rows[i].second;
  }
  return strokes;
}

std::string name_of(const Stroke& s) {
  std::string name = std::to_string(s.run);
  if (s.direction != 0) name += s.direction > 0 ? " +" : " -";
  return name;
}

/// The smallest difference of two readings that are not the same; 0 if all are.
double step_of(const std::vector<Stroke>& strokes) {
  std::vector<double> all;
  for (const Stroke& s : strokes) all.insert(all.end(), s.deviation.begin(), s.deviation.end());
  std::sort(all.begin(), all.end());
  double step = 0.0;
  for (std::size_t i = 1; i < all.size(); ++i) {
    const double d = all[i] - all[i - 1];
    if (d > 1e-12 && (step == 0.0 || d < step)) step = d;
  }
  // Few readings may all lie far apart: then the decimals say what the digits are.
  constexpr double finest = 1e-10;
  for (double grid = 1e-6; grid > finest; grid /= 10.0)
    if (std::all_of(all.begin(), all.end(),
                    [&](double d) { return std::fabs(d / grid - std::round(d / grid)) < 1e-4; }))
      return step > 0.0 ? std::min(step, grid) : 0.0;
  return step;
}

/// Passes that agree to the last digit. How likely that is by chance: each reading agrees with
/// q / (s sqrt(4 pi)), q the step of the digits and s the scatter of the other passes (at least
/// what no machine goes below).
class Copies {
 public:
  Copies(const std::vector<Stroke>& strokes, bool angular)
      : strokes_(strokes), least_scatter_(angular ? 0.01 * arcsec : 0.03 * um) {
    for (const Stroke& s : strokes) groups_[{s.line, s.target, s.deviation}].push_back(&s);
    step_ = step_of(strokes);
    scatter();
  }

  void find(Quantity deviation, std::vector<Finding>& out) const {
    constexpr double chance = 1e-7;
    if (nothing_scatters()) {
      out.push_back({.id = std::string(no_scatter),
                     .attention = true,
                     .evidence = {{"passes", static_cast<double>(strokes_.size()), Quantity::count},
                                  {"step", step_, deviation}}});
      return;
    }
    for (const auto& [what, same] : groups_) {
      if (same.size() < 2) continue;
      const auto n = static_cast<double>(std::get<2>(what).size());
      const auto [low, high] =
          std::minmax_element(std::get<2>(what).begin(), std::get<2>(what).end());
      if (*low == *high) continue;  // nothing was read at all: said elsewhere
      const double least = scatter_known_ ? least_scatter_ / 3.0 : least_scatter_;
      const double one = step_ / (std::max(scatter_, least) * 3.5449);
      const auto pairs = static_cast<double>(strokes_.size() * strokes_.size()) / 2.0;
      if (pairs * std::pow(std::min(one, 1.0), n) > chance) continue;
      std::string names;
      for (std::size_t i = 0; i < same.size() && i < most_named; ++i)
        names += (i == 0 ? "" : ", ") + name_of(*same[i]);
      if (same.size() > most_named) names += ", ...";
      out.push_back({.id = "plausibility.passes-identical",
                     .attention = true,
                     .evidence = {{"passes", static_cast<double>(same.size()), Quantity::count},
                                  {"readings", n, Quantity::count},
                                  {"step", step_, deviation}},
                     .texts = {{"which", names}}});
      return;
    }
  }

 private:
  static constexpr double um = 1e-6, arcsec = 1.0 / arcsec_per_rad;
  static constexpr std::size_t most_named = 6;

  /// Whether every pass agrees with all others of its direction, and the readings are not one.
  bool nothing_scatters() const {
    std::map<std::pair<std::uint32_t, int>, const Stroke*> first;
    std::size_t repeated = 0;
    for (const Stroke& s : strokes_) {
      const auto [at, is_new] = first.emplace(std::pair(s.line, s.direction), &s);
      if (is_new) continue;
      if (at->second->target != s.target || at->second->deviation != s.deviation) return false;
      ++repeated;
    }
    return repeated > 0 && step_ > 0.0;
  }

  /// Of the passes that are no copies, by target and direction, less the shift of each pass: two
  /// passes that follow one another share what drifts.
  void scatter() {
    std::map<std::tuple<std::uint32_t, int, double>, std::pair<double, double>>
        cells;  // sum, count
    for (const auto& one : groups_) {
      const Stroke& s = *one.second.front();
      for (std::size_t i = 0; i < s.target.size(); ++i) {
        auto& cell = cells[{s.line, s.direction, s.target[i]}];
        cell.first += s.deviation[i];
        cell.second += 1.0;
      }
    }
    double sum = 0.0, freedom = 0.0;
    for (const auto& one : groups_) {
      const Stroke& s = *one.second.front();
      std::vector<double> left;
      double shift = 0.0;
      for (std::size_t i = 0; i < s.target.size(); ++i) {
        const auto& cell = cells.at({s.line, s.direction, s.target[i]});
        if (cell.second > 1.0) left.push_back(s.deviation[i] - cell.first / cell.second);
      }
      for (const double d : left) shift += d / static_cast<double>(left.size());
      for (const double d : left) sum += (d - shift) * (d - shift);
      if (left.size() > 1) freedom += static_cast<double>(left.size()) - 1.0;
    }
    scatter_known_ = freedom > 0.0;
    if (scatter_known_) scatter_ = std::sqrt(sum / freedom);
  }

  const std::vector<Stroke>& strokes_;
  double least_scatter_, step_ = 0.0, scatter_ = 0.0;
  bool scatter_known_ = false;
  std::map<std::tuple<std::uint32_t, std::vector<double>, std::vector<double>>,
           std::vector<const Stroke*>>
      groups_;
};

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
void swapped(const std::vector<Stroke>& strokes, Quantity deviation, std::vector<Finding>& out) {
  const Reversals all = reversals_of(strokes);
  const double step = step_of(strokes);
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

}  // namespace

void implausible_passes(const Observations& o, bool with_directions, std::vector<Finding>& out) {
  const auto strokes = strokes_of(o);
  const Quantity deviation = o.angular ? Quantity::angular_deviation : Quantity::deviation;
  Copies(strokes, o.angular).find(deviation, out);
  if (!with_directions || o.lines.size() > 1) return;
  against_order(strokes, out);
  swapped(strokes, deviation, out);
}

/// The decimals of the last number against those of the same column in the lines before it.
std::vector<Finding> implausible_end(std::string_view bytes, const std::string& file) {
  if (bytes.empty() || bytes.back() == '\n' || bytes.back() == '\r') return {};
  constexpr std::size_t window = 65536;
  if (bytes.size() > window) bytes = bytes.substr(bytes.size() - window);
  const auto last_field = [](std::string_view line, std::size_t& fields) {
    fields = 1 + static_cast<std::size_t>(std::count_if(line.begin(), line.end(), [](char c) {
               return c == ',' || c == ';' || c == '\t';
             }));
    const bool comma = line.find_first_of(";\t") == line.npos;
    const std::size_t at = line.find_last_of(comma ? "," : ";\t");
    return at == line.npos ? line : line.substr(at + 1);
  };
  const auto decimals = [](std::string_view number) -> std::ptrdiff_t {
    if (number.find_first_not_of("+-0123456789.,") != number.npos || number.empty()) return -1;
    const std::size_t point = number.find_first_of(".,");
    return point == number.npos ? 0 : static_cast<std::ptrdiff_t>(number.size() - point - 1);
  };
  std::vector<std::string_view> lines;
  while (!bytes.empty()) {
    const std::size_t at = bytes.rfind('\n');
    std::string_view line = at == bytes.npos ? bytes : bytes.substr(at + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    lines.push_back(line);
    bytes = at == bytes.npos ? std::string_view() : bytes.substr(0, at);
  }
  std::size_t own_fields = 0, fields = 0;
  const std::string_view own = last_field(lines.front(), own_fields);
  const std::ptrdiff_t digits = decimals(own);
  std::ptrdiff_t fewest = -1;
  std::size_t seen = 0;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::ptrdiff_t d = decimals(last_field(lines[i], fields));
    if (fields != own_fields || d < 0) continue;
    fewest = seen++ == 0 ? d : std::min(fewest, d);
  }
  const bool cut = own_fields > 1 && seen >= 3 && (digits < fewest || own == "-" || own == "+");
  if (!cut) return {};
  return {{.id = "plausibility.file-cut-short",
           .attention = true,
           .evidence = {{"digits", static_cast<double>(std::max<std::ptrdiff_t>(digits, 0)),
                         Quantity::count},
                        {"others", static_cast<double>(fewest), Quantity::count}},
           .texts = {{"file", file}, {"found", std::string(own)}}}};
}

}  // namespace nonio::host
