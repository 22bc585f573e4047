// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "nonio/sdk/fields.h"

namespace nonio::csv::csv_fields_test {
using namespace readers;
namespace {

using Kind = Field::Kind;

struct NumberCase {
  std::string text;
  bool comma_allowed;
  Kind kind;
  double value;
};

class Numbers : public testing::TestWithParam<NumberCase> {};

TEST_P(Numbers, AreReadWithoutConversion) {
  const NumberCase& c = GetParam();
  const Field n = parse_number(c.text, c.comma_allowed);
  EXPECT_EQ(n.kind, c.kind) << c.text;
  if (c.kind == Kind::taken) {
    EXPECT_EQ(n.value, c.value) << c.text;
    EXPECT_FALSE(std::signbit(n.value) && n.value == 0.0) << c.text;
  }
}

const NumberCase number_cases[] = {
    {"0", false, Kind::taken, 0.0},
    {"-0.0", false, Kind::taken, 0.0},
    {"+1.5", false, Kind::taken, 1.5},
    {"-12.345", false, Kind::taken, -12.345},
    {".5", false, Kind::taken, 0.5},
    {"5.", false, Kind::taken, 5.0},
    {"00012.50", false, Kind::taken, 12.5},
    {"1e3", false, Kind::taken, 1000.0},
    {"1E-3", false, Kind::taken, 0.001},
    {"1,5", true, Kind::taken, 1.5},
    {"-1,5E+02", true, Kind::taken, -150.0},
    {"1,5", false, Kind::bad, 0.0},
    {"9.99e18", false, Kind::taken, 9.99e18},
    {"1e19", false, Kind::not_taken, 0.0},
    {"-1e20", false, Kind::not_taken, 0.0},
    {"-100000000000000000000", false, Kind::not_taken, 0.0},
    {"1e400", false, Kind::not_taken, 0.0},
    {"1e-400", false, Kind::taken, 0.0},
    {"0e999", false, Kind::taken, 0.0},
    {"0.1000000000000000055511151231257827021181583404541015625", false, Kind::taken, 0.1},
    {"123456789012345678901.5", false, Kind::not_taken, 0.0},
    {"1234567890123456789.5", false, Kind::taken, 1234567890123456789.5},
    {"", false, Kind::not_taken, 0.0},
    {"nan", false, Kind::not_taken, 0.0},
    {"NaN", false, Kind::not_taken, 0.0},
    {"-nan", false, Kind::not_taken, 0.0},
    {"N/A", false, Kind::not_taken, 0.0},
    {"n/a", true, Kind::not_taken, 0.0},
    {"#N/A", false, Kind::not_taken, 0.0},
    {"#N/D", true, Kind::not_taken, 0.0},
    {"#NV", true, Kind::not_taken, 0.0},
    {"#DIV/0!", true, Kind::bad, 0.0},
    {"inf", false, Kind::not_taken, 0.0},
    {"-Infinity", false, Kind::not_taken, 0.0},
    {"na", false, Kind::bad, 0.0},
    {"nan(1)", false, Kind::bad, 0.0},
    {"-", false, Kind::bad, 0.0},
    {".", false, Kind::bad, 0.0},
    {"+-1", false, Kind::bad, 0.0},
    {"1e", false, Kind::bad, 0.0},
    {"1e+", false, Kind::bad, 0.0},
    {"1e5x", false, Kind::bad, 0.0},
    {"1.5 um", false, Kind::bad, 0.0},
    {"0x1A", false, Kind::bad, 0.0},
    {"1.234,5", true, Kind::bad, 0.0},
    {"1,234.5", true, Kind::bad, 0.0},
    {"1.2.3", false, Kind::bad, 0.0},
    {"1'234", false, Kind::bad, 0.0},
    {"1 234", false, Kind::bad, 0.0},
    {"4O0.5", false, Kind::bad, 0.0},
};
INSTANTIATE_TEST_SUITE_P(Fields, Numbers, testing::ValuesIn(number_cases));

TEST(Fields, EveryNumberIsTheNearestDouble) {
  const unsigned seed = 20260301;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  for (int i = 0; i < 200000; ++i) {
    std::string text = random() % 2 != 0 ? "-" : "";
    for (std::uint64_t k = 1 + random() % 12; k > 0; --k)
      text += static_cast<char>('0' + random() % 10);
    text += '.';
    for (std::uint64_t k = random() % 12; k > 0; --k)
      text += static_cast<char>('0' + random() % 10);
    if (random() % 3 == 0) text += "e" + std::to_string(static_cast<int>(random() % 60) - 54);
    double wanted = 0.0;
    std::from_chars(text.data(), text.data() + text.size(), wanted);
    const Field n = parse_number(text, false);
    if (std::fabs(wanted) >= 1e19) {
      ASSERT_EQ(n.kind, Kind::not_taken) << text;
    } else {
      ASSERT_EQ(n.kind, Kind::taken) << text;
      ASSERT_EQ(n.value, wanted) << text;
    }
  }
}

TEST(Fields, RunIsAWholeNumberFromOne) {
  EXPECT_EQ(parse_run("1"), 1U);
  EXPECT_EQ(parse_run("007"), 7U);
  EXPECT_EQ(parse_run("4294967295"), 4294967295U);
  for (const char* bad :
       {"0", "4294967296", "99999999999999999999999", "", "-1", "+1", "1.0", "1a", "one"})
    EXPECT_EQ(parse_run(bad), 0U) << bad;
}

TEST(Fields, SplitTrimsAndUnquotes) {
  std::vector<std::string_view> f;
  ASSERT_TRUE(split(" a , \"b,c\" ,\"d\"\"e\",", ',', f));
  EXPECT_EQ(f, (std::vector<std::string_view>{"a", "b,c", "d\"\"e", ""}));
  ASSERT_TRUE(split("a\t \tb", '\t', f));
  EXPECT_EQ(f, (std::vector<std::string_view>{"a", "", "b"}));
  ASSERT_TRUE(split("", ',', f));
  EXPECT_EQ(f.size(), 1U);
  EXPECT_FALSE(split("\"a", ',', f));
  EXPECT_FALSE(split("\"a\"b,c", ',', f));
  EXPECT_FALSE(split("a,\"b\"\"", ',', f));
}

TEST(Fields, Utf8IsDistinguishedFromOtherBytes) {
  for (const char* good : {"", "abc", "per\xC3\xB2", "\xE2\x82\xAC", "\xF0\x9F\x98\x80"})
    EXPECT_TRUE(is_utf8(good)) << good;
  for (const char* bad :
       {"\xF2", "per\xF2", "\xC0\x80", "\xED\xA0\x80", "\xE2\x82", "\xF4\x90\x80\x80", "\x80",
        "\xE0\x80\x80", "\xF0\x80\x80\x80", "\xFF\xFE"})
    EXPECT_FALSE(is_utf8(bad)) << shown(bad);
}

TEST(Fields, ShownIsAlwaysReadableText) {
  EXPECT_EQ(shown("abc"), "\"abc\"");
  EXPECT_EQ(shown(std::string_view("a\0b", 3)), "\"a\\x00b\"");
  EXPECT_EQ(shown("\x1B[2J"), "\"\\x1B[2J\"");
  EXPECT_EQ(shown("\xC2\x9B"), "\"\\xC2\\x9B\"");
  EXPECT_EQ(shown("\xC2\xB5m"), "\"\xC2\xB5m\"");
  EXPECT_EQ(shown("\xB5m"), "\"\\xB5m\"");
  EXPECT_EQ(shown(std::string(39, 'a') + "\xC2\xB5"), "\"" + std::string(39, 'a') + "...\"");
}

TEST(Fields, NearestName) {
  EXPECT_EQ(nearest("targt_mm", {"run", "target_mm", "target_deg"}), "target_mm");
  EXPECT_EQ(nearest("Run", {"run", "target_mm"}), "run");
}

}  // namespace
}  // namespace nonio::csv::csv_fields_test
