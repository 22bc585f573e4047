// SPDX-License-Identifier: Apache-2.0
// Step diagonals of an exact machine, without noise: what comes back, and what cannot.
#include <iostream>

#include "workshop.h"

namespace steps::step_recovery_test {
namespace {

using namespace nonio::math;

constexpr unsigned seed = 20261121;
constexpr StepChoices perfect{true, false, 0.0}, mirror_askew{false, false, 0.0}, usual{};

double largest(const std::vector<double>& y) {
  double most = 0.0;
  for (const double v : y) most = std::max(most, std::fabs(v));
  return most;
}

TEST(StepRecovery, PerfectSetUpGivesTheNineFunctionsByBothMethods) {
  std::mt19937 rng(seed);
  std::cout << "seed " << seed << "\n";
  const Volume v{{0.8, 0.6, 0.6}, 20};
  const auto e = random_errors(rng, v, 30 * um);
  const auto d = measured(e, v);
  const auto averaged = average_step_diagonals(d, perfect);
  const auto fitted = solve_step_diagonals(d, {}, perfect);
  ASSERT_TRUE(averaged && fitted);
  EXPECT_TRUE(averaged->scales_known() && fitted->scales_known());
  expect_truth(*averaged, e, v, 0.05 * um, 0.05 * urad);
  expect_truth(*fitted, e, v, 0.05 * um, 0.05 * urad);
}

TEST(StepRecovery, SetUpAnglesAndAxisLengths) {
  std::mt19937 rng(seed);
  std::cout << "seed " << seed << "\n";
  const Volume v{{0.8, 0.6, 0.6}, 20};
  for (int k = 0; k < 6; ++k) {
    const auto e = random_errors(rng, v, 30 * um);
    const bool beam = k % 2 == 0;
    const auto d = measured(e, v, random_set_up(rng, 0.3e-3, beam));
    for (const char* axes : {"XY", "XYZ"}) {
      const auto s = solve_step_diagonals(d, lengths(e, v, axes), beam ? usual : mirror_askew);
      ASSERT_TRUE(s);
      EXPECT_TRUE(s->scales_known());
      EXPECT_EQ(s->set_up.size(), 4U);
      expect_truth(*s, e, v, 0.05 * um, 0.05 * urad);
    }
  }
}

TEST(StepRecovery, AxisTargetsNeedNotBeTheSteps) {
  std::mt19937 rng(seed + 1);
  const Volume v{{0.8, 0.6, 0.6}, 20}, fine{{0.8, 0.6, 0.6}, 37};
  const auto e = random_errors(rng, v, 10 * um);
  const auto d = measured(e, v, random_set_up(rng, 0.3e-3, true));
  const auto s = solve_step_diagonals(d, lengths(e, fine, "XYZ"), usual);
  ASSERT_TRUE(s);
  expect_truth(*s, e, v, 0.1 * um, 0.1 * urad);  // straight between the steps
}

TEST(StepRecovery, SetUpAnglesAreFound) {
  const Volume v{{0.8, 0.6, 0.6}, 8};
  std::vector<Optics> set_up(4);
  set_up[0].beam = {0.1e-3, 0.0};
  set_up[2].beam = {0.0, -0.3e-3};
  const auto s = solve_step_diagonals(measured({}, v, set_up), lengths({}, v, "XYZ"), usual);
  ASSERT_TRUE(s);
  ASSERT_EQ(s->set_up.size(), 4U);
  EXPECT_NEAR(s->set_up[0], 0.1e-3, 1e-8);
  EXPECT_NEAR(s->set_up[1], 0.0, 1e-8);
  EXPECT_NEAR(s->set_up[2], 0.3e-3, 1e-8);
}

TEST(StepRecovery, TheReferenceRanks) {
  const Volume v{{0.8, 0.6, 0.6}, 8};
  const auto d = measured({}, v);
  struct Case {
    const char* axes;
    bool set_up_known;
    std::size_t rank, unknowns;
    bool scales;
  };
  for (const Case& c : {Case{"", true, 72, 72, true}, Case{"", false, 78, 80, false},
                        Case{"X", false, 79, 80, false}, Case{"XY", false, 80, 80, true},
                        Case{"XYZ", false, 80, 80, true}}) {
    const auto s = solve_step_diagonals(d, lengths({}, v, c.axes), {c.set_up_known, true, 0.0});
    ASSERT_TRUE(s);
    EXPECT_EQ(s->rank, c.rank) << c.axes;
    EXPECT_EQ(s->unknowns, c.unknowns) << c.axes;
    EXPECT_EQ(s->scales_known(), c.scales) << c.axes;
  }
}

TEST(StepRecovery, OneAxisLengthIsItsOwnScaleOnly) {
  std::mt19937 rng(seed + 2);
  const Volume v{{0.8, 0.6, 0.6}, 10};
  const auto e = random_errors(rng, v, 30 * um);
  const auto s = solve_step_diagonals(measured(e, v, random_set_up(rng, 0.1e-3, true)),
                                      lengths(e, v, "Y"), usual);
  ASSERT_TRUE(s);
  EXPECT_FALSE(s->curves[0].known);
  EXPECT_TRUE(s->curves[4].known);
  EXPECT_FALSE(s->curves[8].known);
  expect_truth(*s, e, v, 0.1 * um, 0.1 * urad);
}

// The known failure: a mirror 0.3 mrad askew, a machine without errors, diagonals without errors.
TEST(StepRecovery, AveragingTurnsTheSetUpIntoFalseErrors) {
  const Volume v;
  double displacement = 0.0, straightness = 0.0;
  for (const int pattern : {0, 1}) {
    // Each mirror turned towards X by 0.3 mrad: by the sign that makes EXX worst, then EYX.
    std::vector<Optics> set_up;
    for (const auto& sign : four()) {
      Vector u = v.travel.normalized();
      for (Eigen::Index c = 0; c < 3; ++c) u[c] *= sign[static_cast<std::size_t>(c)];
      const Vector one = u.unitOrthogonal(), two = u.cross(one);
      // A turn t about `one` moves the normal by t one x u = -t two; about `two` by t one.
      const double towards = 0.3e-3 * sign[0] * (pattern == 0 ? 1 : sign[0] * sign[1]);
      const Eigen::Vector2d x = Eigen::Vector2d(-two.x(), one.x()).normalized();
      set_up.push_back({towards * x, {0, 0}});
    }
    const auto d = measured({}, v, set_up);
    for (const auto& pass : d.passes) EXPECT_LT(std::fabs(pass.reading.back()), 0.06 * um);
    const auto s = average_step_diagonals(d, perfect);
    ASSERT_TRUE(s);
    displacement = std::max(displacement, largest(s->curves[0].value));
    EXPECT_LT(std::fabs(s->squareness[0].value), 0.3 * urad);
    for (const auto& c : s->curves)
      if (c.name[1] != c.name[2]) {
        EXPECT_LT(largest(c.value), 0.02 * um) << c.name;
      }
    const auto shapes = average_step_diagonals(d, mirror_askew);
    ASSERT_TRUE(shapes);
    for (const auto& c : shapes->curves) EXPECT_LT(largest(c.value), 0.02 * um) << c.name;
    // The slope of EYX, before its line is taken away: sum of its increments.
    double end = 0.0;
    for (std::size_t i = 0; i < v.n; ++i)
      for (const auto& pass : d.passes) {
        const std::size_t t = 3 * (pass.sign[0] > 0 ? i : v.n - 1 - i);
        end += pass.sign[0] * pass.sign[1] *
               (pass.reading[t] - (t == 0 ? 0.0 : pass.reading[t - 1])) * d.diagonal() / (4 * 0.6);
      }
    straightness = std::max(straightness, std::fabs(end));
  }
  std::cout << "false displacement " << displacement / um << " um, straightness "
            << straightness / um << " um\n";
  EXPECT_GT(displacement, 172 * um);  // what random angles of this size have made of it
  EXPECT_GT(straightness, 300 * um);
}

// 0.3 mrad at random: 172 um of false displacement and 402 um of false straightness over 0.8 m, as
// the derivation had it of one draw, are what such draws give, with the totals of the diagonals
// perfect.
TEST(StepRecovery, RandomSetUpsMakeTheFalseErrorsOfTheReference) {
  std::mt19937 rng(seed + 7);
  std::cout << "seed " << seed + 7 << "\n";
  std::normal_distribution<double> angle(0.0, 0.3e-3);
  const Volume v;
  std::vector<double> displacement, straightness;
  for (int draw = 0; draw < 200; ++draw) {
    std::vector<Optics> set_up(4);
    for (Optics& o : set_up) o.mirror = Eigen::Vector2d(angle(rng), angle(rng));
    const auto d = measured({}, v, set_up);
    for (const auto& pass : d.passes) EXPECT_LT(std::fabs(pass.reading.back()), 2 * um);
    double false_EXX = 0.0, false_EYX = 0.0;
    for (std::size_t i = 0; i < v.n; ++i)
      for (const auto& pass : d.passes) {
        const std::size_t t = 3 * (pass.sign[0] > 0 ? i : v.n - 1 - i);
        const double step = pass.reading[t] - (t == 0 ? 0.0 : pass.reading[t - 1]);
        false_EXX += step * d.diagonal() / (4 * 0.8);
        false_EYX += pass.sign[0] * pass.sign[1] * step * d.diagonal() / (4 * 0.6);
      }
    displacement.push_back(std::fabs(false_EXX) / um);
    straightness.push_back(std::fabs(false_EYX) / um);
  }
  for (auto [what, wanted] : {std::pair{&displacement, 172.0}, {&straightness, 402.0}}) {
    std::sort(what->begin(), what->end());
    std::cout << "median " << (*what)[100] << ", largest of 200 " << what->back() << " um\n";
    EXPECT_GT(what->back(), wanted);
    EXPECT_LT((*what)[100], wanted);
  }
}

machine::Errors about_the_middle(const Volume& v) {
  machine::Errors e;
  e.y_ref = v.travel.y() / 2;
  e.z_ref = v.travel.z() / 2;
  return e;
}

TEST(StepRecovery, ShapesSurviveAnySetUp) {
  std::mt19937 rng(seed + 3);
  std::cout << "seed " << seed + 3 << "\n";
  const Volume v;
  const auto e = random_errors(rng, v, 5 * um);
  const auto set_up = random_set_up(rng, 0.3e-3, true);
  const auto straight = average_step_diagonals(measured(e, v), mirror_askew);
  const auto askew = average_step_diagonals(measured(e, v, set_up), mirror_askew);
  ASSERT_TRUE(straight && askew);
  for (std::size_t k = 0; k < 9; ++k)
    EXPECT_LT(largest_difference(straight->curves[k].value, askew->curves[k].value), 0.02 * um)
        << straight->curves[k].name;
  expect_truth(*askew, e, v, 0.03 * um, 0.4 * urad);
}

// Angular errors are not told from straightness: the four diagonals pass one x at different y, z.
TEST(StepRecovery, AngularErrorsBecomeFalseStraightness) {
  const Volume v;
  struct Alias {
    const char *angle, *curve;
    double sign;
  };
  for (const Alias& a :
       {Alias{"ECX", "EYX", -1.0}, Alias{"EBX", "EZX", 1.0}, Alias{"EAY", "EZY", -1.0}}) {
    const double travel = v.travel[a.angle[2] - 'X'];
    const machine::Curve psi = [=](double p) { return 20 * urad * std::sin(5.0 * p / travel); };
    machine::Errors e = about_the_middle(v);
    e[a.angle] = psi;
    const auto s = average_step_diagonals(measured(e, v), perfect);
    ASSERT_TRUE(s);
    const auto wanted = levelled(
        sampled([&](double p) { return a.sign * (p - travel / 2) * psi(p); }, travel, v.n));
    for (const auto& c : s->curves)
      if (c.name == a.curve) {
        EXPECT_GT(largest(c.value), 2 * um);
        EXPECT_LT(largest_difference(c.value, wanted), 0.02 * um) << c.name;
      }
  }
}

// Rolls turn the mirror, whose normal is not along the axis of the roll. What is even about the
// middle of the travel stays: ECZ makes a false EYX = -int (ECZ(z) + ECZ(Z - z)) / 2 dx.
TEST(StepRecovery, RollsAreInvisibleIfTheyGrowEvenly) {
  const Volume v;
  for (const bool even : {true, false})
    for (const char* roll : {"EAX", "EBY", "ECZ"}) {
      const double travel = v.travel[roll[2] - 'X'];
      machine::Errors e = about_the_middle(v);
      e[roll] = [=](double p) {
        const double t = p / travel;
        return 20 * urad * (even ? t : 4.0 * t * (1.0 - t));
      };
      const auto s = average_step_diagonals(measured(e, v), perfect);
      ASSERT_TRUE(s);
      double most = 0.0;
      for (const auto& c : s->curves) most = std::max(most, largest(c.value));
      std::cout << roll << (even ? " even: " : " bowed: ") << most / um << " um\n";
      if (even) {
        EXPECT_LT(most, 0.3 * um) << roll;  // step times angle
      }
    }
}

TEST(StepRecovery, AMissingReadingCostsNothingInTheFitAndStopsTheAveraging) {
  std::mt19937 rng(seed + 4);
  const Volume v{{0.8, 0.6, 0.6}, 10};
  const auto e = random_errors(rng, v, 30 * um);
  auto d = measured(e, v, random_set_up(rng, 0.3e-3, true));
  d.passes[1].reading[7] = NAN;
  const auto s = solve_step_diagonals(d, lengths(e, v, "XYZ"), usual);
  ASSERT_TRUE(s);
  expect_truth(*s, e, v, 0.05 * um, 0.05 * urad);
  EXPECT_FALSE(average_step_diagonals(d, perfect));
}

TEST(StepRecovery, ThreeDiagonalsOrAFunctionWithoutReadingsIsRefused) {
  const Volume v{{0.8, 0.6, 0.6}, 10};
  auto d = measured({}, v);
  auto three = d;
  three.passes.pop_back();
  EXPECT_FALSE(solve_step_diagonals(three, {}, usual));
  EXPECT_FALSE(average_step_diagonals(three, perfect));
  for (auto& pass : d.passes) std::fill(pass.reading.begin() + 9, pass.reading.begin() + 21, NAN);
  EXPECT_FALSE(solve_step_diagonals(d, {}, usual));
}

}  // namespace
}  // namespace steps::step_recovery_test
