// SPDX-License-Identifier: Apache-2.0
#include "nonio/math/decision.h"

#include <gtest/gtest.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <tuple>

#include "campaign/evaluation/evaluate.h"
#include "campaign/evaluation/evaluation.h"
#include "campaign/evaluation/results_json.h"
#include "nonio/sdk/format.h"
#include "platform/storage/nearest.h"

namespace nonio::decision_test {

TEST(Decision, UpperLimitAfterIso14253) {
  using math::decide;
  EXPECT_EQ(decide(8.0, 1.0, 10.0), Decision::conforms);
  EXPECT_EQ(decide(9.175, 1.0, 10.0), Decision::conforms);  // y = USL - 1.65 u
  EXPECT_EQ(decide(9.176, 1.0, 10.0), Decision::cannot_be_decided);
  EXPECT_EQ(decide(10.825, 1.0, 10.0), Decision::cannot_be_decided);  // y = USL + 1.65 u
  EXPECT_EQ(decide(10.826, 1.0, 10.0), Decision::does_not_conform);
  // One rectangular part has k = 1.65: 1.65 u is 1.0 U. With few degrees of freedom 0.825 U remains.
  EXPECT_EQ(decide(9.05, 1.0, 10.0, "", 1.65), Decision::cannot_be_decided);
  EXPECT_EQ(decide(8.99, 1.0, 10.0, "", 1.65), Decision::conforms);
  EXPECT_EQ(decide(9.175, 1.0, 10.0, "", 2.8), Decision::conforms);
  const char* const older = "iso14253-1:2013";
  EXPECT_EQ(decide(9.0, 1.0, 10.0, older), Decision::conforms);  // y = USL - U
  EXPECT_EQ(decide(9.1, 1.0, 10.0, older), Decision::cannot_be_decided);
  EXPECT_EQ(decide(11.0, 1.0, 10.0, older), Decision::cannot_be_decided);  // y = USL + U
  EXPECT_EQ(decide(11.1, 1.0, 10.0, older), Decision::does_not_conform);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(decide(nan, 1.0, 10.0), Decision::cannot_be_decided);
  EXPECT_EQ(decide(8.0, nan, 10.0), Decision::cannot_be_decided);
}

TEST(Decision, UpperLimitAfterIlacG8) {
  using math::decide;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const char* rule : {"ilac-g8-simple", "ilac-g8-guarded"}) {
    const bool guarded = std::string(rule) == "ilac-g8-guarded";
    const Decision inside_guard = guarded ? Decision::does_not_conform : Decision::conforms;
    EXPECT_EQ(decide(9.0, 1.0, 10.0, rule), Decision::conforms) << rule;
    EXPECT_EQ(decide(9.5, 1.0, 10.0, rule), inside_guard) << rule;
    EXPECT_EQ(decide(10.0, 1.0, 10.0, rule), inside_guard) << rule;
    EXPECT_EQ(decide(10.1, 1.0, 10.0, rule), Decision::does_not_conform) << rule;
    EXPECT_EQ(decide(nan, 1.0, 10.0, rule), Decision::cannot_be_decided) << rule;
    EXPECT_EQ(decide(8.0, nan, 10.0, rule), Decision::cannot_be_decided) << rule;
  }
}

/// A campaign of one axis X with limits A and B, of which one line has a limit A of its own, and a circle.
struct Limits {
  Campaign campaign;
  std::vector<Results::Analysed> analyses;

  Limits() {
    Axis x{.name = "X"};
    x.tolerance = {{"A", 10e-6}, {"B", 4e-6}};
    campaign.machine.axes = {x};
    for (const auto& [id, kind, axis] :
         {std::tuple("low", "axis", "X"), {"high", "axis", "X"}, {"C1", "circle", ""}}) {
      Measurement m;
      m.id = id, m.kind = kind, m.axis = axis;
      campaign.measurements.push_back(m);
    }
    campaign.measurements[1].tolerances = {{"A", 30e-6}};
    campaign.measurements[2].tolerances = {{"G", 8e-6}, {"C0Y", 20e-6, Quantity::small_angle}};
    add("low", "iso230-2", "A", 20e-6);
    add("high", "iso230-2", "A", 20e-6);
    add("C1", "circle", "G", -7.5e-6);
    add("C1", "circle", "C0Y", -40e-6, Quantity::small_angle);
  }

  void add(const char* measurement, const char* plugin, const char* name, double value,
           Quantity quantity = Quantity::deviation) {
    Results::Analysed a;
    a.plugin = plugin, a.measurement = measurement;
    a.evaluation.values = {{.name = name, .value = value, .quantity = quantity, .U = 1e-6}};
    analyses.push_back(std::move(a));
  }

  std::string decided() const {
    std::string all;
    for (const Conformity& c : evaluation::held_against_tolerances(campaign, analyses))
      all += c.measurement + "|" + c.axis + "|" + c.plugin + "|" + c.name + " " +
             evaluation::to_text(c.decision) + (c.reason.empty() ? "" : ", " + c.reason) + "\n";
    return all;
  }
};

