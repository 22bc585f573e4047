// SPDX-License-Identifier: Apache-2.0
// Noise that is not independent readings of one scatter: measured, used, and told.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numeric>
#include <random>

#include "nonio/model/comparison.h"

namespace nonio::model::noise_test {

namespace {

using Matrix = std::vector<std::vector<double>>;

/// Runs there and back over evenly spaced targets of 1 m.
struct Table {
  Part part;
  std::vector<double> t;

  Table(std::size_t targets, std::uint32_t runs) {
    part.name = "X", part.measurements = {"X"};
    part.axes.push_back({.name = "X"});
    Observations& o = part.table;
    o.measurement = "X";
    o.axes = {{"X", false, {}, {}}};
    o.lines = {{"X", {1.0, 0.0, 0.0}}};
    for (std::uint32_t run = 1; run <= runs; ++run)
      for (const int way : {1, -1})
        for (std::size_t k = 0; k < targets; ++k) {
          const std::size_t at = way > 0 ? k : targets - 1 - k;
          o.axes[0].position.push_back(static_cast<double>(at) / static_cast<double>(targets - 1));
          o.axes[0].approach.push_back(static_cast<std::int8_t>(way));
          o.run.push_back(run);
          o.deviation.push_back(0.0);
          t.push_back(static_cast<double>(t.size()));
        }
  }
  std::size_t size() const { return t.size(); }
  double position(std::size_t i) const { return part.table.axes[0].position[i]; }
  double& at(std::size_t i) { return part.table.deviation[i]; }
};

/// Adds noise of standard deviation `s` whose neighbours in time have the correlation `rho`.
void add_noise(Table& table, double rho, double s, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  double e = normal(random);
  for (std::size_t i = 0; i < table.size(); ++i) {
    table.at(i) += s * e;
    e = rho * e + std::sqrt(1.0 - rho * rho) * normal(random);
  }
}

Comparison compared(const Table& table) {
  auto c = compare(table.part, {});
  EXPECT_TRUE(c) << c.error().message;
  return *c;
}

/// x of A x = b, by Gauss and Jordan.
std::vector<double> solved(Matrix a, std::vector<double> b) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t best = k;
    for (std::size_t i = k; i < n; ++i)
      if (std::fabs(a[i][k]) > std::fabs(a[best][k])) best = i;
    std::swap(a[k], a[best]), std::swap(b[k], b[best]);
    for (std::size_t i = 0; i < n; ++i) {
      if (i == k) continue;
      const double f = a[i][k] / a[k][k];
      for (std::size_t j = k; j < n; ++j) a[i][j] -= f * a[k][j];
      b[i] -= f * b[k];
    }
  }
  for (std::size_t k = 0; k < n; ++k) b[k] /= a[k][k];
  return b;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

}  // namespace

/// Covariance of two readings by its definition, against the filter: zero and s of a fit.
TEST(Noise, generalised_least_squares_agree_with_the_dense_covariance) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  for (const bool rough : {false, true})
    for (const double rho : {0.0, 0.3, 0.6}) {
      SCOPED_TRACE(rho);
      Table table(4, 3);
      const std::size_t n = table.size();
      Noise noise;
      noise.neighbours = noise.in_repeats = rho;
      for (std::size_t i = 0; i < n; ++i) {
        table.at(i) = normal(random);
        noise.pass.push_back(static_cast<std::uint32_t>(i / 4));
        noise.rough.push_back(rough && i % 4 == 1 ? 2.0 : 1.0);
      }
      std::vector<double> weight(n, 1.0);
      weight[6] = 0.0;
      std::vector<std::size_t> used;
      for (std::size_t i = 0; i < n; ++i)
        if (weight[i] > 0.0) used.push_back(i);
      Matrix v(used.size(), std::vector<double>(used.size(), 0.0));
      std::vector<double> y, ones(used.size(), 1.0);
      for (std::size_t a = 0; a < used.size(); ++a) {
        y.push_back(table.at(used[a]));
        for (std::size_t b = 0; b < used.size(); ++b) {
          const std::size_t i = used[a], j = used[b];
          const double apart = std::fabs(static_cast<double>(i) - static_cast<double>(j));
          // On through the passes: a machine does not forget where it turns.
          v[a][b] += (i == j ? 1.0 : std::pow(rho, apart)) * noise.rough[i] * noise.rough[j];
        }
      }
      const auto inverse_one = solved(v, ones);
      const double mean = dot(inverse_one, y) / dot(inverse_one, ones);
      for (double& x : y) x -= mean;
      const double squares = dot(solved(v, y), y);
      const auto fitted = fit(table.part.table, {}, weight, noise);
      ASSERT_TRUE(fitted) << fitted.error().message;
      EXPECT_NEAR(fitted->zero[0], mean, 1e-12);
      EXPECT_NEAR(fitted->s, std::sqrt(squares / static_cast<double>(used.size() - 1)), 1e-12);
    }
}

