// SPDX-License-Identifier: Apache-2.0
//
// Two runs whose passes shift while they are measured look like a reversal. No control gets a value of
// it, and no prediction is better than the uncertainty of what the table compensates.
#include <algorithm>
#include <numeric>

#include "workshop.h"

namespace reversal_known_test {

using namespace workshop;

namespace {

constexpr double true_B = -2 * um;

struct Kind {
  const char* name;
  Controller (*output)();
  Options options;
};

std::vector<Kind> kinds() {
  return {{"siemens-840d", siemens_plugin, {}},
          {"siemens-840d", siemens_plugin, {{"directions", true}}},
          {"heidenhain-tnc", heidenhain_plugin, {}},
          {"heidenhain-tnc", heidenhain_plugin, {{"directions", true}}},
          {"fanuc", fanuc_plugin, {{"extended", true}}},
          {"linuxcnc", linuxcnc_plugin, {}}};
}

/// One shift for each pass, in the order + - + - ...
Bench bench_of(const std::vector<double>& shifts, double B, std::uint32_t seed) {
  Measured m;
  m.targets = even(0.0, 100 * mm, 9);
  m.plus = [B](double x) { return 10 * um * std::sin(5 * x) + B / 2; };
  m.minus = [B](double x) { return 10 * um * std::sin(5 * x) - B / 2; };
  m.runs = static_cast<int>(shifts.size() / 2);
  m.scatter = 0.3 * um;
  m.seed = seed;
  Bench bench(m);
  for (std::size_t i = 0; i < bench.observations[0].size(); ++i)
    bench.observations[0].deviation[i] += shifts[i / m.targets.size()];
  return bench;
}

}  // namespace

TEST(ReversalKnown, NoValueIsMadeOfPassesThatShift) {
  constexpr std::uint32_t seed = 20261128;
  print_seed(seed);
  std::mt19937 random(seed);
  std::normal_distribution<double> step(0.0, 5 * um);
  int held = 0, campaigns = 0;
  for (int round = 0; round < 24; ++round) {
    std::vector<double> shifts{0.0, 3.3 * um, 6.7 * um, 10 * um};
    if (round >= 12)
      for (std::size_t p = 1; p < shifts.size(); ++p) shifts[p] = shifts[p - 1] + step(random);
    const Bench b = bench_of(shifts, true_B, static_cast<std::uint32_t>(random()));
    const double U = U_of_mean_reversal(b);
    for (const Kind& k : kinds()) {
      const auto r = b.write(k.output(), k.options);
      ASSERT_TRUE(r) << k.name << ": " << r.error().message;
      if (r->artifacts.empty()) continue;  // refused
      ++campaigns;
      const Finding* f = finding(*r, "table.backlash-not-identifiable");
      const Prediction& B = prediction(*r, "B");
      if (f == nullptr) {
        // The value may be written, but it is known within half of itself and never promises more than U.
        const double mean = prediction(*r, "B").before;
        EXPECT_LT(U, mean) << k.name << ", round " << round;
        EXPECT_GE(B.after, U * (1 - 1e-9)) << k.name << ", round " << round;
        continue;
      }
      ++held;
      EXPECT_EQ(f->evidence.at(0).name, "mean");
      EXPECT_EQ(f->evidence.at(1).name, "U");
      EXPECT_NEAR(f->evidence[1].value, U, 1e-12);
      EXPECT_GE(f->evidence[1].value, 0.5 * std::fabs(f->evidence[0].value));
      EXPECT_NEAR(B.after, B.before, 1e-9) << k.name << ", round " << round;
      const auto c = control(k.output(), r->artifacts, k.options);
      ASSERT_TRUE(c) << k.name << ": " << c.error().message;
      for (const double x : {0.1, 0.4, 0.7})
        EXPECT_NEAR((*c)(x, 1), (*c)(x, -1), 1e-9) << k.name << ", round " << round;
      if (round < 12) EXPECT_TRUE(f->attention) << k.name << ", round " << round;
    }
  }
  std::cout << "held back in " << held << " of " << campaigns << " tables\n";
  EXPECT_GE(held, 12 * static_cast<int>(kinds().size()));
}

TEST(ReversalKnown, AStationaryReversalIsCompensatedAndPromisedNoBetterThanU) {
  constexpr std::uint32_t seed = 20261129;
  print_seed(seed);
  for (const int runs : {2, 3, 5})
    for (const double B : {-8 * um, 8 * um}) {
      const std::vector<double> still(static_cast<std::size_t>(2 * runs), 0.0);
      const Bench b = bench_of(still, B, seed + static_cast<std::uint32_t>(runs));
      for (const Kind& k : kinds()) {
        const auto r = b.write(k.output(), k.options);
        ASSERT_TRUE(r) << k.name << ": " << r.error().message;
        EXPECT_EQ(finding(*r, "table.backlash-not-identifiable"), nullptr) << k.name;
        const Prediction& after = prediction(*r, "B");
        EXPECT_GE(after.after, U_of_mean_reversal(b) * (1 - 1e-9)) << k.name;
        EXPECT_LT(after.after, 0.5 * after.before) << k.name;
      }
    }
}

// U(E) of a long machine that is far from 20 degC is larger than what the replay leaves.
TEST(ReversalKnown, PitchIsPromisedNoBetterThanItsU) {
  Bench b = bench_of({0.0, 0.0, 0.0, 0.0, 0.0, 0.0}, -8 * um, 5);
  b.campaign.machine.axes[0].expansion = 11.5e-6;
  b.campaign.instrument.U_fixed = 0.1 * um;
  b.campaign.instrument.U_per_length = 0.5e-6;
  Environment& e = b.campaign.environment;
  e.misalignment = 0.5 * mm;
  e.temperature_range = 1.0;
  e.temperature_difference = 2.0;
  e.expansion_range = 1e-6;
  e.drift = 0.5 * um;
  for (const Kind& k : kinds()) {
    const auto r = b.write(k.output(), k.options);
    ASSERT_TRUE(r) << k.name << ": " << r.error().message;
    for (const char* name : {"E", "M"})
      EXPECT_GT(prediction(*r, name).after, 5 * um)
          << k.name << " " << name;  // U_M alone: 0.6 * 9.2 um
  }
}

}  // namespace reversal_known_test
