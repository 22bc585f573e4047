// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/triples.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <numeric>

#include "nonio/sdk/format.h"

namespace nonio::math {

namespace {

constexpr double per_metre = 1e9;         // the search uses integer nanometers
constexpr std::int64_t fewest_steps = 4;  // five points per axis
constexpr double longest_travel = 1e3;    // m; keeps every product far below the limit of 64 bits
constexpr std::int64_t largest_hypotenuse = 1'000'000;
constexpr std::int64_t most_points = 1'000'000;
// Coverage that an odd plan must exceed an even one by: docs/dev/constants.md, A10.
constexpr double even_bonus = 0.01;
const double even_part_gain = std::sqrt(6.0) / 4.0;

std::int64_t nanometres(double m) { return std::llround(m * per_metre); }

std::string mm(double m) {
  std::array<char, 40> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(),
                                 printed(m, Quantity::length), std::chars_format::fixed)
                       .ptr;
  return std::string(text.data(), end) + " mm";
}

/// Lengths, steps and pitches in nm; triples in both orders of their legs.
struct Search {
  std::int64_t ux = 0, uy = 0, unit = 0;
  std::int64_t of_x = 1, of_y = 1, of_d = 1;  // units of which the steps must be integer multiples
  std::int64_t step_x = 0, step_y = 0;
  std::int64_t least_n = fewest_steps, most_n = 0;
  std::vector<std::int64_t> pitch_x, pitch_y;
  bool even = false;
  std::vector<Triple> triples;
};

/// Limits of ISO 230-2 for the number of steps and for a step, m, of an axis of this length.
struct Sampling {
  std::int64_t steps = fewest_steps;
  double largest_step = 1e9;
};

Sampling sampling_of(double length) {
  if (length > 2.0) return {fewest_steps, 0.25};
  const auto targets = static_cast<std::int64_t>(std::ceil(5.0 * length - 1e-9));
  return {std::max(fewest_steps, targets - 1), 1e9};
}

bool is_sampling(std::int64_t n, double step, double length) {
  const Sampling s = sampling_of(length);
  return n >= s.steps && nanometres(step) <= nanometres(s.largest_step);
}

Search search_of(const TripleRequest& w) {
  Search s;
  const double ux = w.x - 2.0 * w.over_travel, uy = w.y - 2.0 * w.over_travel;
  s.ux = nanometres(ux);
  s.uy = nanometres(uy);
  const std::int64_t x = nanometres(w.resolution_x > 0.0 ? w.resolution_x : w.resolution),
                     y = nanometres(w.resolution_y > 0.0 ? w.resolution_y : w.resolution),
                     d = nanometres(w.resolution);
  s.unit = std::gcd(std::gcd(x, y), d);
  s.of_x = x / s.unit, s.of_y = y / s.unit, s.of_d = d / s.unit;
  s.most_n = w.max_points - 1;
  s.step_x = w.largest_step > 0.0 ? nanometres(w.largest_step) : s.ux;
  s.step_y = w.largest_step > 0.0 ? nanometres(w.largest_step) : s.uy;
  if (w.density) {
    const Sampling on_x = sampling_of(ux), on_y = sampling_of(uy);
    s.least_n = std::max(on_x.steps, on_y.steps);
    s.step_x = std::min(s.step_x, nanometres(on_x.largest_step));
    s.step_y = std::min(s.step_y, nanometres(on_y.largest_step));
  }
  for (const double p : w.pitch_x) s.pitch_x.push_back(nanometres(p));
  for (const double p : w.pitch_y) s.pitch_y.push_back(nanometres(p));
  s.even = w.even == EvenSteps::require;
  for (const Triple& t : primitive_triples(w.hypotenuse)) {
    s.triples.push_back(t);
    s.triples.push_back({t.b, t.a, t.c});
  }
  return s;
}

std::int64_t most_products(const Search& s, const Triple& t) {
  return std::min(s.ux / (t.a * s.unit), s.uy / (t.b * s.unit));
}

std::int64_t work(const Search& s) {
  std::int64_t sum = 0;
  for (const Triple& t : s.triples)
    sum += std::max<std::int64_t>(0, std::min(s.most_n, most_products(s, t)) - s.least_n + 1);
  return sum;
}

/// Returns the divisor of q with which each step is a multiple of its own resolution.
std::int64_t multiple_of(const Search& s, const Triple& t) {
  const auto of = [](std::int64_t k, std::int64_t leg) { return k / std::gcd(k, leg); };
  return std::lcm(std::lcm(of(s.of_x, t.a), of(s.of_y, t.b)), of(s.of_d, t.c));
}

bool is_multiple(std::int64_t step, const std::vector<std::int64_t>& pitches) {
  return std::any_of(pitches.begin(), pitches.end(),
                     [&](std::int64_t pitch) { return step % pitch == 0; });
}

/// Largest multiple of `m` up to `q` with which no step is a multiple of a pitch; 0 if there is
/// none.
std::int64_t with_pitch(const Search& s, const Triple& t, std::int64_t q, std::int64_t m) {
  // A pitch excludes every q, or every m-th q with m >= 2. Therefore, if any multiple is allowed,
  // one of a few consecutive multiples is allowed.
  const std::int64_t tries = 2 * static_cast<std::int64_t>(s.pitch_x.size() + s.pitch_y.size() + 1);
  q -= q % m;
  for (std::int64_t i = 0; q >= 1 && i <= tries * tries; ++i, q -= m)
    if (!is_multiple(q * t.a * s.unit, s.pitch_x) && !is_multiple(q * t.b * s.unit, s.pitch_y))
      return q;
  return 0;
}

struct Found {
  const Triple* triple;
  std::int64_t q, n;
};

/// Each plan has the largest step within the limits. The search ends when `take` returns true.
template <class Take>
void for_each_plan(const Search& s, const Take& take) {
  for (const Triple& t : s.triples) {
    const std::int64_t products = most_products(s, t);
    const std::int64_t q_step = std::min(s.step_x / (t.a * s.unit), s.step_y / (t.b * s.unit));
    if (q_step == 0) continue;
    const std::int64_t multiple = multiple_of(s, t);
    for (std::int64_t n = s.least_n; n <= std::min(s.most_n, products); ++n) {
      if (s.even && n % 2 != 0) continue;
      const std::int64_t q = with_pitch(s, t, std::min(products / n, q_step), multiple);
      if (q > 0 && take(Found{&t, q, n})) return;
    }
  }
}

bool anything(const TripleRequest& wish) {
  bool any = false;
  for_each_plan(search_of(wish), [&](const Found&) { return any = true; });
  return any;
}

TriplePlan plan_of(const Search& s, const Found& f, const TripleRequest& w) {
  TriplePlan p;
  p.a = f.triple->a, p.b = f.triple->b, p.c = f.triple->c;
  p.q = f.q, p.n = f.n;
  const double unit = static_cast<double>(s.unit) / per_metre;
  const auto metres = [&](std::int64_t multiple) { return static_cast<double>(multiple) * unit; };
  p.step_x = metres(p.q * p.a), p.step_y = metres(p.q * p.b), p.step_d = metres(p.q * p.c);
  p.length_x = metres(p.n * p.q * p.a);
  p.length_y = metres(p.n * p.q * p.b);
  p.length_d = metres(p.n * p.q * p.c);
  const double ux = w.x - 2.0 * w.over_travel, uy = w.y - 2.0 * w.over_travel;
  p.cover_x = p.length_x / ux, p.cover_y = p.length_y / uy;
  p.dense = is_sampling(p.n, p.step_x, ux) && is_sampling(p.n, p.step_y, uy);
  return p;
}

bool same_triple(const TriplePlan& p, const TriplePlan& o) {
  return p.c == o.c && std::min(p.a, p.b) == std::min(o.a, o.b);
}

bool same_plan(const TriplePlan& p, const TriplePlan& o) {
  return same_triple(p, o) && p.a == o.a && p.q == o.q && p.n == o.n;
}

class Best {
 public:
  using Before = std::function<bool(const TriplePlan&, const TriplePlan&)>;
  using Belongs = std::function<bool(const TriplePlan&)>;
  Best(TripleReason reason, Belongs belongs, Before before)
      : reason_(reason), belongs_(std::move(belongs)), before_(std::move(before)) {}
  void see(const TriplePlan& p) {
    if (belongs_(p) && (!plan_ || before_(p, *plan_))) plan_ = p;
  }
  TripleReason reason() const { return reason_; }
  const std::optional<TriplePlan>& plan() const { return plan_; }