/// The terms of passes could follow the readings outside of a stretch closer with every round.
TEST(Noise, no_stretch_has_more_scatter_than_the_readings_show) {
  std::mt19937_64 random(23);
  int stretches = 0;
  for (int k = 0; k < 3000; ++k) {
    Table table(12, 3);
    add_noise(table, 0.0, 1e-6, random);
    table.at(static_cast<std::size_t>(k) % table.size()) += 6e-6;
    const Comparison c = compared(table);
    for (const double rough : c.fit.noise.rough) ASSERT_LT(rough, 5.0) << k;
    if (c.floor) ASSERT_LT(c.floor->s, 3e-6) << k;
    stretches += c.fit.noise.stretch ? 1 : 0;
  }
  EXPECT_LE(stretches, 30);  // found by chance in 0.5 % of tables of independent readings
}

TEST(Noise, the_correlation_of_neighbours_is_measured_without_bias) {
  std::mt19937_64 random(21);
  for (const double rho : {0.0, 0.3, 0.6, 0.8}) {
    double sum = 0.0, floor = 0.0;
    int seen = 0;
    constexpr int tables = 100;
    for (int k = 0; k < tables; ++k) {
      Table table(15, 4);
      add_noise(table, rho, 1e-6, random);
      const Comparison c = compared(table);
      sum += c.fit.noise.measured;
      floor += c.floor->s * c.floor->s;
      seen += c.fit.noise.p < 0.01 ? 1 : 0;
    }
    EXPECT_NEAR(sum / tables, rho, 0.06) << rho;
    EXPECT_NEAR(std::sqrt(floor / tables), 1e-6, 0.1e-6) << rho;
    if (rho == 0.0) {
      EXPECT_LE(seen, 6);
    } else if (rho > 0.5) {
      EXPECT_GE(seen, 85) << rho;
    }
  }
}

TEST(Noise, a_missing_growth_is_no_noise_with_few_targets) {
  std::mt19937_64 random(31);
  for (const std::size_t targets : {5U, 6U, 8U}) {
    Table table(targets, 5);
    add_noise(table, 0.0, 1e-6, random);
    const double before = compared(table).floor->s;
    const double whole = static_cast<double>(table.size());
    for (std::size_t i = 0; i < table.size(); ++i)
      table.at(i) += 20e-6 * (table.position(i) - 0.5) * table.t[i] / whole;
    EXPECT_NEAR(compared(table).floor->s, before, 0.1 * before) << targets;
  }
}

TEST(Noise, coarse_digits_are_measured_and_bound_the_floor) {
  std::mt19937_64 random(41);
  Table table(11, 3);
  add_noise(table, 0.0, 0.05e-6, random);
  for (std::size_t i = 0; i < table.size(); ++i) table.at(i) += 4e-6 * table.position(i);
  for (double& x : table.part.table.deviation) x = std::round(x / 1e-6) * 1e-6;
  const Comparison c = compared(table);
  EXPECT_NEAR(c.fit.noise.digit, 1e-6, 1e-9);
  EXPECT_GE(c.floor->s, 1e-6 / std::sqrt(12.0));
  EXPECT_TRUE(c.suspects.empty());
}

