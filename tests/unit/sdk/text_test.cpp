// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "nonio/sdk/column_map.h"
#include "nonio/sdk/fields.h"
#include "nonio/sdk/json.h"
#include "nonio/sdk/json_writer.h"

using namespace nonio;

namespace {

std::string utf16(const std::u16string& text, bool little) {
  std::string out = little ? "\xFF\xFE" : "\xFE\xFF";
  for (const char16_t c : text) {
    const char low = static_cast<char>(c & 0xFF), high = static_cast<char>(c >> 8);
    out += {little ? low : high, little ? high : low};
  }
  return out;
}

TEST(Text, Utf16OfBothOrdersBecomesUtf8) {
  for (const bool little : {true, false}) {
    const auto read = utf8_of_utf16(utf16(u"a\u00B5\u4E2D\U0001F600\r\n", little));
    ASSERT_TRUE(read && *read);
    EXPECT_EQ(**read, "a\xC2\xB5\xE4\xB8\xAD\xF0\x9F\x98\x80\r\n");
  }
}

TEST(Text, WithoutAMarkNothingIsTakenForUtf16) {
  const auto read = utf8_of_utf16(std::string("a\0b\0", 4));
  ASSERT_TRUE(read);
  EXPECT_FALSE(*read);
}

TEST(Text, BrokenUtf16IsNamedWithItsLine) {
  const std::string good = utf16(u"a\nb", true);
  for (const auto& [bytes, words] : {std::pair{good + "c", "half a character"},
                                     {good + std::string("\x00\xD8", 2), "surrogates"},
                                     {good + std::string("\x00\xDC\x00\xDC", 4), "surrogates"},
                                     {good + std::string(2, '\0'), "NUL"}}) {
    const auto read = utf8_of_utf16(bytes);
    ASSERT_FALSE(read);
    EXPECT_NE(read.error().message.find(words), std::string::npos) << read.error().message;
    EXPECT_EQ(read.error().line, 2U);
  }
}

TEST(Text, AnyBytesAreUtf8OrAnErrorWithALine) {
  const std::uint32_t seed = std::random_device{}();
  std::mt19937 random(seed);
  int read_ones = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string bytes = random() % 2 == 0 ? "\xFF\xFE" : "\xFE\xFF";
    const bool big = bytes[0] == '\xFE';
    for (std::size_t k = random() % 12; k > 0; --k) {
      const auto high = static_cast<char>(random() % 3 == 0 ? 0xD8 + random() % 8 : random() % 256);
      const auto low = static_cast<char>(random() % 16 == 0 ? '\n' : random() % 256);
      bytes += {big ? high : low, big ? low : high};
    }
    if (random() % 8 == 0) bytes.pop_back();
    const auto read = utf8_of_utf16(bytes);
    if (!read) {
      EXPECT_GE(read.error().line, 1U) << "seed " << seed;
      EXPECT_LE(read.error().line, bytes.size()) << "seed " << seed;
    } else if (*read) {
      ++read_ones;
      EXPECT_TRUE(is_utf8(**read)) << "seed " << seed;
    }
  }
  EXPECT_GT(read_ones, 100) << "seed " << seed;
}

TEST(Text, EveryCharacterIsUtf8AndNoSurrogateIs) {
  for (std::uint32_t c = 1; c <= 0x10FFFF; c += c < 0x3000 ? 1 : 17) {
    std::string text;
    append_utf8(text, c);
    EXPECT_EQ(is_utf8(text), c < 0xD800 || c > 0xDFFF) << c;
    EXPECT_FALSE(text.size() > 1 && is_utf8(std::string_view(text).substr(0, text.size() - 1)))
        << c;
  }
}

TEST(Json, TextAndNumbers) {
  EXPECT_EQ(json_text("a\"\\\n\x01\xC2\xB5<"), "\"a\\\"\\\\\\n\\u0001\xC2\xB5<\"");
  EXPECT_EQ(json_text("\xB5m"), "\"\xEF\xBF\xBDm\"");
  EXPECT_EQ(json_number(0.1), "0.1");
  EXPECT_EQ(json_number(NAN), "null");
}

