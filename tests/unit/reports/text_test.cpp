// SPDX-License-Identifier: Apache-2.0
#include "nonio/reports/text.h"

#include "fixtures.h"
#include "font_reader.h"
#include "font_subset.h"
#include "nonio/reports/document.h"
#include "nonio/reports/wording.h"
#include "pdf_reader.h"
#include "text.h"

namespace nonio::reports::text_test {
namespace {

const Fonts& fonts() {
  static const auto shared = [] {
    static const Templates templates = fixtures::read_templates(NONIO_TEMPLATES);
    const auto file = [](const char* name) {
      return FontFile{templates.files.at("fonts/" + std::string(name) + ".ttf"), name};
    };
    auto read = shared_fonts(file("LiberationSans-Regular"), file("LiberationSans-Bold"),
                             file("DroidSansFallback"));
    return read ? *read : std::make_shared<const Fonts>();
  }();
  return *shared;
}

Glyphs shaped(std::string_view text, bool bold = false) {
  auto glyphs = shape(text, fonts(), bold, "field");
  EXPECT_TRUE(glyphs) << glyphs.error().message;
  return glyphs ? *glyphs : Glyphs{};
}

TEST(Sentences, TextBetweenBackquotesIsQuotedOrCode) {
  EXPECT_EQ(typeset("as `nonio model drop` does, by -8.1 um"),
            "as \"nonio model drop\" does, by \u22128.1 \u00b5m");
  EXPECT_EQ(typeset_html("from `a<b` to `c -1 um`, -1 um & more"),
            "from <code>a&lt;b</code> to <code>c -1 um</code>, \u22121 \u00b5m &amp; more");
  EXPECT_EQ(typeset("a lone ` stays"), "a lone ` stays");
  EXPECT_EQ(typeset_html(""), "");
}

TEST(Shaping, EachCharacterHasTheFontThatHasIt) {
  const Glyphs glyphs = shaped("20 微米 µm。", true);
  ASSERT_EQ(glyphs.size(), 9U);
  for (std::size_t i = 0; i < glyphs.size(); ++i)
    EXPECT_EQ(glyphs[i].wide, i == 3 || i == 4 || i == 8) << i;
  EXPECT_EQ(glyphs[0].id, fonts().bold.glyph(U'2'));
  EXPECT_EQ(glyphs[3].id, fonts().wide.glyph(U'微'));
  EXPECT_EQ(glyphs[3].advance, 1000);
}

TEST(Shaping, WithoutAWideFontItsCharactersAreAnError) {
  Fonts two = fonts();
  two.wide = {};
  EXPECT_FALSE(shape("校", two, false, "field"));
  EXPECT_TRUE(shape("é", two, false, "field"));
}

TEST(Shaping, LettersAndTheirMarksAreOneCharacter) {
  struct Case {
    const char *given, *composed;
  };
  for (const auto& [given, composed] :
       {Case{"e\u0301", "é"}, Case{"u\u0308", "ü"}, Case{"\u03B9\u0308\u0301", "ΐ"},
        Case{"\u0438\u0306", "й"}, Case{"\u0418\u0300", "\u040D"}, Case{"\u1F71", "ά"},
        Case{"\u0041\u030A", "Å"}, Case{"\u212B", "Å"}, Case{"s\u030Cx", "šx"}}) {
    const Glyphs a = shaped(given), b = shaped(composed);
    ASSERT_EQ(a.size(), b.size()) << given;
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].id, b[i].id) << given;
  }
}

/// Left, low, right, high of a glyph's outline, 1/1000 of the font size.
std::array<int, 4> box(const Font& font, std::uint16_t glyph) {
  const FontReader r(font.bytes);
  const Outlines outlines(r, *r.table("head"), *r.table("loca"), *r.table("glyf"));
  std::array<int, 4> out{};
  for (std::size_t i = 0; i < 4; ++i)
    out[i] = r.s16(outlines.begin(glyph) + 2 + 2 * i) * 1000 / font.units;
  return out;
}

TEST(Shaping, AnAccentIsOverTheMiddleOfItsLetter) {
  for (const bool bold : {false, true}) {
    const Font& font = fonts().weight(bold);
    for (const char* letter : {"\u0430", "\u0414", "\u044E", "\u0444"}) {
      const Glyphs glyphs = shaped(std::string(letter) + "\u0301", bold);
      ASSERT_EQ(glyphs.size(), 2U);
      const Glyph &base = glyphs[0], &accent = glyphs[1];
      EXPECT_EQ(accent.advance, 0);
      const auto below = box(font, base.id), above = box(font, accent.id);
      EXPECT_NEAR(below[0] + below[2], above[0] + above[2] + 2 * (base.advance + accent.shift), 4);
      EXPECT_NEAR(below[3] + 50, above[1] + accent.rise, 2);
    }
  }
}

TEST(Shaping, AnAccentWithoutALetterIsAnErrorThatNamesIt) {
  for (const char* text : {"\u0301", " \u0301", "7\u0301", "校\u0301", "\u0430\u0301\u0301"}) {
    const auto glyphs = shape(text, fonts(), false, "campaign.customer");
    ASSERT_FALSE(glyphs) << text;
    EXPECT_NE(glyphs.error().message.find("U+0301"), std::string::npos);
    EXPECT_NE(glyphs.error().message.find("campaign.customer"), std::string::npos);
  }
  EXPECT_EQ(visible_text("a\u0300 \u0430\u0301 \u0301 校\u0E01", fonts()),
            "a\u0300 \u0430\u0301 <U+0301> 校<U+0E01>");
}