 private:
  TripleReason reason_;
  Belongs belongs_;
  Before before_;
  std::optional<TriplePlan> plan_;
};

/// Keeps the first plans in the order of preference, one for each triple.
class Leaders {
 public:
  Leaders(std::size_t most, EvenSteps even) : most_(most), even_(even) {}
  void see(const TriplePlan& p) {
    if (list_.size() == most_ && !comes_before(p, list_.back(), even_)) return;
    for (auto it = list_.begin(); it != list_.end(); ++it)
      if (same_triple(*it, p)) {
        if (!comes_before(p, *it, even_)) return;
        list_.erase(it);
        break;
      }
    const auto place = std::find_if(list_.begin(), list_.end(),
                                    [&](const TriplePlan& o) { return comes_before(p, o, even_); });
    list_.insert(place, p);
    if (list_.size() > most_) list_.pop_back();
  }
  const std::vector<TriplePlan>& list() const { return list_; }

 private:
  std::size_t most_;
  EvenSteps even_;
  std::vector<TriplePlan> list_;
};

std::vector<Best> kinds(const TriplePlan& best, EvenSteps even) {
  const auto rank = [even](const TriplePlan& p, const TriplePlan& o) {
    return comes_before(p, o, even);
  };
  const auto near = [least = near_best * best.worst_cover()](const TriplePlan& p) {
    return p.worst_cover() >= least;
  };
  return {
      {TripleReason::area, [](const TriplePlan&) { return true; },
       [rank](const TriplePlan& p, const TriplePlan& o) {
         const double difference = p.area() / o.area() - 1.0;
         return std::fabs(difference) > 1e-12 ? difference > 0.0 : rank(p, o);
       }},
      {TripleReason::even, [](const TriplePlan& p) { return p.even(); }, rank},
      {TripleReason::dense, [](const TriplePlan& p) { return p.dense; }, rank},
      {TripleReason::fewest_stops, near,
       [rank](const TriplePlan& p, const TriplePlan& o) {
         return p.n != o.n ? p.n < o.n : rank(p, o);
       }},
      {TripleReason::small_numbers, near,
       [rank](const TriplePlan& p, const TriplePlan& o) {
         return p.c != o.c ? p.c < o.c : rank(p, o);
       }},
  };
}

void list(std::vector<TriplePlan>& plans, const TriplePlan& p, TripleReason why, std::size_t most) {
  for (TriplePlan& have : plans)
    if (same_plan(have, p)) {
      if (why != TripleReason::next) have.reasons.push_back(why);
      return;
    }
  if (plans.size() >= most) return;
  plans.push_back(p);
  plans.back().reasons = {why};
}

std::vector<TriplePlan> chosen(const Search& s, const TripleRequest& w) {
  Leaders leaders(w.count, w.even);
  for_each_plan(s, [&](const Found& f) {
    leaders.see(plan_of(s, f, w));
    return false;
  });
  if (leaders.list().empty()) return {};
  const TriplePlan best = leaders.list().front();
  std::vector<Best> others = kinds(best, w.even);
  for_each_plan(s, [&](const Found& f) {
    const TriplePlan p = plan_of(s, f, w);
    for (Best& b : others) b.see(p);
    return false;
  });
  std::vector<TriplePlan> plans;
  list(plans, best, TripleReason::best, w.count);
  for (const Best& b : others)
    if (b.plan()) list(plans, *b.plan(), b.reason(), w.count);
  for (const TriplePlan& p : leaders.list()) list(plans, p, TripleReason::next, w.count);
  std::stable_sort(plans.begin() + 1, plans.end(), [&](const TriplePlan& p, const TriplePlan& o) {
    return comes_before(p, o, w.even);
  });
  return plans;
}

/// Returns std::nullopt if the request has no such limit. max_points and hypotenuse become 20 times
/// as large.
std::optional<TripleRequest> without(TripleRequest w, TripleLimit limit) {
  bool had = true;
  switch (limit) {
    case TripleLimit::largest_step:
      had = w.largest_step > 0.0;
      w.largest_step = 0.0;
      break;
    case TripleLimit::max_points:
      w.max_points *= 20;
      break;
    case TripleLimit::pitch:
      had = !w.pitch_x.empty() || !w.pitch_y.empty();
      w.pitch_x.clear();
      w.pitch_y.clear();
      break;
    case TripleLimit::density:
      had = w.density;
      w.density = false;
      break;
    case TripleLimit::even:
      had = w.even == EvenSteps::require;
      w.even = EvenSteps::any;
      break;
    case TripleLimit::hypotenuse:
      had = w.hypotenuse < largest_hypotenuse;
      w.hypotenuse = std::min<std::int64_t>(largest_hypotenuse, 20 * w.hypotenuse);
      break;
    case TripleLimit::travel:
      had = false;
      break;
  }
  return had ? std::optional(w) : std::nullopt;
}

void explain_nothing(const TripleRequest& wish, TriplePlans& out) {
  TripleRequest free = wish;
  std::vector<TripleLimit> active;
  for (const auto limit : {TripleLimit::largest_step, TripleLimit::max_points, TripleLimit::pitch,
                           TripleLimit::density, TripleLimit::even, TripleLimit::hypotenuse}) {
    const auto relaxed = without(wish, limit);
    if (!relaxed) continue;
    active.push_back(limit);
    free = *without(free, limit);
    if (anything(*relaxed)) out.blocked_by.push_back(limit);
  }
  if (!out.blocked_by.empty()) return;
  if (anything(free))
    out.together = active;
  else
    out.blocked_by = {TripleLimit::travel};
}

std::string wrong_length(const char* what, double m, double least, double most) {
  // The comparison is false for NaN; the tolerance accepts 0.000001 mm, whatever its binary value.
  if (m >= least * (1.0 - 1e-9) && m <= most) return {};
  return std::string(what) + ": expected " + mm(least) + " to " + mm(most) + ", found " +
         (std::isfinite(m) ? mm(m) : "no number");
}

std::string wrong_count(const char* what, std::int64_t n, std::int64_t least, std::int64_t most) {
  if (n >= least && n <= most) return {};
  return std::string(what) + ": expected " + std::to_string(least) + " to " + std::to_string(most) +
         ", found " + std::to_string(n);
}

std::string wrong(const TripleRequest& w) {
  const double finest = 1.0 / per_metre;
  std::vector<std::string> all = {
      wrong_length("travel of X", w.x, finest, longest_travel),
      wrong_length("travel of Y", w.y, finest, longest_travel),
      wrong_length("over-travel", w.over_travel, 0.0, longest_travel),
      wrong_length("resolution", w.resolution, finest, longest_travel),
      wrong_count("points of the table", w.max_points, fewest_steps + 1, most_points),
      wrong_count("largest hypotenuse", w.hypotenuse, 5, largest_hypotenuse),
      wrong_count("number of plans", static_cast<std::int64_t>(w.count), 1, 1000)};
  for (const auto& [name, r] :
       {std::pair{"resolution of X", w.resolution_x}, {"resolution of Y", w.resolution_y}})
    if (r != 0.0) all.push_back(wrong_length(name, r, finest, longest_travel));
  if (w.largest_step != 0.0)
    all.push_back(wrong_length("largest step", w.largest_step, finest, longest_travel));
  for (const double p : w.pitch_x)
    all.push_back(wrong_length("pitch of X", p, finest, longest_travel));
  for (const double p : w.pitch_y)
    all.push_back(wrong_length("pitch of Y", p, finest, longest_travel));
  for (const std::string& one : all)
    if (!one.empty()) return one;
  for (const auto& [axis, travel] : {std::pair{"X", w.x}, std::pair{"Y", w.y}})
    if (travel - 2.0 * w.over_travel < finest)
      return std::string("over-travel: ") + mm(w.over_travel) + " at each end leave nothing of " +
             mm(travel) + " of " + axis;
  return {};
}

}  // namespace

