// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "nonio/reports/number.h"

namespace nonio::reports::numbers_test {
namespace {

struct Line {
  double value;
  std::optional<double> U;
  Quantity quantity;
  const char* language;
  const char *text, *U_text;
};

TEST(Rounding, ValueToThePlaceOfTwoDigitsOfU) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const Line lines[] = {
      {11.9647e-6, 1.94e-6, Quantity::deviation, "en", "12.0", "1.9"},
      {11.9647e-6, 0.1949e-6, Quantity::deviation, "en", "11.96", "0.19"},
      {11.9647e-6, 0.0996e-6, Quantity::deviation, "en", "11.96", "0.10"},
      {11.9647e-6, 9.96e-6, Quantity::deviation, "en", "12", "10"},
      {1234.4e-6, 123e-6, Quantity::deviation, "en", "1230", "120"},
      {-8.1434e-6, 0.19e-6, Quantity::deviation, "it", "\u22128,14", "0,19"},
      {-0.001e-6, 0.19e-6, Quantity::deviation, "en", "0.00", "0.19"},
      {4.51649e-6, {}, Quantity::deviation, "en", "4.516", ""},
      {4.51649e-6, {}, Quantity::deviation, "it", "4,516", ""},
      {5.58 / arcsec_per_rad, {}, Quantity::angular_deviation, "en", "5.580", ""},
      {4.5e-6, 0.0, Quantity::deviation, "en", "4.500", ""},
      {4.5e-6, none, Quantity::deviation, "en", "4.500", ""},
      {none, {}, Quantity::deviation, "en", "–", ""},
      {1e308, {}, Quantity::deviation, "en", "–", ""},
      {1e300, 1e299, Quantity::deviation, "en", "1.000e+306", "1.000e+305"},
      {5, {}, Quantity::count, "en", "5", ""},
  };
  for (const Line& l : lines) {
    const Printed shown = printed_result(l.value, l.U, l.quantity, l.language);
    EXPECT_EQ(shown.value, l.text) << l.value;
    EXPECT_EQ(shown.U, l.U_text) << l.value;
  }
}

// A printed value is on the side of its limit on which the value is.
TEST(Rounding, DigitsShowTheSideOfTheLimit) {
  const struct {
    double value, U, limit;
    const char* text;
  } lines[] = {{13.2041, 1.4, 13.2, "13.204"}, {12.272, 1.3, 12.28, "12.27"},
               {12.272, 1.3, 13.0, "12.3"},    {-13.2041, 1.4, 13.2, "\u221213.204"},
               {13.2, 1.4, 13.2, "13.2"},      {11.6800001, 1.0, 11.68, "11.7"}};
  for (const auto& l : lines)
    EXPECT_EQ(
        printed_result(l.value * 1e-6, l.U * 1e-6, Quantity::deviation, "en", l.limit * 1e-6).value,
        l.text);
}

// Half away from zero on the decimal value, whatever the binary one: also of 0.15 and 0.45, which
// lie below and above their ties.
TEST(Rounding, TiesGoAwayFromZero) {
  const struct {
    double um;
    int decimals;
    const char* text;
  } lines[] = {{0.15, 1, "0.2"},      {0.25, 1, "0.3"},     {0.35, 1, "0.4"},
               {0.45, 1, "0.5"},      {2.5, 0, "3"},        {3.5, 0, "4"},
               {-2.5, 0, "\u22123"},  {0.125, 2, "0.13"},   {1.005, 2, "1.01"},
               {9.9995, 3, "10.000"}, {0.0005, 3, "0.001"}, {0.00049, 3, "0.000"},
               {25.0, -1, "30"},      {15.0, -1, "20"}};
  for (const auto& l : lines) {
    EXPECT_EQ(printed_number(l.um * 1e-6, Quantity::deviation, l.decimals, "en"), l.text) << l.um;
    EXPECT_EQ(printed_number(l.um / 1e6, Quantity::deviation, l.decimals, "en"), l.text) << l.um;
  }
}

TEST(Rounding, ColumnsOfTargetsShowEveryDigitTheyHave) {
  EXPECT_EQ(decimals_for({0.0, 0.1, 2.0}, Quantity::length, 4), 0);
  EXPECT_EQ(decimals_for({0.0, 0.0963, 2.0}, Quantity::length, 4), 1);
  EXPECT_EQ(decimals_for({1.0 / 3.0}, Quantity::length, 4), 4);
  EXPECT_EQ(decimals_for({30.0 / deg_per_rad, 270.0 / deg_per_rad}, Quantity::angle, 4), 0);
  EXPECT_EQ(decimals_for({1e308, std::nan("")}, Quantity::length, 4), 0);
}

}  // namespace
}  // namespace nonio::reports::numbers_test
