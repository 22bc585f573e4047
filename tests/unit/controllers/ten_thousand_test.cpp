// SPDX-License-Identifier: Apache-2.0
// Laws of every table, over 10,000 random curves: what the control makes of the file is within half
// a step of -e at every point, increments are in their range, turns close.
#include <cmath>
#include <numbers>

#include "workshop.h"

namespace ten_thousand_test {

using namespace workshop;

namespace {

struct Kind {
  const char* plugin;
  Options options;
  double step;  ///< of an entry, m
  bool below = false;
};

std::vector<Kind> kinds() {
  const Setting counts = std::vector<std::string>{"X counts_per_mm=2000"};
  return {{"siemens-840d", {}, 1e-9},
          {"heidenhain-tnc", {}, 1e-7},
          {"fanuc", {{"extended", true}}, 1e-6},
          {"linuxcnc", {{"type", std::int64_t{1}}}, 1e-11},
          {"twincat-cnc", {}, 1e-7},
          {"twincat-nc-ptp", {}, 1e-9},
          {"twincat-volumetric", {{"sign", std::string("error")}}, 1e-9},
          {"fagor-8055", {{"sign", std::string("error")}}, 1e-7},
          {"haas-classic", {{"sign", std::string("correction")}}, 2.54e-6, true},
          {"mitsubishi", {}, 0.5e-6},
          {"pmac", {{"axes", counts}}, 1.0 / 32e6},
          {"aerotech", {}, 1e-9},
          {"ecmc", {}, 1e-9}};
}

/// From 0 towards one side: every control can have that.
Measured random_axis(std::mt19937& random, bool below) {
  std::uniform_int_distribution<int> points(4, 40), wide(1, 8);
  Measured m;
  const int n = points(random);
  const double step = below ? 12.7 * mm : wide(random) * 5 * mm;
  m.targets = even(below ? -step * (n - 1) : 0.0, step, n);
  m.plus = random_curve(random, step * n, 8 * um);
  m.minus = [p = m.plus](double x) { return p(x) + 4 * um; };
  return m;
}

std::string rebuilt(const Kind& k, std::uint32_t seed, int round) {
  return std::string(k.plugin) + ", seed " + std::to_string(seed) + ", round " +
         std::to_string(round);
}

}  // namespace

TEST(TenThousandCurves, EveryEntryIsWithinHalfAStep) {
  const std::uint32_t seed = 20260;
  print_seed(seed);
  std::mt19937 random(seed);
  const auto all = kinds();
  std::vector<Controller> outputs;
  for (const Kind& k : all) outputs.push_back(plugin(k.plugin));
  for (int round = 0; round < 10000; ++round) {
    const std::size_t which = static_cast<std::size_t>(round) % all.size();
    const Kind& k = all[which];
    const Bench b(random_axis(random, k.below));
    const auto r = b.write(outputs[which], k.options);
    ASSERT_TRUE(r) << rebuilt(k, seed, round) << ": " << r.error().message;
    const auto read = read_back(outputs[which], r->artifacts, k.options, {{.name = "X"}});
    ASSERT_TRUE(read) << rebuilt(k, seed, round) << ": " << read.error().message;
    ASSERT_EQ(read->size(), 1U);
    const LoadedTable& t = read->front();
    ASSERT_TRUE(math::validate_table(t));
    const auto curve = curve_of(b);
    const bool both = !t.minus.empty();
    const auto error_at = [&](double x) {
      return math::ErrorCurve::at(curve.position, both ? curve.plus : curve.mean, x);
    };
    // Where entries are zero is the control's affair: the constant is that of one point.
    double low = 1.0, high = -1.0;
    for (std::size_t i = 0; i < t.plus.size(); ++i) {
      const double x = t.position[0][i];
      const bool beyond = x < curve.position.front() - 1e-9 || x > curve.position.back() + 1e-9;
      if (beyond) continue;  // an interval before the first target, the closing one of PMAC
      const double off = t.plus[i] + error_at(x);
      low = std::min(low, off), high = std::max(high, off);
    }
    ASSERT_LE(high - low, k.step * (1 + 1e-6) + 5e-12) << rebuilt(k, seed, round);
  }
}

TEST(TenThousandCurves, IncrementsAreInRangeAndTurnsClose) {
  const std::uint32_t seed = 20261;
  print_seed(seed);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  const Controller fanuc = fanuc_plugin(), cnc = plugin("twincat-cnc");
  for (int round = 0; round < 2000; ++round) {
    Measured m;
    m.axis = m.id = "C";
    m.rotary = true;
    m.targets = even(0.0, 15 * deg, 24);
    const double a = 8 * arcsec * u(random), p = 3 * u(random), open = arcsec * u(random);
    m.plus = [=](double x) { return a * std::sin(x + p) + open * x; };  // need not close
    m.minus = [e = m.plus](double x) { return e(x) + 5 * arcsec; };
    for (const Controller* output : {&fanuc, &cnc}) {
      const Options options = output == &fanuc
                                  ? Options{{"extended", true}, {"detection_unit_arcsec", 0.36}}
                                  : Options{};
      const auto r = Bench(m).write(*output, options);
      ASSERT_TRUE(r) << r.error().message << ", seed " << seed << ", round " << round;
      // The parser refuses increments out of range, and turns that do not close.
      const auto read = read_back(*output, r->artifacts, options, {{.name = "C", .rotary = true}});
      ASSERT_TRUE(read) << read.error().message << ", seed " << seed << ", round " << round;
      const LoadedTable& t = read->front();
      EXPECT_EQ(t.outside, LoadedTable::Outside::repeats);
      EXPECT_EQ(t.plus.front(), t.plus.back());
      const double x = 3.3, next = x + 2 * std::numbers::pi;
      EXPECT_NEAR(math::added(t, std::span(&x, 1), 1), math::added(t, std::span(&next, 1), 1),
                  1e-15);
    }
  }
}

/// A wrong law is caught by the same measure.
TEST(TenThousandCurves, DriftOfRoundedIncrementsWouldBeSeen) {
  std::mt19937 random(7);
  const Curve e = random_curve(random, 1.0, 8 * um);
  std::int64_t sum = 0;
  double worst = 0.0;
  for (int i = 1; i <= 100; ++i) {
    sum += std::llround((e(i * 0.01) - e((i - 1) * 0.01)) / um);  // each rounded on its own
    worst = std::max(worst, std::fabs(static_cast<double>(sum) * um - (e(i * 0.01) - e(0.0))));
  }
  EXPECT_GT(worst, 0.5 * um);
}

}  // namespace ten_thousand_test
