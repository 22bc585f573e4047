// SPDX-License-Identifier: Apache-2.0
#include "certificates/recomputed.h"

#include <gtest/gtest.h>

namespace nonio::recomputed_test {
namespace {

std::string results(const std::string& value, const std::string& more = {}) {
  return R"({"analyses": [{"plugin": "iso230-2", "version": "1", "measurement": "X",
             "values": {"A": {"value": )" +
         value + R"(, "unit": "um", "U": 1.9}}, "findings": [], "points": [{"target": 0}]})" +
         more + "]}";
}

std::string why(const std::string& attached, const std::string& again) {
  const auto same = certificates::same_values(attached, again);
  return same ? "" : same.error().message;
}

TEST(Recomputed, TheSameNumbersAreTheSame) {
  EXPECT_EQ(why(results("11.96"), results("11.96")), "");
  EXPECT_EQ(why(results("11.96"), results("11.960000000001")), "");
}

TEST(Recomputed, AnyDifferenceIsSaid) {
  EXPECT_NE(why(results("11.96"), results("11.97")).find("iso230-2 of X values A value"),
            std::string::npos);
  EXPECT_NE(why(results("11.96"), results("null")), "");
  EXPECT_NE(why(results("11.96"), "{\"analyses\": []}").find("plugin installed"),
            std::string::npos);
  EXPECT_NE(why(results("11.96"), results("11.96", R"(,{"plugin": "vdi"})")), "");
  EXPECT_NE(why(results("11.96", R"(,{"plugin": "vdi"})"), results("11.96")), "");
  EXPECT_NE(why(R"({"analyses": []})", R"({"analyses": []})"), "");
}

/// A measurement over time has a model for each displacement.
TEST(Recomputed, AnalysesOfOneNameAreComparedInTheirOrder) {
  const auto model = [](const char* rms) {
    return std::string(
               R"(,{"plugin": "model-fit", "measurement": "t", "values": {"rms": {"value": )") +
           rms + R"(, "unit": "um"}}})";
  };
  EXPECT_EQ(
      why(results("1", model("13.2") + model("2.1")), results("1", model("13.2") + model("2.1"))),
      "");
  EXPECT_NE(
      why(results("1", model("13.2") + model("2.1")), results("1", model("13.2") + model("2.2"))),
      "");
  EXPECT_NE(why(results("1", model("13.2") + model("2.1")), results("1", model("13.2"))), "");
}

/// Our parser reads the last one, others the first: a document must not have two values of one key.
TEST(Recomputed, AKeyTwiceIsNoResult) {
  const std::string once = results("11.96");
  const std::string twice = results(R"(1.0, "value": 11.96)");
  EXPECT_NE(why(twice, once).find("twice"), std::string::npos);
  EXPECT_NE(why(R"({"analyses": [], )" + once.substr(1), once).find("twice"), std::string::npos);
  EXPECT_FALSE(certificates::same_results(twice, once, {}));
}

TEST(Recomputed, ResultsAreComparedAsText) {
  const std::string made = results("11.96");
  EXPECT_TRUE(certificates::same_results(made, made, {}));
  EXPECT_TRUE(certificates::same_results(results("11.960000000001"), made, {}));
  EXPECT_FALSE(certificates::same_results(made + "\n", made, {}));
  EXPECT_FALSE(certificates::same_results(results(" 11.96"), made, {}));
}

TEST(Recomputed, WhatIsNoResultsIsSaid) {
  for (const char* text : {"", "{", "[]", "1", R"({"analyses": 1})", R"({"analyses": [1]})",
                           R"({"analyses": [{"plugin": 1}]})"})
    EXPECT_NE(why(text, results("1")), "") << text;
}

std::string dcc(const std::string& value, const std::string& unit,
                const std::string& list = "1 2") {
  return R"(<?xml version="1.0"?><d:digitalCalibrationCertificate xmlns:d="https://ptb.de/dcc" xmlns:si="https://ptb.de/si">
<d:measurementResults><d:measurementResult><d:name><d:content>iso230-2 of X</d:content></d:name><d:results><d:result><d:data>
<d:quantity><d:name><d:content>A</d:content></d:name><si:real><si:value>)" +
         value + "</si:value><si:unit>" + unit +
         R"(</si:unit><si:measurementUncertaintyUnivariate><si:expandedMU><si:valueExpandedMU>1.9</si:valueExpandedMU>
<si:coverageFactor>2</si:coverageFactor></si:expandedMU></si:measurementUncertaintyUnivariate></si:real></d:quantity>
<d:list><d:quantity><si:realListXMLList><si:valueXMLList>1 2</si:valueXMLList><si:unitXMLList>\one</si:unitXMLList></si:realListXMLList></d:quantity>
<d:quantity><si:realListXMLList><si:valueXMLList>)" +
         list +
         R"(</si:valueXMLList><si:unitXMLList>\one</si:unitXMLList></si:realListXMLList></d:quantity></d:list>
</d:data></d:result></d:results></d:measurementResult></d:measurementResults></d:digitalCalibrationCertificate>)";
}