TEST(Noise, a_rough_stretch_is_found_and_weighted) {
  std::mt19937_64 random(51);
  std::normal_distribution<double> normal;
  Table table(21, 5);
  for (std::size_t i = 0; i < table.size(); ++i)
    table.at(i) =
        (table.position(i) > 0.59 && table.position(i) < 0.91 ? 4e-6 : 1e-6) * normal(random);
  const Noise noise = compared(table).fit.noise;
  ASSERT_TRUE(noise.stretch);
  EXPECT_NEAR(noise.stretch->from, 0.6, 0.051);
  EXPECT_NEAR(noise.stretch->to, 0.9, 0.051);
  EXPECT_NEAR(noise.stretch->inside / noise.stretch->outside, 4.0, 1.2);
  std::size_t suspects = 0;  // scatter, no misreadings: 38 in a hundred such tables
  for (int k = 0; k < 20; ++k) {
    for (std::size_t i = 0; i < table.size(); ++i)
      table.at(i) =
          (table.position(i) > 0.59 && table.position(i) < 0.91 ? 4e-6 : 1e-6) * normal(random);
    suspects += compared(table).suspects.size();
  }
  EXPECT_LE(suspects, 16U);
  for (std::size_t i = 0; i < table.size(); ++i) table.at(i) = 1e-6 * normal(random);
  EXPECT_FALSE(compared(table).fit.noise.stretch);
}

/// ISO 230-2 asks for one run over a long axis and repeats over a part of it. Cells that are not
/// repeated say nothing about the scatter.
TEST(Noise, repeats_of_a_part_of_the_targets_give_the_scatter_of_the_readings) {
  const std::uint64_t seed = std::random_device{}();
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  constexpr double scatter = 0.6e-6;
  for (const std::size_t targets : {10, 21, 31})
    for (const double share : {0.2, 0.35, 0.5, 0.7, 0.9})
      for (const std::uint32_t repeats : {2U, 5U}) {
        Table table(targets, 1 + repeats);
        add_noise(table, 0.0, scatter, random);
        const double half = 0.5 * share;
        std::vector<char> kept(table.size());
        for (std::size_t i = 0; i < table.size(); ++i)
          kept[i] = table.part.table.run[i] == 1 || std::fabs(table.position(i) - 0.5) <= half;
        keep_rows(table.part.table, kept);
        const auto c = compare(table.part, {});
        ASSERT_TRUE(c) << c.error().message;
        if (!c->floor) continue;  // too few repeats
        // Far limits: a floor of few cells, or one with a correlation, varies by factors.
        const double least = std::min(0.1, std::exp(-20.0 / c->floor->dof));
        const double most = 8.0;
        EXPECT_GT(c->floor->s, least * scatter) << targets << " targets, " << share << " of them";
        EXPECT_LT(c->floor->s, most * scatter) << targets << " targets, " << share << " of them";
        double largest = 0.0;
        for (const double x : table.part.table.deviation) largest = std::max(largest, std::fabs(x));
        EXPECT_LT(c->fit.rms, 100.0 * largest);
      }
}

TEST(Noise, neighbours_that_are_alike_are_no_rough_stretch) {
  std::mt19937_64 random(52);  // taken for independent, a third of such tables has a stretch
  int stretches = 0;
  for (int k = 0; k < 40; ++k) {
    Table table(31, 3);
    add_noise(table, 0.8, 1e-6, random);
    stretches += compared(table).fit.noise.stretch ? 1 : 0;
  }
  EXPECT_LE(stretches, 4);
}

TEST(Noise, a_zero_of_each_run_is_in_u) {
  std::mt19937_64 random(61);
  std::normal_distribution<double> normal;
  int seen = 0, white = 0;
  for (int k = 0; k < 20; ++k) {
    Table table(11, 5);
    add_noise(table, 0.0, 1e-6, random);
    white += compared(table).fit.noise.zero != Noise::Zero::steady ? 1 : 0;
    double zero = 0.0;
    for (std::size_t i = 0; i < table.size(); ++i) {
      if (i % 22 == 0) zero = 2e-6 * normal(random);
      table.at(i) += zero;
    }
    seen += compared(table).fit.noise.zero == Noise::Zero::of_run ? 1 : 0;
  }
  EXPECT_GE(seen, 14);
  EXPECT_LE(white, 6);
}

namespace {

/// Growth with the reading, about its middle.
Effect drift_effect() {
  Effect drift;
  drift.info = {"drift", "1.0.0", "in time"};
  drift.linear = {{"z", "drift", Quantity::deviation, Quantity::deviation}};
  drift.applies = [](const Observations&, const Axis&) { return true; };
  drift.columns = [](const Observations& o, const Axis&,
                     const std::vector<double>&) -> Expected<Effect::Columns> {
    std::vector<double> t(o.size());
    std::iota(t.begin(), t.end(), 0.0);
    return Effect::Columns{t};
  };
  return drift;
}

}  // namespace

