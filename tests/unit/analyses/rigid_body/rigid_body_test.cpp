// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/rigid_body.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <map>
#include <set>

#include "rigid_workshop.h"

namespace nonio::math::rigid_body_test {
namespace {

using namespace rigid_workshop;

constexpr double um = 1e-6;

RigidWish wish_of_fourth_degree() {
  RigidWish wish;
  wish.low = low, wish.high = high;
  wish.degree = 4;
  return wish;
}

RigidSolution solved(const std::vector<RigidLine>& lines, const RigidWish& wish) {
  auto s = solve_rigid_body(lines, wish);
  EXPECT_TRUE(s) << (s ? "" : s.error().message);
  return s ? *s : RigidSolution{};
}

std::vector<RigidLine> step_campaign(const Truth& t, const Noise& noise) {
  std::vector<RigidLine> lines;
  for (const auto& sign : {std::array{1, 1, 1}, {-1, 1, 1}, {1, -1, 1}, {1, 1, -1}})
    lines.push_back(step_diagonal(t, sign, 10, {6e-5, -3e-5}, noise));
  lines.push_back(beam(t, place(0, .5, .5), place(1, .5, .5), 16, 1, noise));
  lines.push_back(beam(t, place(.5, 0, .5), place(.5, 1, .5), 16, 1, noise));
  lines.push_back(beam(t, place(.5, .5, 0), place(.5, .5, 1), 16, 1, noise));
  return lines;
}

TEST(RigidBody, TheErrorsAreTwentyOne) {
  const auto& names = rigid_errors();
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), 21u);
  // Three along or across, three about each axis that moves; a paper has Ax(y) twice and Az(y) not at all.
  for (const char axis : {'X', 'Y', 'Z'})
    for (const char* kind : {"EX", "EY", "EZ", "EA", "EB", "EC"})
      EXPECT_EQ(std::count(names.begin(), names.end(), std::string(kind) + axis), 1)
          << kind << axis;
}

TEST(RigidBody, ExactReadingsGiveTheExactVolume) {
  std::mt19937_64 random(20261128);
  for (int i = 0; i < 3; ++i) {
    const Truth t = any_machine(random, 10, 15);
    const RigidSolution s = solved(whole_campaign(t, nullptr, 0.0), wish_of_fourth_degree());
    EXPECT_TRUE(s.combinations.empty());
    EXPECT_EQ(s.unseen, (std::vector<std::string>{"ECY", "EAZ", "EBZ", "ECZ"}));
    ASSERT_EQ(s.map.nodes.size(), 125u);
    EXPECT_GT(s.map.size, 5 * um);
    for (const VolumeNode& n : s.map.nodes) {
      const Corner exact = exact_error(t, n.at);
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(n.error[k], exact[k], 0.01 * um);
    }
    ASSERT_EQ(s.squareness.size(), 3u);
    EXPECT_NEAR(s.squareness[0].second.value, t.errors.C0Y, 0.02e-6);
    EXPECT_NEAR(s.squareness[1].second.value, t.errors.B0Z, 0.02e-6);
    EXPECT_NEAR(s.squareness[2].second.value, t.errors.A0Z, 0.02e-6);
  }
}

TEST(RigidBody, SchwarzFindsTheDegree) {
  std::mt19937_64 random(3);
  const Truth t = any_machine(random, 20, 30);
  RigidWish wish = wish_of_fourth_degree();
  wish.degree = 0;
  EXPECT_EQ(solved(whole_campaign(t, &random, 0.3 * um), wish).degree, 4u);
}

/// A machine that has nothing but one combination: its largest term makes 20 um in the volume.
Truth machine_of(const Combination& c) {
  Truth t;
  std::map<std::string, std::vector<double>> sizes;
  const Corner middle_of = place(0.5, 0.5, 0.5);
  t.errors.y_ref = middle_of[1], t.errors.z_ref = middle_of[2];
  double largest = 0.0;
  for (const auto& [name, size] : c) largest = std::max(largest, std::fabs(size));
  for (const auto& [name, size] : c) {
    const std::string error = name.substr(0, 3);
    const std::size_t degree = name.size() > 3 ? static_cast<std::size_t>(name[4] - '0') : 0;
    double most = 0.0;  // a size of 1 makes at most 1 in the volume
    for (const Corner& at : lattice(low, high, 2))
      for (const double e : rigid_term(error, degree, at, low, high))
        most = std::max(most, std::fabs(e));
    const double scale = most > 0.0 ? 1.0 / most : 2.0 / (high[0] - low[0]);
    const double value = 20 * um * size / largest * scale;
    if (degree == 0) {
      (error == "C0Y" ? t.errors.C0Y : error == "B0Z" ? t.errors.B0Z : t.errors.A0Z) = value;
      continue;
    }
    auto& c4 = sizes[error];
    c4.resize(4, 0.0);
    c4[degree - 1] = value;
  }
  for (const auto& [error, c4] : sizes) {
    const std::size_t axis = axis_of(error);
    const double length = high[axis] - low[axis];
    t.errors[error] = [c4 = c4, length](double at) {
      double sum = 0.0;
      for (std::size_t k = 0; k < 4; ++k) sum += c4[k] * legendre4(k + 1, 2.0 * at / length - 1.0);
      return sum;
    };
  }
  return t;
}