sign::Check::State state(const std::string& xml, const std::string& json) {
  const pdf::Attachment with{"results.json", json, {}, {}, {}};
  return certificates::check_dcc({"dcc.xml", xml, {}, {}, {}}, &with).state;
}

TEST(Dcc, ItsNumbersAreThoseOfTheResults) {
  using State = sign::Check::State;
  EXPECT_EQ(state(dcc("11.96", "\\micro\\metre"), results("11.96")), State::holds);
  EXPECT_EQ(state(dcc("11.97", "\\micro\\metre"), results("11.96")), State::fails);
  EXPECT_EQ(state(dcc("nan", "\\micro\\metre"), results("11.96")), State::fails);
  EXPECT_EQ(state(dcc("11.96", "\\milli\\metre"), results("11.96")), State::fails);
  EXPECT_EQ(state(dcc("11.96", "\\micro\\metre"), "{}"), State::fails);
}

TEST(Dcc, ItsCoverageFactorIsThatOfTheResults) {
  using State = sign::Check::State;
  const auto with_k = [](const std::string& k) {
    std::string text = dcc("11.96", "\\micro\\metre");
    const std::string two = "<si:coverageFactor>2<";
    return text.replace(text.find(two), two.size(), "<si:coverageFactor>" + k + "<");
  };
  std::string json = results("11.96");
  EXPECT_EQ(state(with_k("2.3"), json), State::fails);  // results of earlier versions: k = 2
  json.replace(json.find("\"U\": 1.9"), 8, "\"U\": 1.9, \"k\": 2.3");
  EXPECT_EQ(state(with_k("2.3"), json), State::holds);
  EXPECT_EQ(state(with_k("2"), json), State::fails);
  EXPECT_EQ(state(with_k("0.1"), json), State::fails);
  EXPECT_EQ(state(with_k(""), json), State::fails);
}

TEST(Recomputed, ResultsOfEarlierVersionsHaveNeitherCoverageFactorNorBudget) {
  const std::string before = results("11.96");
  std::string now = before;
  now.replace(now.find("\"U\": 1.9"), 8, "\"U\": 1.9, \"k\": 2.0");
  now.replace(now.find("\"findings\""), 10, "\"budget\": {\"length_mm\": 1}, \"findings\"");
  EXPECT_EQ(why(before, now), "");
  EXPECT_NE(why(now, before), "");
  std::string other = now;
  other.replace(other.find("\"length_mm\": 1"), 14, "\"length_mm\": 2");
  EXPECT_NE(why(now, other), "");
}

TEST(Dcc, UnitsAndLengthsOfListsThatTheSchemaLetsPass) {
  using State = sign::Check::State;
  EXPECT_EQ(state(dcc("11.96", "um"), results("11.96")), State::fails);
  EXPECT_EQ(state(dcc("11.96", "\\micro\\metre", "1 2 3"), results("11.96")), State::fails);
  EXPECT_EQ(state(dcc("11.96", "\\micro\\metre", ""), results("11.96")), State::fails);
  EXPECT_EQ(state("<a/>", results("11.96")), State::fails);
  EXPECT_EQ(state("", results("11.96")), State::fails);
}

}  // namespace
}  // namespace nonio::recomputed_test
