// SPDX-License-Identifier: Apache-2.0
#include "nonio/reports/document.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <regex>
#include <set>

#include "fixtures.h"
#include "font_reader.h"
#include "nonio/reports/text.h"
#include "pdf_reader.h"

namespace nonio::reports::document_test {
namespace {

std::shared_ptr<const Fonts> fonts() {
  static const Templates templates = fixtures::read_templates(NONIO_TEMPLATES);
  const std::string regular = "fonts/LiberationSans-Regular.ttf",
                    bold = "fonts/LiberationSans-Bold.ttf", wide = "fonts/DroidSansFallback.ttf";
  auto fonts = shared_fonts({templates.files.at(regular), regular},
                            {templates.files.at(bold), bold}, {templates.files.at(wide), wide});
  EXPECT_TRUE(fonts) << fonts.error().message;
  return fonts ? *fonts : nullptr;
}

Document of(std::vector<Block> blocks) {
  Document document;
  document.title = "T";
  document.head = "head";
  document.foot = "foot";
  document.page_of = "page {page} of {pages}";
  document.blocks = std::move(blocks);
  return document;
}

fixtures::PdfText pages_of(const Document& document) {
  const auto bytes = pdf_bytes(document, *fonts());
  EXPECT_TRUE(bytes) << bytes.error().message;
  return bytes ? fixtures::read_pdf(*bytes) : fixtures::PdfText{};
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += what.size()) ++n;
  return n;
}

TEST(Fonts, HaveWhatEuropeanNamesAndMetrologyNeed) {
  const auto f = fonts();
  EXPECT_TRUE(
      check_text("àéîõüßçñøåæœšžčřůłőąęţșğı ΆΈάόώΩμσ ЁёЖяїґ µ°±−–…″′→↑↓≤≥≈·×²³€№„“”’•", *f, "all"));
}

/// The outline of a glyph, by the short or long offsets of its file.
std::string outline(std::string_view file, std::size_t glyph) {
  const FontReader r(file);
  const bool wide = r.u16(*r.table("head") + 50) != 0;
  const auto at = [&](std::size_t g) -> std::size_t {
    const std::size_t loca = *r.table("loca");
    return *r.table("glyf") + (wide ? r.u32(loca + 4 * g) : 2 * r.u16(loca + 2 * g));
  };
  return std::string(file.substr(at(glyph), at(glyph + 1) - at(glyph)));
}

TEST(Fonts, TheCommonSubsetDrawsItsGlyphsAndNoOther) {
  const auto both = fonts();
  for (const Font* font : {&both->regular, &both->bold}) {
    const std::string subset = fixtures::inflated(font->with_common.file_deflated);
    ASSERT_EQ(subset.size(), font->with_common.size);
    EXPECT_LT(subset.size(), font->bytes.size() / 2);
    for (const char32_t c : std::u32string_view(U"AZaz09%(~\u00E8\u00B5\u2191\u2212")) {
      const std::string whole = outline(font->bytes, font->glyph(c));
      const std::string kept = outline(subset, font->glyph(c));
      ASSERT_FALSE(whole.empty());
      EXPECT_EQ(kept.substr(0, whole.size()), whole) << std::hex << static_cast<unsigned>(c);
    }
    for (const char32_t c : {U'\u0416', U'\u0141', U'\u03A9'})
      EXPECT_TRUE(outline(subset, font->glyph(c)).empty());
    // e with a grave accent is composed of two others, which must be there too
    const std::string composed = outline(subset, font->glyph(U'\u00E8'));
    ASSERT_LT(FontReader(composed).s16(0), 0);
    EXPECT_FALSE(outline(subset, FontReader(composed).u16(12)).empty());
  }
}

TEST(Fonts, ARareCharacterTakesTheWholeFont) {
  Document document = of({});
  document.blocks = {{Paragraph{"Torino, 20 \u00B5m, e cos\u00EC via"}, "text"}};
  const auto common = pdf_bytes(document, *fonts());
  document.blocks = {{Paragraph{"\u0141\u00F3d\u017A"}, "text"}};
  const auto rare = pdf_bytes(document, *fonts());
  ASSERT_TRUE(common && rare);
  EXPECT_LT(common->size() + 20000, rare->size());
  EXPECT_NE(fixtures::read_pdf(*rare).all().find("\u0141\u00F3d\u017A"), std::string::npos);
  EXPECT_NE(fixtures::read_pdf(*common).all().find("cos\u00EC"), std::string::npos);
}

TEST(Fonts, WhatIsNoFontIsRefused) {
  EXPECT_FALSE(parse_font({"", "x.ttf"}));
  EXPECT_FALSE(parse_font({"%PDF-1.7", "x.ttf"}));
  const std::string whole(fonts()->regular.bytes);
  for (std::size_t size = 0; size < whole.size(); size += 97)
    if (parse_font({std::string_view(whole).substr(0, size), "x.ttf"})) {
      EXPECT_GT(size, whole.size() / 4) << "a font cut to " << size << " bytes was accepted";
    }
}

TEST(Text, WhatCannotBePrintedNamesCharacterAndField) {
  struct Line {
    const char *text, *says;
  };
  const Line lines[] = {{"กข", "\"ก\" (U+0E01)"}, {"a\tb", "control character U+0009"},
                        {"a\xffz", "byte 0xFF"},  {"a\xc0\x80", "byte 0xC0"},
                        {"e\u0323", "U+1EB9"},    {"\U0001F600", "U+1F600"}};
  for (const Line& l : lines) {
    const auto bytes = pdf_bytes(of({{Paragraph{l.text}, "campaign.customer"}}), *fonts());
    ASSERT_FALSE(bytes) << l.text;
    EXPECT_NE(bytes.error().message.find(l.says), std::string::npos) << bytes.error().message;
    EXPECT_NE(bytes.error().message.find("campaign.customer"), std::string::npos);
  }
  EXPECT_EQ(visible_text("aก\xff\n", *fonts()), "a<U+0E01><0xFF> ");
}

TEST(Text, ComesBackAsItWent) {
  const std::string text = "Łódź (Ωμέγα) \\ Ёлка 4,5 µm – 3″";
  EXPECT_NE(pages_of(of({{Paragraph{text}}})).all().find(text), std::string::npos);
  // a minus sign comes back as what a spreadsheet understands
  EXPECT_NE(pages_of(of({{Paragraph{"\u22128.143"}}})).all().find("-8.143"), std::string::npos);
}

TEST(Layout, LongTextsWrapAndLoseNothing) {
  std::string words;
  for (int i = 0; i < 3000; ++i) words += "w" + std::to_string(i) + " ";
  const auto text = pages_of(of({{Paragraph{words}}}));
  EXPECT_GT(text.pages.size(), 2U);
  for (int i = 0; i < 3000; i += 7)
    EXPECT_NE(text.all().find("w" + std::to_string(i)), std::string::npos) << i;
  const auto one = pages_of(of({{Grid{"", {{"label", std::string(5000, 'x'), "f"}}}}}));
  EXPECT_EQ(count(one.all(), "x"), 5000U);
}

TEST(Layout, TablesBreakOverPagesWithTheirHeader) {
  Table table;
  table.title = "Title";
  table.columns = {{"Column-A", "mm", true}, {"Column-B", "", false}};
  for (int i = 0; i < 300; ++i) table.rows.push_back({{"row" + std::to_string(i) + "."}, {"text"}});
  const auto text = pages_of(of({{Heading{"Heading"}}, {table}}));
  ASSERT_GT(text.pages.size(), 3U);
  for (std::size_t p = 0; p < text.pages.size(); ++p) {
    EXPECT_EQ(count(text.pages[p], "Column-A"), 1U) << "page " << p + 1;
    EXPECT_EQ(count(text.pages[p],
                    "page " + std::to_string(p + 1) + " of " + std::to_string(text.pages.size())),
              1U);
    EXPECT_EQ(count(text.pages[p], "head\n"), p == 0 ? 0U : 1U);
  }
  for (int i = 0; i < 300; ++i) EXPECT_EQ(count(text.all(), "row" + std::to_string(i) + "."), 1U);
}

TEST(Layout, WordsGiveWayToNumbersWhereATableIsTooNarrow) {
  Table table;
  table.columns = {{"Unbreakableword", "", false},
                   {"Toleranceofthevalue", "µm", true},
                   {"Another", "µm", true},
                   {"Third", "µm", true},
                   {"Undecidednesses", "", false}};
  table.rows = {
      {{"Withoutanyhyphen"}, {"123.4567"}, {"765.4321"}, {"234.5678"}, {"nonconforming"}}};
  Columns pair{{{{table}}, {{table}}, {{table}}}};
  const std::string text = "\n" + pages_of(of({{pair}})).all();
  for (const char* number : {"\n123.4567\n", "\n765.4321\n", "\n234.5678\n"})
    EXPECT_EQ(count(text, number), 3U) << number;
  EXPECT_EQ(count(text, "\nWithoutanyhyphen\n"), 0U) << "the table is not too narrow";
}

TEST(Layout, AHeadingDoesNotStayBehindAlone) {
  for (int lines = 40; lines < 80; ++lines) {
    std::vector<Block> blocks;
    for (int i = 0; i < lines; ++i) blocks.push_back({Paragraph{"line"}});
    blocks.push_back({Heading{"Heading"}});
    blocks.push_back({Note{Level::info, "note title", "says", "advice"}});
    const auto text = pages_of(of(std::move(blocks)));
    for (const std::string& page : text.pages)
      EXPECT_EQ(count(page, "Heading"), count(page, "advice")) << lines;
  }
}

TEST(Layout, PartsSideBySideDoNotStayBehindAloneEither) {
  for (int lines = 60; lines < 75; ++lines) {
    std::vector<Block> blocks;
    for (int i = 0; i < lines; ++i) blocks.push_back({Paragraph{"line"}});
    const Paragraph one{"beside", Paragraph::Look::body, true};
    blocks.push_back({Columns{{{{one}}, {{one}}}}});
    blocks.push_back({Paragraph{"following"}});
    const auto text = pages_of(of(std::move(blocks)));
    for (const std::string& page : text.pages)
      EXPECT_EQ(count(page, "beside"), 2 * count(page, "following")) << lines;
  }
}

TEST(Layout, ARowThatIsLongerThanAPageIsDivided) {
  Table table;
  table.columns = {{"A", "", false}};
  table.rows = {{{"before"}}, {{std::string(40000, 'x')}}, {{"after"}}};
  const auto text = pages_of(of({{table}}));
  EXPECT_GT(text.pages.size(), 2U);
  EXPECT_EQ(count(text.all(), "x"), 40000U);
  EXPECT_EQ(count(text.all(), "after"), 1U);
}

TEST(Plots, BearEveryNumber) {
  const double inf = std::numeric_limits<double>::infinity();
  const double largest = std::numeric_limits<double>::max();
  for (const std::vector<double>& y : {std::vector<double>{1e308, -1e308, 1},
                                       {largest, largest, largest},
                                       {NAN, NAN, NAN},
                                       {inf, -inf, 0},
                                       {0, 0, 0},
                                       {1e-300, 0, -1e-300},
                                       {1e9, 1e9 + 1e-6, 1e9},
                                       {}}) {
    Plot plot;
    plot.title = "plot";
    plot.empty_text = "nothing";
    using Kind = Plot::Curve::Kind;
    for (const Kind kind : {Kind::line, Kind::band, Kind::bars}) {
      Plot::Curve curve;
      curve.kind = kind;
      curve.x = {0, 1, 2};
      curve.y = y;
      curve.y2 = y;
      curve.marker = Marker::up;
      plot.curves.push_back(curve);
    }
    const auto bytes = pdf_bytes(of({{plot}}), *fonts());
    ASSERT_TRUE(bytes) << bytes.error().message;
    for (const std::string& content : fixtures::streams(*bytes)) {
      if (content.find(" Tj ET") == std::string::npos) continue;
      for (const char* wrong : {"nan", "inf", "e+"})
        EXPECT_EQ(content.find(wrong), std::string::npos) << wrong;
    }
  }
}

/// The operators of the dots of a plot of points: each a line of no length.
std::string dots(const Plot& plot) {
  const auto bytes = pdf_bytes(of({{plot}}), *fonts());
  EXPECT_TRUE(bytes) << bytes.error().message;
  for (const std::string& content : fixtures::streams(*bytes))
    if (const std::size_t from = content.find("1 J\n"); from != std::string::npos)
      return content.substr(from, content.find("0 J\n") - from);
  return "";
}

TEST(Plots, ManyPointsAreThinnedByPlaceAndExtremesStay) {
  Plot plot;
  plot.range = {-10, 10};
  Plot::Curve points;
  points.kind = Plot::Curve::Kind::points;
  points.marker = Marker::dot;
  for (int i = 0; i < 100000; ++i)
    points.x.push_back(i % 1000), points.y.push_back(std::sin(0.37 * i));
  const auto with = [&](double extreme) {
    points.x.push_back(500), points.y.push_back(extreme);
    plot.curves = {points};
    points.x.pop_back(), points.y.pop_back();
    return dots(plot);
  };
  const std::size_t plain = count(with(0), " l\n");
  EXPECT_GT(plain, 1000U);
  EXPECT_LT(plain, 20000U);
  EXPECT_EQ(count(with(9), " l\n"), plain + 1) << "a place of its own";
  // In a place that others have too, it is drawn where it is, since nothing is beyond it.
  EXPECT_EQ(count(with(1.01), " l\n"), plain);
  EXPECT_NE(with(1.01), with(1.04));
  EXPECT_EQ(with(0.01), with(0.04)) << "one among others is not";
}

/// Lower edge and height of each frame of a plot, from the origin of its piece.
std::set<std::pair<std::string, std::string>> frames(const Document& document) {
  const auto bytes = pdf_bytes(document, *fonts());
  EXPECT_TRUE(bytes) << bytes.error().message;
  std::set<std::pair<std::string, std::string>> out;
  static const std::regex frame("(\\S+) (\\S+) (\\S+) (\\S+) re\\s+S");
  for (const std::string& stream : fixtures::streams(*bytes))
    if (stream.find("BT ") != std::string::npos)
      for (std::sregex_iterator it(stream.begin(), stream.end(), frame), end; it != end; ++it)
        out.insert({(*it)[2], (*it)[4]});
  return out;
}

TEST(Plots, SideBySideTheyAreInLine) {
  Plot plain;
  plain.title = "Y";
  Plot::Curve curve;
  curve.x = {0, 1, 2}, curve.y = {1, 2, 1};
  plain.curves = {curve};
  Plot much = plain;
  for (int i = 0; i < 12; ++i) {
    curve.legend = "a legend that takes room " + std::to_string(i);
    much.curves.push_back(curve);
  }
  EXPECT_EQ(frames(of({{plain}, {much}})).size(), 2U) << "one below the other each has its own";
  EXPECT_EQ(frames(of({{Columns{{{{plain}}, {{much}}}}}})).size(), 1U);
}

TEST(Plots, ALegendForSeveralIsDrawnAlone) {
  Plot legend;
  legend.only_legend = true;
  Plot::Curve curve;
  curve.legend = "run 1";
  legend.curves = {curve};
  EXPECT_TRUE(frames(of({{legend}, {Paragraph{"p"}}})).empty());
  EXPECT_EQ(count(pages_of(of({{legend}, {Paragraph{"p"}}})).all(), "run 1"), 1U);
}

TEST(Plots, ALegendTooLongForALineGoesOn) {
  Plot plot;
  Plot::Curve curve;
  curve.x = {0, 1}, curve.y = {0, 1};
  curve.legend = "Grenze von A = 30 arcsec / Limit of A = 30 arcsec";
  plot.curves = {curve};
  const std::string page = pages_of(of({{Columns{{{{plot}}, {}, {}, {}}}}})).all();
  EXPECT_EQ(count(page, "30 arcsec"), 2U) << page;
  EXPECT_EQ(count(page, "\u2026"), 0U);
}

TEST(Charts, BarsSayTheirValuesAndBearWhatIsNone) {
  BarChart chart;
  chart.title = "falls";
  chart.series = {{"rms", {}}, {"left out", {}}};
  chart.rows = {{"none", {{4.0, "4.00"}, {NAN, "–"}}},
                {"+ backlash", {{0.5, "0.500"}, {0.6, "0.600"}}}};
  chart.line = {0.55, 0.05, "floor"};
  const std::string text = pages_of(of({{chart}})).all();
  for (const char* word : {"falls", "left out", "+ backlash", "4.00", "0.600", "floor"})
    EXPECT_NE(text.find(word), std::string::npos) << word;
  chart.rows.clear();
  chart.line.reset();
  EXPECT_TRUE(pdf_bytes(of({{chart}}), *fonts()));
}

TEST(Layout, APageBreakBeginsAPageAndMakesNoEmptyOne) {
  const Paragraph one{"one"}, two{"two"};
  EXPECT_EQ(pages_of(of({{one}, {PageBreak{}}, {two}})).pages.size(), 2U);
  EXPECT_EQ(pages_of(of({{PageBreak{}}, {one}, {two}})).pages.size(), 1U);
  EXPECT_EQ(pages_of(of({{one}, {PageBreak{}}, {PageBreak{}}, {two}})).pages.size(), 2U);
  EXPECT_EQ(pages_of(of({{one}, {PageBreak{}}})).pages.size(), 1U);
}

TEST(Layout, TheLastBlockHasCompany) {
  for (int rows = 1; rows < 90; ++rows) {
    Table table;
    table.columns = {{"A", "", false}};
    for (int i = 0; i < rows; ++i) table.rows.push_back({{"row"}});
    const auto text = pages_of(of({{table}, {Paragraph{"finis"}}}));
    EXPECT_TRUE(count(text.pages.back(), "row") > 0) << rows;
    EXPECT_EQ(count(text.all(), "row"), static_cast<std::size_t>(rows));
  }
}

TEST(Layout, TheFootOfTheFirstPageHasItsPlace) {
  for (int lines = 1; lines < 130; lines += 3) {
    std::vector<Block> blocks;
    for (int i = 0; i < lines; ++i) blocks.push_back({Paragraph{"line"}});
    Document document = of(std::move(blocks));
    document.first_foot = {{Paragraph{"below"}}, {SignatureBox{"frame", {"name"}}}};
    const auto text = pages_of(document);
    EXPECT_EQ(count(text.pages.front(), "frame"), 1U) << lines;
    EXPECT_EQ(count(text.all(), "frame"), 1U) << lines;
    EXPECT_EQ(count(text.all(), "line"), static_cast<std::size_t>(lines));
  }
}

TEST(Pdf, TheSameBytesTwice) {
  const auto f = fonts();
  Document document = of({{Heading{"Heading"}}, {Paragraph{"text"}}});
  document.date = "2026-11-03";
  const auto one = pdf_bytes(document, *f), two = pdf_bytes(document, *f);
  ASSERT_TRUE(one && two);
  EXPECT_EQ(*one, *two);
  EXPECT_NE(one->find("D:20261103"), std::string::npos);
  EXPECT_EQ(one->find("/ID"), std::string::npos);
  document.date = "2026-13-45";  // no date: none is written
  EXPECT_TRUE(pdf_bytes(document, *f));
}

TEST(Pdf, KeptForLongItSaysColoursPropertiesAndIdentifier) {
  Document document = of({{Heading{"Heading"}}, {Paragraph{"text"}}});
  document.title = "Prüfbericht <7> & \"mehr\"";
  document.author = "R&D";
  document.date = "2026-11-03";
  document.profile = "an ICC profile";
  const auto one = pdf_bytes(document, *fonts()), again = pdf_bytes(document, *fonts());
  ASSERT_TRUE(one && again);
  EXPECT_EQ(*one, *again);
  for (const char* says :
       {"<rdf:li xml:lang=\"x-default\">Prüfbericht &lt;7&gt; &amp; \"mehr\"</rdf:li>",
        "<rdf:li>R&amp;D</rdf:li>", "<xmp:CreateDate>2026-11-03T00:00:00Z</xmp:CreateDate>",
        "<pdf:Producer>Haru", "/Subtype /XML", "/DestOutputProfile ", "/S /GTS_PDFA1"})
    EXPECT_EQ(count(*one, says), 1U) << says;
  EXPECT_EQ(one->find("pdfaid"), std::string::npos);
  const auto identifier = [](const std::string& bytes) {
    const std::size_t at = bytes.find("/ID [");
    return at == std::string::npos ? "" : bytes.substr(at, bytes.find(']', at) - at);
  };
  const std::string id = identifier(*one);
  ASSERT_GE(id.size(), 2 * 34U);
  EXPECT_EQ(id.substr(id.find('<'), 34), id.substr(id.rfind('<'), 34));
  document.blocks.push_back({Paragraph{"more"}});
  EXPECT_NE(identifier(*pdf_bytes(document, *fonts())), id);
}

TEST(Pdf, ALabelIsCutBetweenCharacters) {
  Document document = of({{Paragraph{"text"}}});
  for (int i = 0; i < 1500; ++i) document.title += "é";
  document.profile = "an ICC profile";
  const auto bytes = pdf_bytes(document, *fonts());
  ASSERT_TRUE(bytes);
  EXPECT_EQ(count(*bytes, "é"), 999U) << "after the letter T 1999 bytes are left";
}

}  // namespace
}  // namespace nonio::reports::document_test
