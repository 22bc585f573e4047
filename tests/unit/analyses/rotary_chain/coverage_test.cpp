// SPDX-License-Identifier: Apache-2.0
//
// How often U covers the truth: campaigns on the machine of homogeneous transforms, with linear axes
// out of square, drift, a ball and a probe with errors of their own.
//
//     NONIO_CAMPAIGNS=2000 test_rotary_chain --gtest_filter=*Covers*
#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>
#include <map>

#include "machine.h"

namespace nonio::chain_test {
namespace {

constexpr double U_fixed = 1.0 * um, drift = 1.0 * um, bound = 4.0 * urad, scatter = 0.8 * um;

struct Covered {
  int in = 0, of = 0;
  void see(double error, double U) { in += std::fabs(error) <= U ? 1 : 0, ++of; }
  double percent() const { return 100.0 * in / of; }
};
using Shares = std::map<std::string, Covered>;

/// Each coordinate with scatter, the ball's form, a walk, and what probe and instrument have in common.
std::vector<math::ChainReading> measured(std::vector<math::ChainReading> all, Builder& day) {
  const double step = drift / std::numbers::sqrt3 / std::sqrt(static_cast<double>(all.size() - 1));
  for (std::size_t k = 0; k < 3; ++k) {
    double walk = day.uniform(U_fixed / 2.0) + U_fixed / 2.0 * day.normal();
    for (auto& r : all) {
      r.at[k] += scatter * day.normal() + day.uniform(U_fixed / 2.0) + walk;
      walk += step * day.normal();
    }
  }
  return all;
}

void see(const Evaluation& e, const std::string& name, double truth, Shares& shares) {
  const Value* v = value(e, name);
  ASSERT_TRUE(v != nullptr && v->U) << name;
  shares[name].see(v->value - truth, *v->U);
}

void see_all(const Evaluation& e, const Machine& m, Shares& shares) {
  for (std::size_t j = 0; j < 2; ++j) {
    const std::string& name = m.joint(j).name;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto i = static_cast<int>(k);
      see(e, std::string("centre_") + "xyz"[k] + "_" + name, m.centre(j)[i], shares);
      if (std::fabs(m.direction(j)[i]) < 0.9)  // along the axis there is only a second order
        see(e, std::string("direction_") + "ijk"[k] + "_" + name, m.direction(j)[i], shares);
    }
    const Vector carried = j < m.tables.size() ? m.ball : Vector(0, 0, 0);
    see(e, "radius_" + name, (carried - m.centre(j)).norm(), shares);
  }
  see(e, "angle", std::acos(m.direction(0).dot(m.direction(1))), shares);
  if (m.tables.size() == 1) return;
  const Vector normal = m.direction(0).cross(m.direction(1)).normalized();
  see(e, "distance", std::fabs(normal.dot(m.point(1) - m.point(0))), shares);
}

constexpr double length = 0.12, longer = 0.1, U_tool = 3.0 * um;  // of two tools
const Vector along = Vector(300 * urad, -200 * urad, -1.0).normalized();

void see_tools(const Evaluation& e, const Machine& m, Shares& shares) {
  const Vector nose = m.tip - length * along;
  for (std::size_t j = 0; j < 2; ++j) {
    const Vector way = nose - m.heads[j].point, n = m.direction(j);
    see(e, "pivot_" + m.heads[j].name, (way - n * n.dot(way)).norm(), shares);
  }
  for (int k = 0; k < 2; ++k) see(e, std::string("tool_") + "ij"[k], along[k], shares);
}

class Campaigns {
 public:
  explicit Campaigns(std::uint64_t seed) : seed_(seed) {
    const char* asked = std::getenv("NONIO_CAMPAIGNS");
    count_ = asked != nullptr ? std::atoi(asked) : 40;
  }

  template <class Make>
  void cover(const char* what, const Positions& at, Make make) {
    Builder day(seed_);
    Shares shares;
    for (int i = 0; i < count_; ++i) {
      Machine m = make(day);
      for (int r = 0; r < 3; ++r)
        for (int c = r; c < 3; ++c) m.linear(r, c) = day.uniform(bound);
      const auto exact = readings(m, at);
      for (const auto& r : exact)
        m.middle += Vector(r.at[0], r.at[1], r.at[2]) / static_cast<double>(exact.size());
      const bool two = m.heads.size() == 2;
      auto all = readings(m, at);
      if (two) {
        m.tool = longer * along;
        for (const auto& r : readings(m, at)) all.push_back(r);
      }
      all = measured(std::move(all), day);
      const auto half = all.begin() + static_cast<std::ptrdiff_t>(exact.size());
      const double stated = length + U_tool / 2.0 * day.normal();
      Workshop shop(m);
      shop.stated(U_fixed, drift, bound / urad)
          .measured(observed({all.begin(), half}, m), two ? stated : 0.0);
      if (two) shop.measured(observed({half, all.end()}, m, "long"), stated + longer);
      const auto e = shop.with("tolerance_um", 1e5)
                         .with("tolerance_urad", 1e5)
                         .with("tool_U_um", U_tool / um)
                         .with("same_reference", std::vector<std::string>{"BC", "long"})
                         .evaluated();
      ASSERT_TRUE(e);
      see_all(*e, m, shares);
      if (two) see_tools(*e, m, shares);
    }
    std::cout << what << ", seed " << seed_ << ", " << count_ << " campaigns\n";
    for (const auto& [name, c] : shares) {
      std::cout << "  " << name << ": " << c.percent() << " % of " << c.of << "\n";
      // U is for 95.45 %; of forty values one may be three standard deviations off.
      const double three = 300.0 * std::sqrt(0.95 * 0.05 / c.of);
      EXPECT_NEAR(c.percent(), 95.45, std::max(1.0, three)) << what << " " << name;
    }
  }

 private:
  std::uint64_t seed_;
  int count_ = 0;
};

TEST(RotaryChainCoverage, UCoversTheExactTables) {
  Campaigns(20261126).cover("B carries C", grid(tilts, turns),
                            [](Builder& day) { return day.tables(); });
}

TEST(RotaryChainCoverage, UCoversTheExactHeadAndTable) {
  Campaigns(20261127).cover("head B, table C", grid(turns, tilts),
                            [](Builder& day) { return day.head_and_table(); });
}

TEST(RotaryChainCoverage, UCoversTheExactHeads) {
  Campaigns(20261128).cover("head C carries B", grid(turns, {-90, -45, 0, 45, 90}),
                            [](Builder& day) { return day.heads(); });
}

}  // namespace
}  // namespace nonio::chain_test
