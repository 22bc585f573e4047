// SPDX-License-Identifier: Apache-2.0
#include "nonio/reports/picture.h"

#include "fixtures.h"
#include "nonio/reports/document.h"
#include "pdf_reader.h"
#include "png_file.h"

namespace nonio::reports::picture_test {
namespace {

using fixtures::png;

/// A frame header and an end, which is what a document needs to know of it.
std::string jpeg(unsigned width, unsigned height, char components = 3) {
  std::string out("\xFF\xD8\xFF\xE0\x00\x04\x00\x00\xFF\xC0\x00\x11\x08", 13);
  for (const unsigned v : {height, width}) {
    out += static_cast<char>(v >> 8);
    out += static_cast<char>(v & 0xFF);
  }
  out += components;
  return out + std::string(9, '\1') + "\xFF\xDA rest \xFF\xD9";
}

TEST(Pictures, ColoursAndOpacityComeAsTheyAre) {
  const std::string red_half("\xFF\0\0\x80\0\xFF\0\xFF", 8);
  const auto picture = shared_picture(png(2, 1, PNG_FORMAT_RGBA, red_half), "logo.png");
  ASSERT_TRUE(picture) << picture.error().message;
  EXPECT_FALSE((*picture)->grey);
  EXPECT_EQ(fixtures::inflated((*picture)->colours), std::string("\xFF\0\0\0\xFF\0", 6));
  EXPECT_EQ(fixtures::inflated((*picture)->opacity), "\x80\xFF");
  const auto grey = shared_picture(png(2, 2, PNG_FORMAT_GRAY, "abcd"), "grey.png");
  ASSERT_TRUE(grey);
  EXPECT_TRUE((*grey)->grey);
  EXPECT_EQ(fixtures::inflated((*grey)->colours), "abcd");
  EXPECT_TRUE((*grey)->opacity.empty());
}

TEST(Pictures, AJpegIsTakenAsItIs) {
  const auto picture = shared_picture(jpeg(30, 20), "logo.jpg");
  ASSERT_TRUE(picture) << picture.error().message;
  EXPECT_EQ((*picture)->width, 30U);
  EXPECT_EQ((*picture)->height, 20U);
  EXPECT_EQ((*picture)->colours, jpeg(30, 20));
}

TEST(Pictures, WhatIsBrokenOrTooLargeNamesTheFile) {
  const std::string sound = png(9, 9, PNG_FORMAT_GRAY, std::string(81, 'x'));
  std::vector<std::string> broken = {"",
                                     "GIF89a",
                                     "\xFF\xD8\xFF",
                                     jpeg(30, 20, 4),
                                     jpeg(0, 20),
                                     jpeg(4001, 20),
                                     jpeg(30, 20).substr(0, 30),
                                     png(4001, 1, PNG_FORMAT_GRAY, std::string(4001, 'x')),
                                     sound + std::string(2 << 20, 'x')};
  for (std::size_t size = 0; size + 12 < sound.size(); ++size)
    broken.push_back(sound.substr(0, size));
  for (std::size_t i = 0; i < broken.size(); ++i) {
    const auto picture = shared_picture(broken[i], "templates/logo.png");
    ASSERT_FALSE(picture) << i;
    EXPECT_EQ(picture.error().file, "templates/logo.png") << i;
  }
}

TEST(Pictures, ADocumentHoldsEachOnce) {
  static const Templates templates = fixtures::read_templates(NONIO_TEMPLATES);
  const auto file = [](const char* name) {
    return FontFile{templates.files.at("fonts/" + std::string(name) + ".ttf"), name};
  };
  const auto fonts = shared_fonts(file("LiberationSans-Regular"), file("LiberationSans-Bold"));
  ASSERT_TRUE(fonts);
  const Image logo{png(2, 1, PNG_FORMAT_RGBA, "abcdefgh"), "logo.png", 20, 0},
      mark{jpeg(300, 10), "mark.jpg", 400, 1};
  Document document;
  document.blocks = {{Columns{{{{logo}}, {{mark}}}}}, {logo}, {Paragraph{"text"}}};
  const auto one = pdf_bytes(document, **fonts), two = pdf_bytes(document, **fonts);
  ASSERT_TRUE(one && two) << one.error().message;
  EXPECT_EQ(*one, *two);
  const auto times = [&](std::string_view what, const std::string& in) {
    std::size_t n = 0;
    for (std::size_t at = 0; (at = in.find(what, at)) != std::string::npos; at += what.size()) ++n;
    return n;
  };
  EXPECT_EQ(times("/Subtype /Image", *one), 3U) << "the logo, its opacity, the mark";
  EXPECT_EQ(times("/SMask ", *one), 1U);
  EXPECT_EQ(times("/Filter /DCTDecode", *one), 1U);
  std::string all;
  for (const std::string& stream : fixtures::streams(*one)) all += stream;
  EXPECT_EQ(times("/P0 Do", all), 2U);
  EXPECT_EQ(times("q 40 0 0 20 ", all), 2U) << "twice as wide as high";
  EXPECT_EQ(times("/P1 Do", all), 1U);
  EXPECT_EQ(times(" 0 0 400 ", all), 0U) << "no wider than its column";
  document.blocks = {{Image{"none", "templates/x.png", 20, 0}}};
  const auto broken = pdf_bytes(document, **fonts);
  ASSERT_FALSE(broken);
  EXPECT_EQ(broken.error().file, "templates/x.png");
}

}  // namespace
}  // namespace nonio::reports::picture_test