/// Lines of a text that has so many ideographs' room.
std::vector<std::string> lines(const std::u32string& text, double width) {
  std::string bytes;
  for (const char32_t c : text) {
    if (c < 0x80) {
      bytes += static_cast<char>(c);
    } else {
      bytes += static_cast<char>(0xE0 | c >> 12);
      bytes += static_cast<char>(0x80 | (c >> 6 & 0x3F));
      bytes += static_cast<char>(0x80 | (c & 0x3F));
    }
  }
  std::vector<std::string> out;
  for (const TextLine& line : wrap(shaped(bytes), width)) {
    std::string shown;
    std::size_t from = 0;
    for (std::size_t i = 0; i < line.end; ++i) {
      const std::size_t begin = from;
      next_character(bytes, from);
      if (i >= line.begin) shown += bytes.substr(begin, from - begin);
    }
    out.push_back(shown);
  }
  return out;
}

TEST(Breaking, BetweenIdeographsButForPunctuation) {
  using Lines = std::vector<std::string>;
  EXPECT_EQ(lines(U"反向差值与精度", 4.5), (Lines{"反向差值", "与精度"}));
  EXPECT_EQ(lines(U"反向差值，精度", 4.5), (Lines{"反向差", "值，精度"}));
  EXPECT_EQ(lines(U"反向差值。）精度", 4.5), (Lines{"反向差", "值。）精", "度"}));
  EXPECT_EQ(lines(U"公司（集团）机床", 3.5), (Lines{"公司", "（集", "团）机", "床"}));
  EXPECT_EQ(lines(U"公司（集团有", 3.2), (Lines{"公司", "（集团", "有"}));
  EXPECT_EQ(lines(U"测量ISO230标准", 3.8), (Lines{"测量", "ISO230", "标准"}));
  EXPECT_EQ(lines(U"测量 值值", 2.4), (Lines{"测量", "值值"}));
}

TEST(Breaking, ANumberStaysWithItsSignAndUnit) {
  using Lines = std::vector<std::string>;
  EXPECT_EQ(lines(U"aaa k = 2", 2.5), (Lines{"aaa", "k = 2"}));
  EXPECT_EQ(lines(U"aaa 95 %", 3.2), (Lines{"aaa", "95 %"}));
  EXPECT_NEAR(widest_word(shaped("k = 2")), width_of(shaped("k = 2")), 1e-9);
}

TEST(Breaking, NoBlankFollowsAnIdeographicStop) {
  EXPECT_EQ(shaped("结果。 规范： a").size(), shaped("结果。规范：a").size());
  EXPECT_EQ(shaped("结果 a").size(), 4U);
}

TEST(Breaking, AWordOfATableIsAnIdeograph) {
  EXPECT_NEAR(widest_word(shaped("反向差值")), 1.0, 1e-9);
  EXPECT_NEAR(widest_word(shaped("反向差值。")), 2.0, 1e-9);
}

Document page(const std::string& text) {
  Document document;
  document.title = text;
  document.blocks = {{Heading{text}}, {Paragraph{text}}};
  return document;
}

TEST(WideFont, ADocumentEmbedsWhatItUsesAndNothingElse) {
  const auto plain = pdf_bytes(page("Torino"), fonts()),
             chinese = pdf_bytes(page("校准证书"), fonts()),
             again = pdf_bytes(page("校准证书"), fonts());
  ASSERT_TRUE(plain && chinese && again);
  EXPECT_EQ(*chinese, *again);
  EXPECT_EQ(plain->find("DroidSansFallback"), std::string::npos);
  EXPECT_LT(chinese->size(), plain->size() + 6000);
  EXPECT_NE(fixtures::read_pdf(*chinese).all().find("校准证书\n"), std::string::npos);
}

TEST(WideFont, APartThatIsLargerThanShortOffsetsAllowKeepsItsOutlines) {
  const Font& font = fonts().wide;
  std::vector<std::uint16_t> used = {0};
  for (char32_t c = 0x4E00; c < 0x5A00; ++c) used.push_back(font.glyph(c));
  const pdf::EmbeddedFont part = embedded_part(font, used);
  const std::string file = fixtures::inflated(part.file_deflated);
  ASSERT_EQ(file.size(), part.size);
  const FontReader small(file), whole(font.bytes);
  ASSERT_EQ(small.u16(*small.table("head") + 50), 1U) << "the part is not larger than that";
  const Outlines a(small, *small.table("head"), *small.table("loca"), *small.table("glyf"));
  const Outlines b(whole, *whole.table("head"), *whole.table("loca"), *whole.table("glyf"));
  const auto same = [&](const auto& self, std::size_t g, std::size_t h) -> bool {
    const auto parts = a.components(g), others = b.components(h);
    bool equal = parts.size() == others.size() && a.size(g) >= b.size(h);
    for (std::size_t i = 0; equal && i < parts.size(); ++i)
      equal = self(self, small.u16(parts[i]), whole.u16(others[i]));
    return equal && (!parts.empty() || file.substr(a.begin(g), b.size(h)) ==
                                           font.bytes.substr(b.begin(h), b.size(h)));
  };
  std::size_t composed = 0;
  for (std::size_t g = 0; g < used.size(); ++g) {
    ASSERT_TRUE(same(same, g, used[g])) << g;
    composed += b.components(used[g]).empty() ? 0 : 1;
  }
  EXPECT_GT(composed, 100U);
}

}  // namespace
}  // namespace nonio::reports::text_test
