// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/triples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <random>
#include <tuple>

namespace nonio::math::triples_test {
namespace {

TripleRequest wish(double x_mm, double y_mm, double largest_step_mm = 0.0) {
  TripleRequest w;
  w.x = x_mm / 1e3;
  w.y = y_mm / 1e3;
  w.largest_step = largest_step_mm / 1e3;
  return w;
}

TriplePlans planned(const TripleRequest& w) {
  auto plans = plan_triples(w);
  EXPECT_TRUE(plans) << (plans ? "" : plans.error().message);
  return plans ? *plans : TriplePlans();
}

// Found by trying every pair of legs, not by Euclid's formula.
std::vector<Triple> searched_triples(std::int64_t hypotenuse) {
  std::vector<Triple> all;
  for (std::int64_t a = 1; a <= hypotenuse; ++a)
    for (std::int64_t b = a; a * a + b * b <= hypotenuse * hypotenuse; ++b) {
      const auto c = static_cast<std::int64_t>(std::llround(std::sqrt(a * a + b * b)));
      if (c * c == a * a + b * b && std::gcd(a, b) == 1) all.push_back({a, b, c});
    }
  std::sort(all.begin(), all.end(), [](const Triple& t, const Triple& o) {
    return std::tie(t.c, t.a) < std::tie(o.c, o.a);
  });
  return all;
}

TEST(Triples, FortySevenPrimitiveOnesBelow300) {
  const auto triples = primitive_triples(299);
  EXPECT_EQ(triples.size(), 47u);
  const auto searched = searched_triples(299);
  ASSERT_EQ(searched.size(), triples.size());
  for (std::size_t i = 0; i < triples.size(); ++i)
    EXPECT_EQ(std::tie(triples[i].a, triples[i].b, triples[i].c),
              std::tie(searched[i].a, searched[i].b, searched[i].c));
}

TEST(Triples, RatiosOfTheLegs) {
  std::vector<double> ratio;
  for (const Triple& t : primitive_triples(299))
    ratio.push_back(static_cast<double>(t.b) / static_cast<double>(t.a));
  const auto [least, most] = std::minmax_element(ratio.begin(), ratio.end());
  EXPECT_NEAR(*least, 120.0 / 119.0, 5e-4);
  EXPECT_NEAR(*most, 264.0 / 23.0, 5e-4);
  for (const auto& [a, b, c] : {std::tuple{3, 4, 5}, std::tuple{33, 56, 65},
                                std::tuple{96, 247, 265}, std::tuple{28, 45, 53}}) {
    const auto triples = primitive_triples(c);
    EXPECT_TRUE(std::any_of(triples.begin(), triples.end(), [&, &a = a, &b = b, &c = c](auto& t) {
      return t.a == a && t.b == b && t.c == c;
    })) << a;
  }
}

struct Row {
  const char* name;
  TripleRequest wish;
  std::int64_t a, b, c, q, n;
  double cover_x, cover_y;
};

std::vector<Row> rows() {
  TripleRequest tenth = wish(4000, 4000, 250);
  tenth.resolution = 1e-4;
  TripleRequest over = wish(20000, 12000, 250);
  over.over_travel = 0.1;
  over.max_points = 100;
  over.pitch_x = over.pitch_y = {0.02};
  over.even = EvenSteps::require;
  TripleRequest table41 = wish(14500, 9000, 500);
  table41.max_points = 41;
  TripleRequest table31 = wish(12000, 9000, 500);
  table31.max_points = 31;
  return {{"4 x 4 m", wish(4000, 4000, 250), 119, 120, 169, 1, 33, .9818, .9900},
          {"4 x 4 m, 0.1 mm", tenth, 696, 697, 985, 3, 19, .9918, .9932},
          {"19760 x 7680", wish(19760, 7680, 500), 247, 96, 265, 2, 40, 1, 1},
          {"20 x 12 m, 500", wish(20000, 12000, 500), 299, 180, 349, 1, 66, .9867, .9900},
          {"20 x 12 m, 100 over", over, 56, 33, 65, 4, 88, .9956, .9844},
          {"14.5 x 9 m", table41, 45, 28, 53, 10, 32, .9931, .9956},
          {"12 x 9 m", table31, 4, 3, 5, 125, 24, 1, 1}};
}

TEST(Triples, PlansAreThoseOfTheTable) {
  for (const Row& row : rows()) {
    const auto plans = planned(row.wish).plans;
    ASSERT_FALSE(plans.empty()) << row.name;
    const TriplePlan& p = plans.front();
    EXPECT_EQ(std::tie(p.a, p.b, p.c), std::tie(row.a, row.b, row.c)) << row.name;
    EXPECT_EQ(p.q, row.q) << row.name;
    EXPECT_EQ(p.n, row.n) << row.name;
    EXPECT_NEAR(p.cover_x, row.cover_x, 5e-5) << row.name;
    EXPECT_NEAR(p.cover_y, row.cover_y, 5e-5) << row.name;
    EXPECT_EQ(p.reasons.front(), TripleReason::best);
  }
}

TEST(Triples, FinerStepsOfTheSameTable) {
  // 20 x 12 m, steps up to 250 mm.
  const TriplePlan p = planned(wish(20000, 12000, 250)).plans.front();
  EXPECT_EQ(std::tuple(p.a, p.b, p.c, p.q, p.n), std::tuple(56, 33, 65, 3, 119));
  EXPECT_NEAR(p.step_x, 0.168, 1e-12);
  EXPECT_NEAR(p.step_y, 0.099, 1e-12);
  EXPECT_NEAR(p.step_d, 0.195, 1e-12);
  EXPECT_NEAR(p.cover_x, .9996, 5e-5);
  EXPECT_NEAR(p.cover_y, .9818, 5e-5);
}

bool has(const TriplePlans& plans, TripleReason reason, std::int64_t a, std::int64_t q,
         std::int64_t n) {
  return std::any_of(plans.plans.begin(), plans.plans.end(), [&](const TriplePlan& p) {
    return std::find(p.reasons.begin(), p.reasons.end(), reason) != p.reasons.end() && p.a == a &&
           p.q == q && p.n == n;
  });
}

TEST(Triples, OthersWithTheirReasons) {
  TripleRequest w = wish(20000, 12000, 500);
  w.count = 10;
  const TriplePlans plans = planned(w);
  EXPECT_EQ(plans.plans.size(), 10u);
  // 392 / 231 / 455 mm: the plan of the printed table, with round numbers and fewer stops.
  EXPECT_TRUE(has(plans, TripleReason::next, 56, 7, 51) ||
              has(plans, TripleReason::area, 56, 7, 51));
  for (const TriplePlan& p : plans.plans) {
    EXPECT_FALSE(p.reasons.empty());
    for (const TripleReason r : p.reasons)
      if (r == TripleReason::fewest_stops || r == TripleReason::small_numbers) {
        EXPECT_GE(p.worst_cover(), near_best * plans.plans.front().worst_cover());
      }
  }
}

TEST(Triples, TheSampleOfTwelveByNineMetres) {
  // 400 / 300 / 500 mm, n = 30 covers as much as n = 24 with 500 mm, which needs fewer stops.
  TripleRequest w = wish(12000, 9000, 400);
  const TriplePlan p = planned(w).plans.front();
  EXPECT_EQ(std::tuple(p.a, p.b, p.c, p.q, p.n), std::tuple(4, 3, 5, 100, 30));
}

TEST(Triples, NoiseGains) {
  const TriplePlan square = planned(wish(12000, 9000, 500)).plans.front();
  EXPECT_NEAR(square.gain_EYX(), 1 / 1.2, 1e-12);
  EXPECT_NEAR(square.gain_EXY(), 1 / 1.6, 1e-12);
  EXPECT_NEAR(square.gain_EYX_even(), 1.02, 5e-3);
  EXPECT_NEAR(square.gain_EXY_even(), 0.77, 5e-3);
  EXPECT_FALSE(square.flat());
  const TriplePlan longer = planned(wish(19760, 7680, 500)).plans.front();
  EXPECT_NEAR(longer.gain_EYX_even(), 1.69, 5e-3);
  EXPECT_NEAR(longer.gain_EXY_even(), 0.66, 5e-3);
  EXPECT_TRUE(planned(wish(20000, 2000, 500)).plans.front().flat());
}

// ---- the planner against a search that tries everything

struct Problem {
  TripleRequest wish;
  std::int64_t ux, uy, unit, step, most_n, pitch_x, pitch_y;  // mm
};

Problem random_problem(std::mt19937_64& random) {
  const auto from = [&](std::int64_t a, std::int64_t b) {
    return a + static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(b - a + 1));
  };
  Problem p{};
  const std::int64_t over = from(0, 2) * 10;
  p.ux = from(60, 3000), p.uy = from(60, 3000);
  p.unit = from(1, 3);
  p.step = from(0, 3) == 0 ? 0 : from(20, 600);
  p.most_n = from(4, 60);
  p.pitch_x = from(0, 1) * from(2, 12), p.pitch_y = from(0, 1) * from(2, 12);
  TripleRequest& w = p.wish;
  w = wish(static_cast<double>(p.ux + 2 * over), static_cast<double>(p.uy + 2 * over),
           static_cast<double>(p.step));
  w.over_travel = static_cast<double>(over) / 1e3;
  w.resolution = static_cast<double>(p.unit) / 1e3;
  w.max_points = p.most_n + 1;
  if (p.pitch_x > 0) w.pitch_x = {static_cast<double>(p.pitch_x) / 1e3};
  if (p.pitch_y > 0) w.pitch_y = {static_cast<double>(p.pitch_y) / 1e3};
  w.density = from(0, 3) == 0;
  w.even = from(0, 2) == 0 ? EvenSteps::require : EvenSteps::any;
  w.hypotenuse = 300;
  return p;
}

/// ISO 230-2 as a person reads it, in mm.
bool sampled(std::int64_t n, std::int64_t step, std::int64_t travel) {
  return travel > 2000 ? step <= 250 : 1000 * (n + 1) >= 5 * travel && n + 1 >= 5;
}

bool keeps(const Problem& p, std::int64_t a, std::int64_t b, std::int64_t q, std::int64_t n) {
  const std::int64_t x = q * a * p.unit, y = q * b * p.unit;
  return n >= 4 && n <= p.most_n && n * x <= p.ux && n * y <= p.uy &&
         (p.step == 0 || (x <= p.step && y <= p.step)) && (p.pitch_x == 0 || x % p.pitch_x != 0) &&
         (p.pitch_y == 0 || y % p.pitch_y != 0) &&
         (p.wish.even != EvenSteps::require || n % 2 == 0) &&
         (!p.wish.density || (sampled(n, x, p.ux) && sampled(n, y, p.uy)));
}

/// -worst coverage, -area, n, c, a: the smallest is the best. Exact: over the common ux uy.
using Key = std::array<std::int64_t, 5>;

Key key_of(const Problem& p, const Triple& t, std::int64_t q, std::int64_t n) {
  const std::int64_t x = n * q * t.a * p.unit, y = n * q * t.b * p.unit;
  return {-std::min(x * p.uy, y * p.ux), -x * y, n, t.c, t.a};
}

std::optional<Key> tried_all(const Problem& p, const std::vector<Triple>& triples) {
  std::optional<Key> best;
  for (const Triple& one : triples)
    for (const Triple& t : {one, Triple{one.b, one.a, one.c}})
      for (std::int64_t q = 1; q * t.a * p.unit * 4 <= p.ux && q * t.b * p.unit * 4 <= p.uy; ++q)
        for (std::int64_t n = 4; n <= p.most_n; ++n)
          if (keeps(p, t.a, t.b, q, n) && (!best || key_of(p, t, q, n) < *best))
            best = key_of(p, t, q, n);
  return best;
}

TEST(Triples, AsASearchThatTriesEverything) {
  constexpr std::uint64_t seed = 20261121;
  std::mt19937_64 random(seed);
  const auto triples = searched_triples(300);
  int found = 0, nothing = 0;
  for (int i = 0; i < 400; ++i) {
    const Problem p = random_problem(random);
    SCOPED_TRACE("seed " + std::to_string(seed) + ", problem " + std::to_string(i));
    const TriplePlans plans = planned(p.wish);
    const auto best = tried_all(p, triples);
    ASSERT_EQ(best.has_value(), !plans.plans.empty());
    if (!best) {
      ++nothing;
      EXPECT_FALSE(plans.blocked_by.empty() && plans.together.empty());
      continue;
    }
    ++found;
    const TriplePlan& first = plans.plans.front();
    EXPECT_EQ(key_of(p, {first.a, first.b, first.c}, first.q, first.n), *best);
    for (const TriplePlan& plan : plans.plans) {
      EXPECT_TRUE(keeps(p, plan.a, plan.b, plan.q, plan.n)) << plan.a << " " << plan.b;
      EXPECT_GE(key_of(p, {plan.a, plan.b, plan.c}, plan.q, plan.n), *best);
      EXPECT_EQ(plan.dense, sampled(plan.n, plan.q * plan.a * p.unit, p.ux) &&
                                sampled(plan.n, plan.q * plan.b * p.unit, p.uy));
    }
  }
  EXPECT_GT(found, 100);
  EXPECT_GT(nothing, 20);
}

TEST(Triples, AnEvenPlanIsPreferredToALittleMore) {
  TripleRequest w = wish(12000, 9000, 480);
  EXPECT_EQ(planned(w).plans.front().n, 25);
  w.even = EvenSteps::prefer;
  EXPECT_EQ(planned(w).plans.front().n, 30);  // covers as much
  w = wish(4000, 4000, 250);                  // the best even one covers 0.03 less
  w.even = EvenSteps::prefer;
  EXPECT_EQ(planned(w).plans.front().n, 33);
}

TEST(Triples, WhatBlocksEveryPlanIsNamed) {
  const auto blocked = [](const TripleRequest& w) {
    const TriplePlans plans = planned(w);
    EXPECT_TRUE(plans.plans.empty());
    return plans.blocked_by;
  };
  using Limits = std::vector<TripleLimit>;
  EXPECT_EQ(blocked(wish(11, 11)), Limits{TripleLimit::travel});
  EXPECT_EQ(blocked(wish(4000, 4000, 3.5)), Limits{TripleLimit::largest_step});
  TripleRequest every = wish(4000, 4000);
  every.pitch_x = {1e-3};
  EXPECT_EQ(blocked(every), Limits{TripleLimit::pitch});
  TripleRequest points = wish(1900, 300);  // ten targets at least
  points.density = true;
  points.max_points = 6;
  EXPECT_EQ(blocked(points), (Limits{TripleLimit::max_points, TripleLimit::density}));
  TripleRequest even = wish(1200, 300);  // six targets, so five steps
  even.density = true;
  even.max_points = 6;
  even.even = EvenSteps::require;
  EXPECT_EQ(blocked(even),
            (Limits{TripleLimit::max_points, TripleLimit::density, TripleLimit::even}));
  TripleRequest small = wish(4000, 4000);
  small.hypotenuse = 5;
  small.pitch_x = {3e-3, 4e-3};
  EXPECT_EQ(blocked(small), (Limits{TripleLimit::pitch, TripleLimit::hypotenuse}));
}

TEST(Triples, LimitsThatOnlyTogetherLeaveNothing) {
  TripleRequest w = wish(4000, 4000, 3.5);
  w.pitch_x = {1e-3};
  const TriplePlans plans = planned(w);
  EXPECT_TRUE(plans.plans.empty());
  EXPECT_TRUE(plans.blocked_by.empty());
  EXPECT_NE(std::find(plans.together.begin(), plans.together.end(), TripleLimit::largest_step),
            plans.together.end());
  EXPECT_NE(std::find(plans.together.begin(), plans.together.end(), TripleLimit::pitch),
            plans.together.end());
}

TEST(Triples, BadWishesAreRefused) {
  const auto refused = [](const TripleRequest& w) {
    const auto plans = plan_triples(w);
    return plans ? std::string("accepted") : plans.error().message;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double x : {0.0, -1.0, nan, std::numeric_limits<double>::infinity(), 2e6})
    EXPECT_EQ(refused(wish(x, 1000)).find("travel of X: expected"), 0u) << x;
  EXPECT_EQ(refused(wish(1000, -3)).find("travel of Y: expected"), 0u);
  TripleRequest w = wish(1000, 500);
  w.over_travel = 0.25;
  EXPECT_EQ(refused(w), "over-travel: 250 mm at each end leave nothing of 500 mm of Y");
  w.over_travel = -0.1;
  EXPECT_EQ(refused(w).find("over-travel: expected"), 0u);
  for (const double r : {0.0, -1e-3, 1e-10, nan}) {
    w = wish(1000, 500);
    w.resolution = r;
    EXPECT_EQ(refused(w).find("resolution: expected"), 0u) << r;
  }
  w = wish(1000, 500);
  w.largest_step = nan;
  EXPECT_EQ(refused(w).find("largest step: expected"), 0u);
  w = wish(1000, 500);
  w.max_points = 4;
  EXPECT_EQ(refused(w).find("points of the table: expected 5"), 0u);
  w = wish(1000, 500);
  w.pitch_y = {0.0};
  EXPECT_EQ(refused(w).find("pitch of Y: expected"), 0u);
  w = wish(1000, 500);
  w.count = 0;
  EXPECT_EQ(refused(w).find("number of plans: expected"), 0u);
  w = wish(1000, 500);
  w.hypotenuse = 4;
  EXPECT_EQ(refused(w).find("largest hypotenuse: expected"), 0u);
}

TEST(Triples, AnEndlessSearchIsRefusedBeforeItBegins) {
  TripleRequest w = wish(20000, 12000);
  w.resolution = 1e-9;
  w.max_points = 1'000'000;
  w.hypotenuse = 1'000'000;
  const auto plans = plan_triples(w);
  ASSERT_FALSE(plans);
  EXPECT_NE(plans.error().message.find("give a coarser resolution"), std::string::npos);
}

}  // namespace
}  // namespace nonio::math::triples_test