std::vector<Triple> primitive_triples(std::int64_t hypotenuse) {
  std::vector<Triple> all;
  for (std::int64_t m = 2; m * m + 1 <= hypotenuse; ++m)
    for (std::int64_t k = 1 + m % 2; k < m && m * m + k * k <= hypotenuse; k += 2)
      if (std::gcd(m, k) == 1) {
        const std::int64_t one = m * m - k * k, other = 2 * m * k;
        all.push_back({std::min(one, other), std::max(one, other), m * m + k * k});
      }
  std::sort(all.begin(), all.end(),
            [](const Triple& t, const Triple& o) { return t.c != o.c ? t.c < o.c : t.a < o.a; });
  return all;
}

double TriplePlan::gain_EYX_even() const { return even_part_gain * length_d / length_y; }
double TriplePlan::gain_EXY_even() const { return even_part_gain * length_d / length_x; }

bool comes_before(const TriplePlan& one, const TriplePlan& other, EvenSteps even) {
  // Compare coverage to 1e-12, so that rounding does not order equal plans.
  const auto whole = [](double share) { return std::llround(share * 1e12); };
  const auto worst = [&](const TriplePlan& p) {
    const bool penalty = even == EvenSteps::prefer && !p.even();
    return whole(p.worst_cover()) - (penalty ? whole(even_bonus) : 0);
  };
  const auto key = [&](const TriplePlan& p) {
    return std::array<std::int64_t, 5>{-worst(p), -whole(p.cover_x * p.cover_y), p.n, p.c, p.a};
  };
  return key(one) < key(other);
}

