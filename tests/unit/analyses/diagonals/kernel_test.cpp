// SPDX-License-Identifier: Apache-2.0
// The kernel of diagonals against the exact machine.
#include <gtest/gtest.h>

#include <iostream>

#include "bench.h"

namespace nonio::math {
namespace {

using namespace bench;

constexpr unsigned seed = 20261121;

std::vector<double> at_stops(const machine::Curve& c, double length, std::size_t n) {
  std::vector<double> out;
  for (std::size_t i = 0; i <= n; ++i)
    out.push_back(c(length * static_cast<double>(i) / static_cast<double>(n)));
  return out;
}

std::vector<double> part(const std::vector<double>& v, double sign) {
  std::vector<double> out;
  for (std::size_t i = 0; i < v.size(); ++i)
    out.push_back((v[i] + sign * v[v.size() - 1 - i]) / 2.0);
  return out;
}

double largest(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::fabs(a[i] - b[i]));
  return most;
}

DiagonalResult solved(const DiagonalReadings& r) {
  const auto result = solve_diagonals(r);
  EXPECT_TRUE(result) << (result ? "" : result.error().message);
  return result.value_or(DiagonalResult{});
}

TEST(Diagonals, WhatTwoDiagonalsKnowIsRecovered) {
  std::mt19937 rng(seed);
  std::cout << "seed " << seed << "\n";
  double worst = 0.0, worst_k = 0.0;
  for (const std::size_t n : {5UL, 10UL, 30UL, 40UL})
    for (int k = 0; k < 20; ++k) {
      const Rectangle rect{12.0, 9.0, n};
      const Errors e = random_gantry(rng, rect);
      const auto r = solved(read(e, rect, {0.5, 8.5}));
      const auto f = at_stops(e.EYX, rect.Lx, n), g = at_stops(e.EXY, rect.Ly, n);
      std::vector<double> q;
      for (std::size_t i = 0; i <= n; ++i) q.push_back(0.8 * g[i] + 0.6 * f[i]);
      worst = std::max({worst, largest(r.EYX_even.value, part(f, 1.0)),
                        largest(r.EXY_even.value, part(g, 1.0)),
                        largest(r.q_odd.value, part(q, -1.0))});
      worst_k = std::max(worst_k, std::fabs(r.C0Y - e.C0Y));
      EXPECT_FALSE(r.separable());
      EXPECT_TRUE(r.EYX.value.empty());
      EXPECT_NEAR(*r.slave_shift, 8.0 * e.C0Y, 0.05 * um);
    }
  std::cout << "worst " << worst / um << " um, C0Y " << worst_k / um << " urad\n";
  EXPECT_LT(worst, 0.05 * um);
  EXPECT_LT(worst_k, 0.01e-6);
}

TEST(Diagonals, RankDeficitsAreThoseOfTheGeometry) {
  for (const auto& [n, nullity] : {std::pair{5UL, 2UL}, {10UL, 4UL}, {30UL, 14UL}, {40UL, 19UL}}) {
    const Rectangle rect{12.0, 9.0, n};
    auto r = read({}, rect, {0.5, 8.5});
    EXPECT_EQ(solved(r).unknowns, 2 * n - 1);
    EXPECT_EQ(solved(r).nullity(), nullity) << n;
    r.third = {parallel_diagonal({}, rect, 1)};
    EXPECT_EQ(solved(r).nullity(), 0U) << n;
    if (n % 2 != 0) continue;
    r.third = {half_diagonal({}, rect)};
    EXPECT_EQ(solved(r).nullity(), 0U) << n;
    r.third = {parallel_diagonal({}, rect, n / 2)};
    if (n == 30 || n == 40) {
      EXPECT_EQ(solved(r).nullity(), n == 30 ? 7U : 9U);
    }
  }
}

TEST(Diagonals, ThirdInformationSeparatesBothStraightnesses) {
  std::mt19937 rng(seed + 1);
  std::cout << "seed " << seed + 1 << "\n";
  double worst = 0.0;
  for (int k = 0; k < 20; ++k) {
    const Rectangle rect{19.76, 7.68, 40};
    const Errors e = random_gantry(rng, rect);
    for (int kind = 0; kind < 5; ++kind) {
      auto r = read(e, rect, {0.5, 7.5});
      if (kind == 0) r.third = {half_diagonal(e, rect)};
      if (kind == 1) r.third = {parallel_diagonal(e, rect, 1)};
      if (kind == 2) r.EYX = straightness(e.EYX, rect.Lx, rect.n);
      if (kind >= 3) r.EXY = straightness(e.EXY, rect.Ly, rect.n);
      if (kind == 4) r.EXY->whole = true;
      const auto s = solved(r);
      ASSERT_TRUE(s.separable()) << kind;
      worst = std::max({worst, largest(s.EYX.value, at_stops(e.EYX, rect.Lx, rect.n)),
                        largest(s.EXY.value, at_stops(e.EXY, rect.Ly, rect.n))});
    }
  }
  std::cout << "worst " << worst / um << " um\n";
  EXPECT_LT(worst, 0.05 * um);
}

struct Gain {
  double Lx, Ly;
  int kind;
  double EYX, EXY;
};

TEST(Diagonals, NoiseGainsAreThoseOfTheTable) {
  for (const Gain& g : {Gain{12, 9, 0, .89, 1.03}, Gain{19.76, 7.68, 0, .95, .81},
                        Gain{12, 9, 1, 2.33, 1.57}, Gain{19.76, 7.68, 1, 4.06, 1.43},
                        Gain{12, 9, 2, 3.10, 2.29}, Gain{19.76, 7.68, 2, 5.13, 1.97}}) {
    const Rectangle rect{g.Lx, g.Ly, 40};
    auto r = read({}, rect, {0.5, 7.5});
    for (auto* c : {static_cast<MeanCurve*>(&r.X[0]), static_cast<MeanCurve*>(&r.X[1]),
                    static_cast<MeanCurve*>(&r.Y[0])})
      c->u = 1e-6;  // next to nothing: the table has white noise of the diagonals only
    r.D1.u = r.D2.u = 1.0;
    if (g.kind == 0) {
      r.EYX = straightness(machine::zero, rect.Lx, rect.n);
      r.EYX->u = 1.0;
      EXPECT_GT(solved(r).EYX.gain, g.EYX);  // its odd part only, on a line of unknown slope
      r.EYX->whole = r.EYX->zeroed = true;
    }
    if (g.kind == 1) r.third = {half_diagonal({}, rect)};
    if (g.kind == 2) r.third = {parallel_diagonal({}, rect, 1)};
    for (GridLine& line : r.third) line.u = 1.0;
    const auto s = solved(r);
    std::cout << g.Lx << " kind " << g.kind << ": " << s.EYX.gain << " " << s.EXY.gain << "\n";
    EXPECT_NEAR(s.EYX.gain, g.EYX, 0.005);
    EXPECT_NEAR(s.EXY.gain, g.EXY, 0.005);
  }
}

// A.3 of the derivation: a pair of errors that no reading of either diagonal shows.
TEST(Diagonals, TheInvisiblePairIsInvisibleAndSaid) {
  const Rectangle rect{12.0, 9.0, 30};
  const auto wave = [](double size, double length) {
    return [=](double p) { return size * std::sin(2.0 * std::numbers::pi * p / length); };
  };
  Errors e;
  e.EXY = wave(50 * um, 9.0);
  e.EYX = wave(-50 * um * 12.0 / 9.0, 12.0);
  const auto readings = read(e, rect, {0.5, 8.5});
  for (const auto* d : {&readings.D1, &readings.D2})
    for (const double v : d->mean) EXPECT_LT(std::fabs(v), 0.001 * um);
  const auto r = solved(readings);
  EXPECT_EQ(r.nullity(), 14U);
  EXPECT_TRUE(r.EYX.value.empty() && r.EXY.value.empty());
  EXPECT_LT(std::fabs(r.lsq.C0Y), 0.001e-6);
  const Band band = straightness_band(r, rect.Lx, rect.Ly, 50 * um);
  for (std::size_t i = 0; i <= rect.n; ++i) {
    const double f = e.EYX(rect.x(i));
    EXPECT_LE(band.low[i], f + 0.01 * um);
    EXPECT_GE(band.high[i], f - 0.01 * um);
  }
}

// A bow of the guide turns a single column: EYX = p, ECX = p'. Without yaw it comes out with the
// opposite sign, and nothing in the diagonals says so.
TEST(Diagonals, ABowOfASingleColumnNeedsItsYaw) {
  const Rectangle rect{12.0, 9.0, 30};
  Errors e;
  e.EYX = [](double x) { return 160 * um * x / 12.0 * (1.0 - x / 12.0); };
  e.ECX = [](double x) { return 160 * um / 12.0 * (1.0 - x / 6.0) - 160 * um / 12.0; };
  e.C0Y = -160 * um / 12.0;  // what ECX has at x = 0
  e.y_ref = 4.5;
  const auto blind = solved(read(e, rect, {4.5}));
  EXPECT_NEAR(blind.EYX_even.value[15], -40 * um, 0.05 * um);
  EXPECT_NEAR(blind.closure.S_n, 0.0, 0.01 * um);
  EXPECT_LT(blind.closure.S_odd, 0.01 * um);
  const auto seen = solved(read(e, rect, {0.5, 8.5}));
  EXPECT_NEAR(seen.EYX_even.value[15], 40 * um, 0.05 * um);
  ASSERT_EQ(seen.ECX.value.size(), rect.n + 1);
  for (std::size_t i = 0; i <= rect.n; ++i)
    EXPECT_NEAR(seen.ECX.value[i], e.ECX(12.0 * static_cast<double>(i) / 30.0), 0.01e-6);
}

// The 7.8 um of the derivation: pitch of the sides +-16 um, yaw ignored, X read at mid-beam.
TEST(Diagonals, TheChecksAreSilentForYawAtMidBeam) {
  const Rectangle rect{12.0, 9.0, 30};
  Errors e;
  e.ECX = [](double x) { return 32.8 * um / 9.0 * std::sin(std::numbers::pi * x / 12.0); };
  e.y_ref = 4.5;
  const auto r = solved(read(e, rect, {4.5}));
  double wrong = 0.0;
  const auto truth = at_stops(e.EYX, rect.Lx, rect.n);
  for (std::size_t i = 0; i <= rect.n; ++i)
    wrong = std::max(wrong, std::fabs(r.EYX_even.value[i] + r.q_odd.value[i] / 0.6 - truth[i]));
  std::cout << "EYX wrong by " << wrong / um << " um, S_n " << r.closure.S_n / um << " um, S_odd "
            << r.closure.S_odd / um << " um\n";
  EXPECT_NEAR(wrong, 7.8 * um, 0.1 * um);
  EXPECT_LT(std::fabs(r.closure.S_n), 0.005 * um);
  EXPECT_LT(r.closure.S_odd, 0.005 * um);
}

TEST(Diagonals, LimitsOfClosureAreThoseOfEqualNoise) {
  const Rectangle rect{12.0, 9.0, 30};
  auto r = read({}, rect, {4.5});
  r.D1.u = r.D2.u = r.X[0].u = r.Y[0].u = 1 * um;
  auto s = solved(r);
  EXPECT_NEAR(s.closure.S_n_limit, 4.0 * std::sqrt(6.0) * um, 1e-9);
  EXPECT_NEAR(s.closure.S_odd_limit, 4.0 * std::sqrt(3.0) * um, 1e-9);
  r.X[0].u = r.Y[0].u = 1e-6 * um;
  s = solved(r);
  EXPECT_NEAR(s.closure.S_n_limit, 4.0 * std::sqrt(2.0) * um, 1e-9);
  EXPECT_NEAR(s.closure.S_odd_limit, 4.0 * um, 1e-9);
}

TEST(Diagonals, SquarenessOnTheLeastSquaresLineIsThatOfTheMachine) {
  std::mt19937 rng(seed + 2);
  std::cout << "seed " << seed + 2 << "\n";
  const Rectangle rect{12.0, 9.0, 30};
  for (int k = 0; k < 20; ++k) {
    Errors e = random_gantry(rng, rect);
    const auto r = solved(read(e, rect, {0.5, 8.5}));
    // Slopes put into the straightness and taken out of C0Y change nothing that is read.
    Errors other = e;
    other.EYX = [c = e.EYX](double x) { return c(x) + 5e-6 * x; };
    other.EXY = [c = e.EXY](double y) { return c(y) - 3e-6 * y; };
    other.C0Y = e.C0Y + 2e-6;
    const auto o = solved(read(other, rect, {0.5, 8.5}));
    EXPECT_NEAR(o.C0Y, r.C0Y, 0.01e-6);
    EXPECT_NEAR(o.lsq.C0Y, r.lsq.C0Y, 0.01e-6);
  }
}

/// Adds white noise to every mean, the first stop too.
void disturb(MeanCurve& c, double u, std::mt19937& rng) {
  std::normal_distribution<double> normal(0.0, u);
  for (double& v : c.mean) v += normal(rng);
  c.u = u;
  c.zeroed = false;
}

TEST(Diagonals, UncertaintiesCoverTheTruth) {
  std::mt19937 rng(seed + 3);
  std::cout << "seed " << seed + 3 << "\n";
  const Rectangle rect{12.0, 9.0, 10};
  const Errors e = random_gantry(rng, rect);
  auto clean = read(e, rect, {0.5, 8.5});
  clean.third = {half_diagonal(e, rect)};
  const auto f = at_stops(e.EYX, rect.Lx, rect.n), g = at_stops(e.EXY, rect.Ly, rect.n);
  constexpr int campaigns = 2000;
  double inside_k = 0.0, inside_f = 0.0, inside_g = 0.0, inside_even = 0.0, closed = 0.0;
  const auto in = [](double v, double truth, double u) { return std::fabs(v - truth) <= 2.0 * u; };
  for (int c = 0; c < campaigns; ++c) {
    auto r = clean;
    for (MeanCurve* curve : {static_cast<MeanCurve*>(&r.D1), static_cast<MeanCurve*>(&r.D2),
                             static_cast<MeanCurve*>(&r.third[0])})
      disturb(*curve, 0.8 * um, rng);
    for (MeanCurve* curve : {static_cast<MeanCurve*>(&r.X[0]), static_cast<MeanCurve*>(&r.X[1]),
                             static_cast<MeanCurve*>(&r.Y[0])})
      disturb(*curve, 0.5 * um, rng);
    const auto s = solved(r);
    inside_k += in(s.C0Y, e.C0Y, s.u_C0Y);
    closed += s.closure.passed();
    const double inner = static_cast<double>(rect.n - 1);
    for (std::size_t i = 1; i < rect.n; ++i) {
      inside_f += in(s.EYX.value[i], f[i], s.EYX.u[i]) / inner;
      inside_g += in(s.EXY.value[i], g[i], s.EXY.u[i]) / inner;
      inside_even += in(s.EYX_even.value[i], (f[i] + f[rect.n - i]) / 2.0, s.EYX_even.u[i]) / inner;
    }
  }
  for (const auto& [name, inside] :
       {std::pair{"C0Y", inside_k}, {"EYX", inside_f}, {"EXY", inside_g}, {"even", inside_even}}) {
    std::cout << name << " " << 100.0 * inside / campaigns << " %\n";
    EXPECT_GE(inside, 0.93 * campaigns) << name;
    EXPECT_LE(inside, 0.97 * campaigns) << name;
  }
  EXPECT_GE(closed, 0.99 * campaigns);
}

/// Two lines of X, Y, both diagonals, EYX and EXY: lengths and laterals whose errors are the
/// repetition alone.
ReadingModel repetition_alone(const DiagonalReadings& r) {
  ReadingModel model;
  for (std::size_t k = 0; k < 7; ++k) {
    BudgetLine line;
    line.kind = k < 5 ? BudgetLine::Kind::length : BudgetLine::Kind::lateral;
    line.group = k;
    for (std::size_t i = 0; i <= r.n; ++i) line.length.push_back(static_cast<double>(i));
    model.lines.push_back(std::move(line));
  }
  return model;
}

TEST(Diagonals, ADirectStraightnessAgreesAsOftenAsItShould) {
  std::mt19937 rng(seed + 5);
  std::cout << "seed " << seed + 5 << "\n";
  const Rectangle rect{12.0, 9.0, 10};
  const Errors e = random_gantry(rng, rect);
  auto clean = read(e, rect, {0.5, 8.5});
  clean.EYX = straightness(e.EYX, rect.Lx, rect.n);
  clean.EXY = straightness(e.EXY, rect.Ly, rect.n);
  const ReadingModel model = repetition_alone(clean);
  constexpr int campaigns = 400;
  double below_half = 0.0, below_percent = 0.0, bent_found = 0.0;
  const auto noisy = [&] {
    auto r = clean;
    for (MeanCurve* c : {static_cast<MeanCurve*>(&r.D1), static_cast<MeanCurve*>(&r.D2),
                         static_cast<MeanCurve*>(&r.X[0]), static_cast<MeanCurve*>(&r.X[1]),
                         static_cast<MeanCurve*>(&r.Y[0]), static_cast<MeanCurve*>(&*r.EYX),
                         static_cast<MeanCurve*>(&*r.EXY)})
      disturb(*c, 0.8 * um, rng), c->dof = 1000.0;
    return r;
  };
  for (int c = 0; c < campaigns; ++c) {
    auto r = noisy();
    const auto s = solve_diagonals(r, &model);
    ASSERT_TRUE(s && s->EYX_agrees && s->EXY_agrees);
    for (const auto* a : {&*s->EYX_agrees, &*s->EXY_agrees}) {
      below_half += (a->p < 0.5) / 2.0;
      below_percent += (a->p < 0.01) / 2.0;
    }
    if (c % 10 != 0) continue;
    for (std::size_t i = 0; i <= r.n; ++i) {  // a straightedge that sags by 8 um
      const double t = static_cast<double>(i) / static_cast<double>(r.n);
      r.EXY->mean[i] += 8 * um * 4.0 * t * (1.0 - t);
    }
    const auto bent = solve_diagonals(r, &model);
    bent_found +=
        bent->EXY_agrees->p < 0.01 && std::fabs(bent->EYX_agrees->p - s->EYX_agrees->p) < 1e-6
            ? 10.0
            : 0.0;
  }
  std::cout << "p below 0.5: " << 100.0 * below_half / campaigns
            << " %, below 0.01: " << 100.0 * below_percent / campaigns
            << " %, a sag of 8 um found: " << 100.0 * bent_found / campaigns << " %\n";
  EXPECT_NEAR(below_half / campaigns, 0.5, 0.06);
  EXPECT_LE(below_percent / campaigns, 0.02);
  EXPECT_GE(bent_found / campaigns, 0.95);
}

TEST(Diagonals, UnknownNoiseComesFromTheResiduals) {
  std::mt19937 rng(seed + 4);
  std::cout << "seed " << seed + 4 << "\n";
  const Rectangle rect{12.0, 9.0, 40};
  auto r = read(random_gantry(rng, rect), rect, {0.5, 8.5});
  for (MeanCurve* curve : {static_cast<MeanCurve*>(&r.D1), static_cast<MeanCurve*>(&r.D2),
                           static_cast<MeanCurve*>(&r.X[0]), static_cast<MeanCurve*>(&r.X[1]),
                           static_cast<MeanCurve*>(&r.Y[0])}) {
    disturb(*curve, 1 * um, rng);
    curve->u = 0.0;
  }
  const auto s = solved(r);
  EXPECT_FALSE(s.noise_known);
  EXPECT_EQ(s.dof, 20U);
  EXPECT_NEAR(s.residual_u, 1 * um, 0.5 * um);
}

TEST(Diagonals, ReadingsThatDoNotFitTheGridAreRefused) {
  const Rectangle rect{12.0, 9.0, 10};
  auto r = read({}, rect, {0.5, 8.5});
  r.D1.mean.pop_back();
  EXPECT_FALSE(solve_diagonals(r));
  r = read({}, rect, {0.5, 8.5});
  r.Y[0].mean[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(solve_diagonals(r));
  r = read({}, rect, {0.5, 0.5});
  EXPECT_FALSE(solve_diagonals(r));
  r = read({}, rect, {0.5, 8.5});
  r.D2 = r.D1;
  EXPECT_FALSE(solve_diagonals(r)) << "twice the same diagonal";
}

}  // namespace
}  // namespace nonio::math