/// Each of few runs has its own zero: a drift is within 2 u in 95 % of the tables, or has no u.
TEST(Noise, few_runs_with_zeros_of_their_own_leave_u_large_or_open) {
  std::mt19937_64 random(81);
  std::normal_distribution<double> normal;
  const Effect drift = drift_effect();
  for (const std::uint32_t runs : {2U, 4U, 6U}) {
    int in = 0, said = 0;
    constexpr int tables = 60;
    for (int k = 0; k < tables; ++k) {
      Table table(11, runs);
      add_noise(table, 0.0, 1e-6, random);
      double zero = 0.0;
      for (std::size_t i = 0; i < table.size(); ++i) {
        if (i % 22 == 0) zero = 3e-6 * normal(random);
        table.at(i) += zero;
      }
      const auto c = compare(table.part, {{&drift, table.part.axes[0], {}}});
      ASSERT_TRUE(c) << c.error().message;
      const Parameter& p = c->fit.parameters.front();
      if (!std::isfinite(p.u)) {
        EXPECT_TRUE(c->fit.noise.zero_open);
        continue;
      }
      ++said;
      in += std::fabs(p.value) <= 2.0 * p.u ? 1 : 0;
    }
    SCOPED_TRACE(runs);
    if (runs > 2) {
      EXPECT_GE(said, tables / 3);
      EXPECT_GE(in, 0.85 * said);
    }
    std::printf("seed 81, %u runs: u of %d of %d drifts, %d within 2 u\n", runs, said, tables, in);
  }
}

/// u of a drift: sqrt(a V a) with a = least squares, by the dense covariance of its definition.
TEST(Noise, a_zero_that_is_not_steady_is_in_u_of_least_squares) {
  std::mt19937_64 random(71);
  std::normal_distribution<double> normal;
  const Effect drift = drift_effect();
  using Zero = Noise::Zero;
  for (const Zero zero : {Zero::walks, Zero::of_run, Zero::of_pass}) {
    SCOPED_TRACE(static_cast<int>(zero));
    Table table(4, 3);
    const std::size_t n = table.size();
    Noise noise;
    noise.zero = zero, noise.zero_size = 0.7;
    for (std::size_t i = 0; i < n; ++i) {
      table.at(i) = normal(random);
      noise.pass.push_back(static_cast<std::uint32_t>(i / 4));
    }
    Matrix v(n, std::vector<double>(n, 0.0));
    std::vector<double> a(n);
    double squares = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      a[i] = table.t[i] - static_cast<double>(n - 1) / 2.0;
      squares += a[i] * a[i];
      for (std::size_t j = 0; j < n; ++j) {
        const double shared = zero == Zero::walks    ? static_cast<double>(std::min(i, j))
                              : zero == Zero::of_run ? (i / 8 == j / 8 ? 1.0 : 0.0)
                                                     : (i / 4 == j / 4 ? 1.0 : 0.0);
        v[i][j] = (i == j ? 1.0 : 0.0) + 0.49 * shared;
      }
    }
    double variance = 0.0;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) variance += a[i] * v[i][j] * a[j] / squares / squares;
    const auto fitted = fit(table.part.table, {{&drift, table.part.axes[0], {}}}, {}, noise);
    ASSERT_TRUE(fitted) << fitted.error().message;
    // s of the noise itself: what is left, less its zero, in units of the whole covariance.
    const auto inverse_one = solved(v, std::vector<double>(n, 1.0));
    std::vector<double> left = fitted->residual;
    const double mean = dot(inverse_one, left) / dot(inverse_one, std::vector<double>(n, 1.0));
    for (double& x : left) x -= mean;
    const double s = std::sqrt(dot(solved(v, left), left) / static_cast<double>(n - 2));
    EXPECT_NEAR(fitted->parameters.front().u, s * std::sqrt(variance), 1e-12);
    double slope = 0.0;
    for (std::size_t i = 0; i < n; ++i) slope += a[i] * table.at(i) / squares;
    EXPECT_NEAR(fitted->parameters.front().value, slope, 1e-12);
  }
}

}  // namespace nonio::model::noise_test
