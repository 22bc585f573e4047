// SPDX-License-Identifier: Apache-2.0
//
// The kernel against homogeneous transforms, and against the fit of one axis.
#include <gtest/gtest.h>

#include "machine.h"

namespace nonio::chain_test {
namespace {

using math::ChainFit;
using math::ChainRefusal;

Vector eigen(const math::Vector3& v) { return {v[0], v[1], v[2]}; }

void expect_machine(const Machine& m, const Positions& at) {
  const auto fit = math::fit_chain(readings(m, at), order_of(m));
  ASSERT_TRUE(fit) << static_cast<int>(fit.error());
  EXPECT_EQ(fit->rank, 11U);
  EXPECT_TRUE(fit->open.empty());
  EXPECT_LT(fit->s, 1e-12);
  for (std::size_t j = 0; j < m.axes(); ++j) {
    EXPECT_LT((eigen(fit->state.lines[j].point) - m.centre(j)).norm(), 1e-11) << m.joint(j).name;
    EXPECT_LT((eigen(fit->state.lines[j].direction) - m.direction(j)).norm(), 1e-10);
  }
  EXPECT_LT((eigen(fit->state.ball[0]) - m.ball).norm(), 1e-11);
}

TEST(RotaryChain, ExactReadingsGiveTheExactLines) {
  const std::uint64_t seed = 20261126;
  SCOPED_TRACE(seed);
  Builder builder(seed);
  for (int i = 0; i < 3; ++i) {
    expect_machine(builder.tables(), grid(tilts, turns));
    expect_machine(builder.tables(Vector::UnitX()), grid({-90, -45, 0, 20}, {0, 100, 200}));
    expect_machine(builder.tables(-Vector::UnitY()), grid(tilts, turns));
    expect_machine(builder.tables(Vector(0, 1, 1)), grid({0, 60, 120, 180}, turns));
    expect_machine(builder.head_and_table(), grid(turns, tilts));
    expect_machine(builder.heads(), grid(turns, {-90, -45, 0, 45, 90}));
  }
}

/// Rows of one axis only: what the fit of that axis says, to rounding.
TEST(RotaryChain, WithOneFixedAtZeroItIsTheFitOfTheOther) {
  Builder builder(3);
  for (const bool tilting : {false, true}) {
    const Machine m = builder.tables();
    auto all = readings(m, tilting ? grid(tilts, {0}) : grid({0}, turns));
    std::vector<math::BallCentre> centres;
    for (auto& r : all) {
      for (double& x : r.at) x += 1.0 * um * builder.normal();
      centres.push_back({r.at, r.angle[tilting ? 0 : 1], 1.0});
    }
    const auto chain = math::fit_chain(all, order_of(m));
    const auto alone = math::fit_rotary(centres, true);
    ASSERT_TRUE(chain && alone);
    EXPECT_EQ(chain->rank, 7U);
    EXPECT_EQ(chain->dof, alone->dof);
    EXPECT_NEAR(chain->s, alone->s, 1e-5 * alone->s);
    const std::size_t j = tilting ? 0 : 1;
    const auto centre = [&](const math::ChainState& s) {
      return nearest_on(s.lines[j], s.ball[0]);
    };
    for (std::size_t k = 0; k < 3; ++k) {
      const auto c = chain_value(*chain, [&](const auto& s) { return centre(s)[k]; });
      const auto n = chain_value(*chain, [&](const auto& s) { return s.lines[j].direction[k]; });
      EXPECT_TRUE(c.identifiable);
      EXPECT_NEAR(c.value, alone->centre[k], 1e-10);
      EXPECT_NEAR(n.value, alone->direction[k], 1e-9);
      double variance = 0.0;
      for (const double by : c.by) variance += by * by;
      EXPECT_NEAR(std::sqrt(variance), std::sqrt(alone->cofactor[k][k]), 1e-4);
    }
    for (const std::size_t k : chain->across[1 - j])
      EXPECT_FALSE(
          chain_value(*chain, [&](const auto& s) { return s.lines[1 - j].point[k]; }).identifiable);
    EXPECT_FALSE(chain_value(*chain, [](const auto& s) {
                   return signed_distance(s.lines[0], s.lines[1]);
                 }).identifiable);
  }
}

TEST(RotaryChain, WithTheCarryingAxisFixedElsewhereNothingAtZeroIsIdentifiable) {
  const Machine m = Builder(5).tables();
  const auto fit = math::fit_chain(readings(m, grid({30}, turns)), order_of(m));
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->rank, 7U);
  EXPECT_FALSE(
      chain_value(*fit, [](const auto& s) { return s.lines[1].direction[0]; }).identifiable);
}

TEST(RotaryChain, TheOrderMattersWhereBothTurn) {
  const Machine m = Builder(6).tables();
  auto all = readings(m, grid(tilts, turns));
  for (auto& r : all) std::swap(r.angle[0], r.angle[1]);
  const auto wrong = math::fit_chain(all, order_of(m));
  EXPECT_TRUE(!wrong || wrong->s > 5e-3);
  // On a cross of positions it does not.
  Positions cross = grid(tilts, {0});
  for (const auto& at : grid({0}, turns)) cross.push_back(at);
  all = readings(m, cross);
  for (auto& r : all) std::swap(r.angle[0], r.angle[1]);
  const auto either = math::fit_chain(all, order_of(m));
  ASSERT_TRUE(either);
  EXPECT_LT(either->s, 1e-12);
  EXPECT_LT((eigen(either->state.lines[0].point) - m.centre(1)).norm(), 1e-11);
}

TEST(RotaryChain, RefusesByName) {
  const Machine m = Builder(7).tables();
  auto error = [&](const std::vector<math::ChainReading>& all) {
    const auto fit = math::fit_chain(all, order_of(m));
    return fit ? std::optional<ChainRefusal>() : fit.error();
  };
  EXPECT_EQ(error(readings(m, grid({0, 180}, turns))), ChainRefusal::ambiguous);
  EXPECT_EQ(error(readings(m, grid({0}, {0}))), ChainRefusal::too_few);
  EXPECT_EQ(error({}), ChainRefusal::too_few);
  auto all = readings(m, grid(tilts, turns));
  for (const double bad : std::array<double, 3>{NAN, INFINITY, 1e20}) {
    auto other = all;
    other[3].at[1] = bad;
    EXPECT_EQ(error(other), ChainRefusal::not_finite);
  }
  all[2].angle[1] = NAN;
  EXPECT_EQ(error(all), ChainRefusal::not_finite);
}

TEST(RotaryChain, ABallOnAnAxisDoesNotDetermineItsDirection) {
  Machine m = Builder(8).tables();
  m.ball = m.tables[1].point;
  const auto fit = math::fit_chain(readings(m, grid(tilts, turns)), order_of(m));
  ASSERT_TRUE(fit);
  EXPECT_FALSE(
      chain_value(*fit, [](const auto& s) { return s.lines[1].direction[0]; }).identifiable);
  EXPECT_FALSE(fit->open.empty());
  // That of the other one it does.
  EXPECT_TRUE(
      chain_value(*fit, [](const auto& s) { return s.lines[0].direction[0]; }).identifiable);
}

/// An error of a reading moves each value by its derivative.
TEST(RotaryChain, DerivativesAreThoseOfTheFit) {
  const Machine m = Builder(9).head_and_table();
  auto all = readings(m, grid(turns, tilts));
  const auto value = [](const math::ChainState& s) { return nearest_on(s.lines[1], {})[0]; };
  const auto fit = math::fit_chain(all, order_of(m));
  ASSERT_TRUE(fit);
  const auto before = chain_value(*fit, value);
  const std::size_t n = all.size();
  for (const std::size_t i : {0U, 5U, 17U})
    for (std::size_t k = 0; k < 3; ++k) {
      auto other = all;
      other[i].at[k] += 1 * um;
      const auto moved = math::fit_chain(other, order_of(m));
      ASSERT_TRUE(moved);
      EXPECT_NEAR(value(moved->state) - before.value, 1 * um * before.by[k * n + i], 1e-10);
      for (const std::size_t r : {i, (i + 7) % n})
        EXPECT_NEAR(moved->residual[r][k] - fit->residual[r][k],
                    1 * um * fit->residual_by[k * n + r][k * n + i], 1e-10);
    }
}

}  // namespace
}  // namespace nonio::chain_test