TEST(Text, JsonInLinesAndInOneLine) {
  using Layout = JsonWriter::Layout;
  const auto written = [](Layout layout) {
    JsonWriter json(layout);
    json.begin_object();
    json.member("a", "</script>&\xB5");
    json.member("b", std::vector<std::string>{"x"});
    json.key("c");
    json.begin_array();
    json.end_array();
    json.member("d", 5.0);
    json.member("e", NAN);
    json.end_object();
    return json.take();
  };
  EXPECT_EQ(
      written(Layout::lines),
      "{\n \"a\": \"</script>&\uFFFD\",\n \"b\": [\n  \"x\"\n ],\n \"c\": [],\n \"d\": 5.0,\n "
      "\"e\": null\n}\n");
  EXPECT_EQ(written(Layout::one_line),
            "{\"a\":\"</script>&\uFFFD\",\"b\":[\"x\"],\"c\":[],\"d\":5.0,\"e\":null}");
  EXPECT_EQ(
      written(Layout::in_script),
      "{\"a\":\"\\u003c/script\\u003e\\u0026\uFFFD\",\"b\":[\"x\"],\"c\":[],\"d\":5.0,\"e\":null}");
}

TEST(Csv, TextIsQuotedAndNoFormula) {
  EXPECT_EQ(csv_text("a"), "a");
  EXPECT_EQ(csv_text("a,\"b\""), "\"a,\"\"b\"\"\"");
  EXPECT_EQ(csv_text("=1"), "'=1");
}

TEST(Csv, FieldsAndNumbers) {
  std::vector<std::string_view> fields;
  ASSERT_TRUE(readers::split("\"a;b\"; 1,5 ;", ';', fields));
  EXPECT_EQ(fields, (std::vector<std::string_view>{"a;b", "1,5", ""}));
  EXPECT_EQ(readers::parse_number("1,5", true).value, 1.5);
  EXPECT_EQ(readers::parse_number("1,5", false).kind, readers::Field::Kind::bad);
  EXPECT_EQ(readers::parse_number("1e20", false).kind, readers::Field::Kind::not_taken);
}

TEST(ColumnMap, RangesOfRows) {
  const auto range = row_range_of("12-36 forward");
  ASSERT_TRUE(range);
  EXPECT_EQ(range->first, 12U);
  EXPECT_EQ(range->last, 36U);
  EXPECT_EQ(range->way, Way::forward);
  EXPECT_EQ(row_range_of("41- backward")->last, 0U);
  EXPECT_EQ(row_range_of("41- backward")->way, Way::reverse);
  for (const char* wrong :
       {"", "12", "36-12 +", "0-5 +", "1-5 up", "1-5 ", "a-5", "1-99999999999999999999"})
    EXPECT_FALSE(row_range_of(wrong)) << wrong;
}

TEST(ColumnMap, UnitsAreOfTheKindOfAxis) {
  EXPECT_EQ(unit_named("inch", false), 0.0254);
  EXPECT_FALSE(unit_named("mm", true));
  EXPECT_DOUBLE_EQ(*unit_named("arcsec", true), M_PI / 180.0 / 3600.0);
}

TEST(Units, DriftWithTemperature) {
  EXPECT_EQ(unit_of(Quantity::deviation_per_kelvin).symbol, "um/K");
  EXPECT_EQ(unit_of(Quantity::deviation_per_kelvin).suffix, "_um_per_K");
  EXPECT_DOUBLE_EQ(printed(2.5e-6, Quantity::deviation_per_kelvin), 2.5);
  EXPECT_DOUBLE_EQ(printed(1.0 / arcsec_per_rad, Quantity::angle_per_kelvin), 1.0);
}

}  // namespace