double measuring_time(const TriplePlan& p, const MeasuringCost& cost) {
  const double way = p.length_x + p.length_y + 2.0 * p.length_d,
               stops = 4.0 * static_cast<double>(p.n + 1),
               passes = 2.0 * static_cast<double>(cost.runs);
  return passes * (way / cost.feed + stops * cost.dwell);
}

namespace {

Expected<Search> sound_search(const TripleRequest& wish) {
  if (std::string complaint = wrong(wish); !complaint.empty()) return fail(std::move(complaint));
  Search search = search_of(wish);
  const std::int64_t tried = work(search);
  if (tried > most_tried)
    return fail("the search would look at " + std::to_string(tried) + " plans, expected at most " +
                std::to_string(most_tried) +
                ": give a coarser resolution, fewer points or a smaller hypotenuse");
  return search;
}

}  // namespace

Expected<TriplePlans> plan_triples(const TripleRequest& wish) {
  NONIO_TRY(const auto search, sound_search(wish));
  TriplePlans out;
  out.tried = work(search);
  out.plans = chosen(search, wish);
  if (out.plans.empty()) explain_nothing(wish, out);
  return out;
}

Expected<std::vector<TriplePlan>> cheapest_plans(const TripleRequest& wish, double least_cover,
                                                 const MeasuringCost& cost) {
  NONIO_TRY(const auto search, sound_search(wish));
  std::vector<TriplePlan> plans;
  const Triple* of = nullptr;
  for_each_plan(search, [&](const Found& f) {
    const TriplePlan p = plan_of(search, f, wish);
    if (p.worst_cover() < least_cover) return false;
    if (of != f.triple) {
      plans.push_back(p);
    } else if (const double now = measuring_time(p, cost),
               best = measuring_time(plans.back(), cost);
               now < best) {
      plans.back() = p;
    }
    of = f.triple;
    return false;
  });
  return plans;
}