TEST(Decision, AMeasurementIsHeldAgainstItsOwnLimits) {
  const Limits limits;
  EXPECT_EQ(limits.decided(),
            "low|X|iso230-2|A does not conform\n"
            "|X||B cannot be decided, no-value\n"
            "high|X|iso230-2|A conforms\n"
            "C1||circle|G cannot be decided, near-limit\n"
            "C1||circle|C0Y does not conform\n");
}

TEST(Decision, AnAnalysisStatesLimitsOfItsOwn) {
  Limits limits;
  limits.campaign = {};
  limits.analyses.resize(1);
  Value& v = limits.analyses[0].evaluation.values[0];
  v.judged = {25e-6, Decision::does_not_conform};
  EXPECT_EQ(limits.decided(), "low||iso230-2|A does not conform\n");
  v.judged->decision = Decision::cannot_be_decided, v.U.reset();
  EXPECT_EQ(limits.decided(), "low||iso230-2|A cannot be decided, no-uncertainty\n");
}

TEST(Decision, ALimitInAnotherUnitHoldsNothing) {
  Limits limits;
  limits.campaign.measurements[2].tolerances = {{"C0Y", 50e-6}, {"absent", 1e-6}};
  EXPECT_NE(limits.decided().find("C1|||C0Y cannot be decided, no-value\n"
                                  "C1|||absent cannot be decided, no-value\n"),
            std::string::npos)
      << limits.decided();
}

TEST(Format, AResultHasTheDigitsThatItsUncertaintyAllows) {
  const auto text = [](double value, double U) {
    const auto r = rounded_result(value, U);
    return r ? r->value + " +- " + r->U : std::string("none");
  };
  EXPECT_EQ(text(12.3456, 1.9499), "12.3 +- 1.9");
  EXPECT_EQ(text(-4.56789, 0.123456), "-4.57 +- 0.12");
  EXPECT_EQ(text(1.5, 0.0996), "1.50 +- 0.10");
  EXPECT_EQ(text(12345.0, 1234.0), "12300 +- 1200");
  EXPECT_EQ(text(0.5, 2e-10), "0.500000000 +- 0.000000001");
  EXPECT_EQ(text(1.0, 0.0), "none");
}

TEST(Format, PrintedGivesBackTheDecimalThatWasRead) {
  EXPECT_EQ(printed(25.2 * 1e-3, Quantity::length), 25.2);
  EXPECT_EQ(printed(90.0 / deg_per_rad, Quantity::angle), 90.0);
  EXPECT_EQ(printed(-0.0, Quantity::length), 0.0);
}

TEST(Format, ShortTextHasNoUnexpectedExponent) {
  EXPECT_EQ(short_text(0.0), "0.00");
  EXPECT_EQ(short_text(5.5784), "5.58");
  EXPECT_EQ(short_text(-12.34), "-12.3");
  EXPECT_EQ(short_text(1234.5), "1235");
  EXPECT_EQ(short_text(1e-7), "1.00e-07");
  EXPECT_EQ(fixed_text(-0.0004, 3), "0.000");
  EXPECT_EQ(fixed_text(0.15, 1), "0.2");
  EXPECT_EQ(fixed_text(-0.45, 1), "-0.5");
  EXPECT_EQ(fixed_text(9.96, 1), "10.0");
  EXPECT_EQ(fixed_text(0.96, 0), "1");
  EXPECT_EQ(fixed_text(0.0, 2), "0.00");
  EXPECT_EQ(fixed_text(1e-300, 2), "0.00");
  EXPECT_EQ(fixed_text(123456.789, 2), "123456.79");
}

/// The fast conversions to digits agree with the slow ones, also near ties and powers of ten.
TEST(Format, QuickWaysGiveTheSameDigits) {
  const std::uint64_t seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> fraction(-1.0, 1.0), exponent(-14.0, 14.0);
  for (int i = 0; i < 300000; ++i) {
    double value = fraction(random) * std::pow(10.0, exponent(random));
    if (i % 3 == 0) value = std::round(value * 2e4) / 2e4;  // few digits, ties
    if (i % 5 == 0) value = std::pow(10.0, std::round(exponent(random))) * (1.0 + 1e-16 * (i % 7));
    ASSERT_EQ(printed(value, Quantity::number), rounded_by_digits(value)) << value;
    for (const int decimals : {0, 1, 3, 6})
      ASSERT_EQ(fixed_text(value, decimals), fixed_text_by_digits(value, decimals)) << value;
    for (const double number : {value, printed(value, Quantity::number)}) {
      std::array<char, 40> buffer{};
      std::string quick;
      append_shortest(quick, number);
      ASSERT_EQ(quick, std::string(buffer.data(),
                                   std::to_chars(buffer.data(), buffer.data() + 40, number).ptr));
    }
  }
}

TEST(Suggestion, NearestOrNothing) {
  EXPECT_EQ(storage::suggestion("struture", {"structure", "serial"}), " (nearest: \"structure\")");
  EXPECT_EQ(storage::suggestion("qqqqqq", {"structure", "serial"}), "");
}

}  // namespace nonio::decision_test
