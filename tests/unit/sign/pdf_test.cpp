// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "authority.h"
#include "nonio/sign/verify.h"

namespace nonio::sign_tests::pdf_test {
namespace {

TEST(Reserve, IsReproducibleAndKeepsThePages) {
  const std::vector<pdf::Attachment> files = {{"a.csv", "1", "text/csv", "Source", "a"}};
  const auto one = pdf::reserve(small_pdf(), files, now),
             two = pdf::reserve(small_pdf(), files, now);
  ASSERT_TRUE(one) << one.error().message;
  EXPECT_EQ(*one, *two);
  EXPECT_NE(one->find("BT /F1 12 Tf 50 800 Td (E = 4.5 um) Tj ET"), std::string::npos);
  EXPECT_EQ(one->find("startxref"), one->rfind("startxref"));
}

TEST(Reserve, ShowsTheSignatureInTheFrameThatThePageHasForIt) {
  const auto plain = pdf::reserve(small_pdf(), {}, now);
  ASSERT_TRUE(plain);
  EXPECT_NE(plain->find("/Rect [0 0 0 0]"), std::string::npos);
  EXPECT_EQ(plain->find("/AP"), std::string::npos);
  const auto framed =
      pdf::reserve(small_pdf("a", "/NonioSignature [ 300 100 450 160 ]\n"), {}, now);
  ASSERT_TRUE(framed) << framed.error().message;
  EXPECT_NE(framed->find("/Rect [300 100 450 160]\n/AP << /N "), std::string::npos);
  EXPECT_NE(framed->find("/Subtype /Form\n/BBox [300 100 450 160]"), std::string::npos);
  for (const char* odd : {"[ 1 2 3 ]", "[ 1 2 3 /X ]", "(text)", "[ 1 2 3 4.5 ]"}) {
    const auto other =
        pdf::reserve(small_pdf("a", "/NonioSignature " + std::string(odd) + "\n"), {}, now);
    ASSERT_TRUE(other) << odd;
    EXPECT_NE(other->find("/Rect [0 0 0 0]"), std::string::npos) << odd;
  }
}

TEST(Reserve, RefusesWhatItWouldHaveToGuess) {
  const auto why = [](const std::string& pdf, const std::vector<pdf::Attachment>& files = {}) {
    const auto done = pdf::reserve(pdf, files, now);
    return done ? "" : done.error().message;
  };
  EXPECT_EQ(why(small_pdf()), "");
  EXPECT_NE(why(""), "");
  EXPECT_NE(why("hello"), "");
  EXPECT_NE(why(small_pdf() + "x"), "");
  EXPECT_NE(why(small_pdf() + small_pdf()), "");
  EXPECT_NE(why(" " + small_pdf()), "");
  EXPECT_NE(why(small_pdf(), {{"", "", "text/csv", "Source", ""}}), "");
  EXPECT_NE(why(small_pdf(), {{"\xFF", "", "text/csv", "Source", ""}}), "");
  EXPECT_NE(
      why(small_pdf(), {{"a", "", "text/csv", "Source", ""}, {"a", "", "text/csv", "Source", ""}}),
      "");
  std::string hidden = small_pdf();
  hidden.replace(hidden.find("\nendobj"), 1, "%");
  EXPECT_NE(why(hidden), "");
}

TEST(Pages, AreWhatWasDrawn) {
  const auto plain = pdf::page_contents(small_pdf("a")),
             reserved = pdf::page_contents(*pdf::reserve(small_pdf("a"), {}, now));
  ASSERT_TRUE(plain && reserved);
  EXPECT_EQ(*plain, *reserved);
  EXPECT_EQ(*plain, std::vector<std::string>{"BT /F1 12 Tf 50 800 Td (a) Tj ET\n"});
  EXPECT_NE(*plain, *pdf::page_contents(small_pdf("b")));
  std::string broken = small_pdf();
  broken.replace(broken.find("/Kids [ 4 0 R ]"), 15, "/Kids [ 2 0 R ]");
  EXPECT_FALSE(pdf::page_contents(broken));
  broken = small_pdf();
  broken.replace(broken.find("/Contents 5 0 R"), 15, "/Contents 9 0 R");
  EXPECT_FALSE(pdf::page_contents(broken));
  EXPECT_FALSE(pdf::page_contents("hello"));
}

TEST(Verify, SaysNoToWhatIsNoSignedPdf) {
  sign::Verifier verifier;
  verifier.now = now;
  const std::string brackets = "%PDF-1.7\n" + std::string(1000, '[');
  for (const std::string& bytes :
       {std::string(), std::string("hello"), small_pdf(), *pdf::reserve(small_pdf(), {}, now),
        std::string(1000, '('), brackets}) {
    const auto verified = sign::verify_pdf(bytes, verifier);
    EXPECT_FALSE(verified.holds());
    ASSERT_FALSE(verified.checks.empty());
    EXPECT_FALSE(verified.checks.back().says.empty());
  }
}

}  // namespace
}  // namespace nonio::sign_tests::pdf_test