TEST(RigidBody, NoReadingShowsACombinationThatIsNamed) {
  std::mt19937_64 random(5);
  const RigidSolution of =
      solved(step_campaign(any_machine(random, 10, 15), {}), wish_of_fourth_degree());
  EXPECT_EQ(of.rank + of.combinations.size() + 4, of.unknowns);  // EAX has four terms
  ASSERT_GE(of.combinations.size(), 10u);
  // Yaw that grows evenly is a bow of the straightness: -(x - X/2) ECX of docs/formulas.md.
  const auto yaw = std::find_if(of.combinations.begin(), of.combinations.end(),
                                [](const auto& c) { return c.front().first == "ECX.1"; });
  ASSERT_NE(yaw, of.combinations.end());
  ASSERT_EQ(yaw->size(), 2u);
  EXPECT_EQ(yaw->back().first, "EYX.2");
  EXPECT_NEAR(yaw->back().second, 8.0 / 9.0, 1e-6);
  EXPECT_FALSE(of.map.known());
  for (const Combination& c : of.combinations) {
    const Truth t = machine_of(c);
    const RigidSolution s = solved(step_campaign(t, {}), wish_of_fourth_degree());
    for (const RigidCurve& curve : s.curves)
      for (const double v : curve.value) EXPECT_NEAR(v, 0.0, 0.05 * um) << c.front().first;
    for (const double scatter : s.scatter) EXPECT_LT(scatter, 0.05 * um) << c.front().first;
  }
}

TEST(RigidBody, ErrorsTakenAsAbsentMakeTheRestKnown) {
  std::mt19937_64 random(6);
  Truth t = any_machine(random, 10, 0);
  RigidWish wish = wish_of_fourth_degree();
  wish.errors = {"EXX", "EYY", "EZZ", "EYX", "EZX", "EXY",
                 "EZY", "EXZ", "EYZ", "C0Y", "B0Z", "A0Z"};
  const RigidSolution s = solved(step_campaign(t, {}), wish);
  EXPECT_TRUE(s.combinations.empty());
  ASSERT_TRUE(s.map.known());
  for (const VolumeNode& n : s.map.nodes) {
    const Corner exact = exact_error(t, n.at);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(n.error[k], exact[k], 0.05 * um);
  }
}

TEST(RigidBody, RefusesWhatItDoesNotKnow) {
  std::mt19937_64 random(7);
  const Truth t = any_machine(random, 10, 15);
  RigidWish wish = wish_of_fourth_degree();
  wish.errors = {"EXW"};
  EXPECT_FALSE(solve_rigid_body(step_campaign(t, {}), wish));
  EXPECT_FALSE(solve_rigid_body({straightedge(t, place(0, 0, 0), place(1, 0, 0), 1, 2, 0.0, {})},
                                wish_of_fourth_degree()));
}

/// How often u covers the truth, with Student's factor of the budget.
struct Covered {
  std::size_t in = 0, of = 0;
  void see(double error, double U) { in += std::fabs(error) <= U ? 1 : 0, ++of; }
  double percent() const { return 100.0 * static_cast<double>(in) / static_cast<double>(of); }
};

// 2,000 campaigns: NONIO_CAMPAIGNS=2000 test_rigid_body --gtest_filter=*Covers*
TEST(RigidBody, UCoversTheExactMachine) {
  const char* asked = std::getenv("NONIO_CAMPAIGNS");
  const int campaigns = asked != nullptr ? std::atoi(asked) : 40;
  const std::uint64_t seed = 20261129;
  std::mt19937_64 random(seed);
  std::map<std::string, Covered> covered;
  for (int i = 0; i < campaigns; ++i) {
    const Truth t = any_machine(random, 10, 15);
    const RigidSolution s = solved(whole_campaign(t, &random, 0.5 * um), wish_of_fourth_degree());
    ASSERT_TRUE(s.map.known());
    double largest = 0.0;
    for (const VolumeNode& n : s.map.nodes) {
      const Corner exact = exact_error(t, n.at);
      largest = std::max(largest, std::hypot(exact[0], exact[1], exact[2]));
    }
    covered["V_max"].see(s.map.size - largest, 2.0 * s.map.u_size);
    const VolumeNode& n = s.map.nodes[random() % 124 + 1];
    for (std::size_t k = 0; k < 3; ++k)
      if (n.u[k] > 0.0) covered["map"].see(n.error[k] - exact_error(t, n.at)[k], 2.0 * n.u[k]);
    const std::array<double, 3> truth{t.errors.C0Y, t.errors.B0Z, t.errors.A0Z};
    for (std::size_t k = 0; k < 3; ++k)
      covered["squareness"].see(s.squareness[k].second.value - truth[k],
                                2.0 * s.squareness[k].second.u);
  }
  std::cout << "seed " << seed << ", " << campaigns << " campaigns\n";
  for (const auto& [name, c] : covered) {
    std::cout << name << ": " << c.percent() << " % of " << c.of << "\n";
    const double three = 300.0 * std::sqrt(0.95 * 0.05 / static_cast<double>(c.of));
    EXPECT_NEAR(c.percent(), 95.0, std::max(1.0, three)) << name;
  }
}

}  // namespace
}  // namespace nonio::math::rigid_body_test
