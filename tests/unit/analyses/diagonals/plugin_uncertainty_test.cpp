// SPDX-License-Identifier: Apache-2.0
// Uncertainties of the plugin: how often they cover the truth of the exact machine.
#include <iostream>

#include "workpiece.h"

namespace nonio::diagonal_test {
namespace {

/// Two lines of X; yaw by an autocollimator; diagonals from one direction; a third diagonal.
TEST(DiagonalPlugin, UncertaintiesFromTheScatterCoverTheTruth) {
  const Rectangle rect{12.0, 9.0, 6};
  constexpr int campaigns = 2000;
  const auto prepare = [](Workpiece& w, const std::string& how) {
    w.scatter = 1 * um;
    w.X("X1", 0.5);
    how == "autocollimator" ? w.yaw(0.2e-6) : w.X("X2", 8.5);
    w.Y();
    if (how == "one direction") w.directions = {1};
    w.D1();
    w.D2();
    if (how == "third diagonal") w.diagonal("D3", half_diagonal(w.errors, w.rect));
  };
  for (const std::string how : {"two lines", "autocollimator", "one direction", "third diagonal"}) {
    std::mt19937 rng(seed + 2);
    const Errors errors = random_gantry(rng, rect);
    double inside = 0.0, inside_k = 0.0, inside_racking = 0.0, solved = 0.0, low = 0.0, high = 0.0;
    for (std::size_t i = 0; i <= rect.n; ++i) {
      const double apart = -8.0 * errors.ECX(rect.x(i));
      low = std::min(low, apart), high = std::max(high, apart);
    }
    for (int c = 0; c < campaigns; ++c) {
      Workpiece w(rect, errors);
      w.rng.seed(seed + 100 + static_cast<unsigned>(c));
      prepare(w, how);
      const Evaluation e = w.evaluate();
      const bool both = how == "third diagonal";
      const Series* f = series(e, both ? "EYX" : "EYX_even");
      if (f == nullptr) continue;  // the closure has its own rate of false alarms
      solved += 1.0;
      for (std::size_t i = 1; i < rect.n; ++i) {
        const double here = errors.EYX(rect.x(i)), across = errors.EYX(rect.x(rect.n - i));
        const double truth = both ? here : (here + across) / 2.0;
        inside += (std::fabs(f->value[i] - truth) <= f->repeatability[i]) /
                  static_cast<double>(rect.n - 1);
      }
      for (const Value& v : e.values)
        if (v.name == "C0Y")
          inside_k += std::fabs(v.value - errors.C0Y) <= *v.repeatability;
        else if (v.name == "racking")
          inside_racking += std::fabs(v.value - (high - low)) <= *v.repeatability;
    }
    std::cout << "seed " << seed + 2 << ", " << how << ": EYX " << 100.0 * inside / solved
              << " %, C0Y " << 100.0 * inside_k / solved << " %, racking "
              << 100.0 * inside_racking / solved << " % of " << solved << "\n";
    EXPECT_GE(solved, 0.99 * campaigns) << how;
    if (how == "two lines") {
      EXPECT_GE(inside_racking, 0.93 * solved);
      EXPECT_LE(inside_racking, 0.97 * solved);
    }
    for (const double hit : {inside, inside_k}) {
      EXPECT_GE(hit, 0.93 * solved) << how;
      EXPECT_LE(hit, 0.97 * solved) << how;
    }
  }
}

/// A straightedge with 20 um of its own, even and odd about its middle.
machine::Curve crooked(double length) {
  return [length](double x) {
    const double t = x / length;
    return 20 * um * (4.0 * t * (1.0 - t) + std::sin(2.0 * std::numbers::pi * t));
  };
}

TEST(DiagonalPlugin, AStraightedgeTurnedOverLeavesNothingOfItself) {
  const Rectangle rect{12.0, 9.0, 12};
  std::mt19937 rng(seed + 6);
  const Errors errors = random_gantry(rng, rect);
  const auto with = [&](bool turned, double scatter) {
    Workpiece w(rect, errors);
    w.scatter = scatter;
    w.states_all();
    w.everything();
    turned ? w.turned_over(crooked(rect.Lx)) : w.straight("SX", crooked(rect.Lx));
    return w;
  };
  const Evaluation exact = with(true, 0.0).evaluate();
  const Series* f = series(exact, "EYX");
  ASSERT_NE(f, nullptr) << ids(exact);
  for (std::size_t i = 0; i <= rect.n; ++i)
    EXPECT_NEAR(f->value[i], errors.EYX(f->position[i]), 0.05 * um);
  EXPECT_EQ(exact.uses, (std::vector<std::string>{"D2", "Y", "X1", "X2", "SX", "SX turned"}));

  const Evaluation turned = with(true, 0.5 * um).evaluate(), one = with(false, 0.5 * um).evaluate();
  EXPECT_NE(finding(turned, "straightness-agrees"), nullptr) << ids(turned);
  EXPECT_NE(finding(one, "straightness-disagrees"), nullptr) << ids(one);
  const Series* wrong = series(one, "EYX");
  ASSERT_NE(wrong, nullptr);
  EXPECT_GT(std::fabs(wrong->value[3] - errors.EYX(wrong->position[3])), 15 * um)
      << "the straightedge's own odd part";

  Workpiece w = with(true, 0.5 * um);
  for (double& x : w.all.back().axes[0].position)
    if (x == rect.x(2)) x += 0.01;
  expect_refused(w, "refused-pitch-points");
}

/// U of the curves, and how often the comparison sees a difference that is not there.
TEST(DiagonalPlugin, UncertaintiesWithAStraightedgeTurnedOverCoverTheTruth) {
  const Rectangle rect{12.0, 9.0, 6};
  std::mt19937 rng(seed + 7);
  std::cout << "seed " << seed + 7 << "\n";
  const Errors errors = random_gantry(rng, rect);
  constexpr int campaigns = 2000;
  double f_inside = 0.0, g_inside = 0.0, solved = 0.0, false_alarms = 0.0, below_half = 0.0;
  for (int c = 0; c < campaigns; ++c) {
    Workpiece w(rect, errors);
    w.rng.seed(seed + 5000 + static_cast<unsigned>(c));
    w.scatter = 1 * um;
    w.states_all();
    w.everything();
    w.scatter = 3 * um;
    w.turned_over(crooked(rect.Lx));
    const Evaluation e = w.evaluate();
    const Series *f = series(e, "EYX"), *g = series(e, "EXY");
    if (f == nullptr || g == nullptr) continue;
    solved += 1.0;
    false_alarms += finding(e, "straightness-disagrees") != nullptr;
    for (const Finding& found : e.findings)
      if (found.id.rfind("diagonals.straightness-", 0) == 0)
        below_half += found.evidence.back().value < 0.5;
    const double inner = static_cast<double>(rect.n - 1);
    for (std::size_t i = 1; i < rect.n; ++i) {
      f_inside += (std::fabs(f->value[i] - errors.EYX(rect.x(i))) <= f->U[i]) / inner;
      g_inside += (std::fabs(g->value[i] - errors.EXY(rect.y(i))) <= g->U[i]) / inner;
    }
  }
  std::cout << "EYX " << 100.0 * f_inside / solved << " %, EXY " << 100.0 * g_inside / solved
            << " % of " << solved << ", false disagreements " << 100.0 * false_alarms / solved
            << " %, p below 0.5: " << 100.0 * below_half / solved << " %\n";
  EXPECT_GE(solved, 0.99 * campaigns);
  for (const double hit : {f_inside, g_inside}) {
    EXPECT_GE(hit, 0.94 * solved);
    EXPECT_LE(hit, 0.965 * solved);
  }
  EXPECT_LE(false_alarms, 0.02 * solved);
}

/// Sides that run together: the range of what only scatters is said to be an upper limit.
TEST(DiagonalPlugin, RackingIsNotTakenFromScatter) {
  std::mt19937 rng(seed + 9);
  const Rectangle rect{12.0, 9.0, 10};
  Errors errors = random_gantry(rng, rect);
  const auto racking_of = [&](double scatter) {
    Workpiece w(rect, errors);
    w.scatter = scatter;
    w.X("X1", 0.5), w.X("X2", 8.5), w.Y(), w.D1(), w.D2();
    return w.evaluate();
  };
  double low = 0.0, high = 0.0;
  for (std::size_t i = 0; i <= rect.n; ++i) {
    const double apart = -8.0 * errors.ECX(rect.x(i));
    low = std::min(low, apart), high = std::max(high, apart);
  }
  const Evaluation racks = racking_of(0.5 * um);
  EXPECT_NEAR(value(racks, "racking"), high - low, 2 * um);
  EXPECT_EQ(finding(racks, "racking-noise"), nullptr) << ids(racks);
  errors.ECX = machine::zero;
  EXPECT_NE(finding(racking_of(0.5 * um), "racking-noise"), nullptr);
}

/// Diagonals and a square: one value where they agree, with a U that covers; a finding where not.
TEST(DiagonalPlugin, SquarenessOfASquareIsOneValueOrAFinding) {
  const Rectangle rect{1.2, 0.9, 6};
  std::mt19937 rng(seed + 8);
  std::cout << "seed " << seed + 8 << "\n";
  Errors errors = random_gantry(rng, rect, 10 * um);
  errors.ECX = machine::zero;
  constexpr int campaigns = 2000;
  Workpiece exact(rect, errors);
  exact.states_all();
  exact.X("X1", 0.05), exact.X("X2", 0.85), exact.Y(), exact.D1(), exact.D2();
  const double truth = value(exact.evaluate(), "C0Y_LSQ");
  double inside = 0.0, solved = 0.0, disagree = 0.0, moved_found = 0.0, moved = 0.0;
  for (int c = 0; c < campaigns; ++c) {
    Workpiece w(rect, errors);
    w.rng.seed(seed + 20000 + static_cast<unsigned>(c));
    w.scatter = 1 * um;
    w.states_all();
    w.X("X1", 0.05), w.X("X2", 0.85), w.Y(), w.D1(), w.D2();
    const bool other_machine = c % 20 == 0;
    if (other_machine) w.errors.C0Y += 25e-6;
    w.square(40e-6);
    const Evaluation e = w.evaluate();
    const bool differs = finding(e, "squareness-disagrees") != nullptr;
    if (finding(e, "closure") != nullptr) continue;
    if (other_machine) {
      moved += 1.0, moved_found += differs;
      EXPECT_FALSE(differs && series(e, "C0Y_both") != nullptr);
      continue;
    }
    solved += 1.0, disagree += differs;
    if (differs) continue;
    for (const Value& v : e.values)
      if (v.name == "C0Y_both") inside += std::fabs(v.value - truth) <= *v.U;
  }
  std::cout << "C0Y_both " << 100.0 * inside / (solved - disagree) << " %, false disagreements "
            << 100.0 * disagree / solved << " % of " << solved << ", moved machines found "
            << moved_found << " of " << moved << "\n";
  EXPECT_GE(inside, 0.94 * (solved - disagree));
  EXPECT_LE(inside, 0.97 * (solved - disagree));
  EXPECT_LE(disagree, 0.02 * solved);
  EXPECT_GE(moved_found, 0.95 * moved);
}

}  // namespace
}  // namespace nonio::diagonal_test