PointTable triple_table(const std::vector<TriplePlan>& plans) {
  PointTable rows;
  const auto column = [&](const char* name, Quantity quantity, auto value_of) {
    PointTable::Column c{name, quantity, {}};
    for (const TriplePlan& p : plans) c.values.push_back(static_cast<double>(value_of(p)));
    rows.columns.push_back(std::move(c));
  };
  using P = TriplePlan;
  column("a", Quantity::count, [](const P& p) { return p.a; });
  column("b", Quantity::count, [](const P& p) { return p.b; });
  column("c", Quantity::count, [](const P& p) { return p.c; });
  column("q", Quantity::count, [](const P& p) { return p.q; });
  column("n", Quantity::count, [](const P& p) { return p.n; });
  column("step_x", Quantity::length, [](const P& p) { return p.step_x; });
  column("step_y", Quantity::length, [](const P& p) { return p.step_y; });
  column("step_d", Quantity::length, [](const P& p) { return p.step_d; });
  column("length_x", Quantity::length, [](const P& p) { return p.length_x; });
  column("length_y", Quantity::length, [](const P& p) { return p.length_y; });
  column("length_d", Quantity::length, [](const P& p) { return p.length_d; });
  column("cover_x", Quantity::ratio, [](const P& p) { return p.cover_x; });
  column("cover_y", Quantity::ratio, [](const P& p) { return p.cover_y; });
  column("gain_EYX", Quantity::ratio, [](const P& p) { return p.gain_EYX(); });
  column("gain_EXY", Quantity::ratio, [](const P& p) { return p.gain_EXY(); });
  column("gain_EYX_even", Quantity::ratio, [](const P& p) { return p.gain_EYX_even(); });
  column("gain_EXY_even", Quantity::ratio, [](const P& p) { return p.gain_EXY_even(); });
  return rows;
}

}  // namespace nonio::math
