// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "nonio/sdk/format.h"

namespace nonio {
namespace {

/// Two files of one language say the same name, and one name is a number.
Templates two_files() {
  Templates t;
  t.tables["words/en/a"].values = {
      {"finding.drift.title", std::string("of a, {mean} at {mean_um} um {what} {open")},
      {"finding.drift.says", std::int64_t{3}},
      {"effect.scale.name", std::string("Scale")}};
  t.tables["words/en/b"].values = {{"finding.drift.title", std::string("of b")},
                                   {"finding.drift.says", std::string("of b")},
                                   {"finding.turn.title", std::string("{strange} }")},
                                   {"note.moved", std::string("{count} readings of {what}")},
                                   {"term.what.x", std::string("the X axis")}};
  t.tables["words/english/a"].values = {{"finding.turn.title", std::string("of another language")}};
  t.tables["words/it/a"].values = {{"finding.drift.title", std::string("in italiano {mean}")}};
  return t;
}

const Finding drift{
    .id = "drift", .evidence = {{"mean", 0.0025, Quantity::deviation}}, .texts = {{"what", "x"}}};

void expect_what_is_said(const Templates& t) {
  EXPECT_EQ(finding_text(t, "en", drift, "title"), "of a, 2500 um at 2500 um the X axis {open");
  EXPECT_EQ(finding_text(t, "en", drift, "says"), "");  // the first file has the name, and no text
  EXPECT_EQ(finding_text(t, "en", {.id = "turn"}, "title"), "{strange} }");
  EXPECT_EQ(finding_text(t, "it", drift, "title"), "in italiano 2500 um");
  EXPECT_EQ(finding_text(t, "it", {.id = "turn"}, "title"), "{strange} }");  // English in its place
  EXPECT_EQ(finding_text(t, "en", {.id = "unknown"}, "title"), "unknown");
  EXPECT_EQ(remark_text(t, "en", {"moved", {{"count", 2, Quantity::count}}, {{"what", "x"}}}),
            "2 readings of x");
  EXPECT_EQ(words(t, "en", "effect.scale.name"), "Scale");
  EXPECT_EQ(words(t, "en", "effect.other.name"), "");
}

TEST(Words, AValueHasItsUInTheSameUnitAndRounding) {
  const Finding f{.id = "f",
                  .evidence = {{"value", 0.00005188, Quantity::length},
                               {"U", 8.3e-7, Quantity::deviation},
                               {"none", 0.0, Quantity::deviation},
                               {"share", 0.25254, Quantity::ratio}}};
  EXPECT_EQ(filled("{value\u00b1U}", f, "en"), "0.05188 \u00b1 0.00083 mm");
  EXPECT_EQ(filled("{value\u00b1U}", f, "de"), "0,05188 \u00b1 0,00083 mm");
  EXPECT_EQ(filled("{value\u00b1none}", f, "en"), "0.0519 mm");
  EXPECT_EQ(filled("{value\u00b1other} {other\u00b1U}", f, "en"),
            "{value\u00b1other} {other\u00b1U}");
  EXPECT_EQ(filled("{share%}, {other%}", f, "en"), "25 %, {other%}");
}

TEST(Words, EachOfAListHasItsTerm) {
  const Templates t = two_files();
  const auto text = [&](const std::string& what) {
    return said(t, "en", {{"what", what}})[0].second;
  };
  EXPECT_EQ(text("y, x, x"), "y, the X axis, the X axis");
  EXPECT_EQ(text("x,x"), "x,x");
  EXPECT_EQ(text(""), "");
  EXPECT_EQ(text("x, "), "the X axis, ");
}

TEST(Words, AValueHasTheDigitsOfItsU) {
  const Finding f{.evidence = {{"x", -0.3e-6, Quantity::deviation},
                               {"U", 0.238e-6, Quantity::deviation},
                               {"zero", 0.0, Quantity::deviation},
                               {"time", 197.4, Quantity::number},
                               {"U_time", 12.3, Quantity::number}}};
  EXPECT_EQ(filled("by {x±U}: no", f, "de"), "by -0,30 ± 0,24 um: no");
  EXPECT_EQ(filled("{time±U_time} min", f, "en"), "197 ± 12 min");
  EXPECT_EQ(filled("{x±zero}", f, "en"), "-0.300 um");
  EXPECT_EQ(filled("{x±other} {x±", f, "en"), "{x±other} {x±");
}

TEST(Words, OnlyNumbersOfATextHaveTheDecimalSignOfTheLanguage) {
  const auto text = [](const char* key, const char* of) {
    return filled(std::string("{") + key + "}", Finding{.texts = {{key, of}}}, "de");
  };
  EXPECT_EQ(text("weakest", "1.00 EYZ.2 - 0.637 EYX.2"), "1,00 EYZ.2 - 0,637 EYX.2");
  EXPECT_EQ(text("which", "580.178 mm (4, +)"), "580,178 mm (4, +)");
  EXPECT_EQ(text("which", "x1.2"), "x1.2");  // a measurement
  EXPECT_EQ(text("file", "1.2"), "1.2");
}

TEST(Words, AreTheSameIfTheyAreReadWhenTheyAreNeeded) {
  const Templates now = two_files();
  expect_what_is_said(now);
  Templates later;
  std::vector<std::string> read;
  later.tables.read_later({"en", "english", "it"}, [&](const std::string& language, auto& tables) {
    read.push_back(language);
    for (const auto& [name, table] : now.tables)
      if (name.starts_with("words/" + language + "/")) tables[name] = table;
  });
  EXPECT_EQ(words(later, "de", "note.moved"), "");
  EXPECT_EQ(read, std::vector<std::string>());
  const Templates copy = later;
  expect_what_is_said(later);
  EXPECT_EQ(read, (std::vector<std::string>{"en", "it"}));
  EXPECT_TRUE(later.tables.contains("words/english/a"));
  EXPECT_EQ(std::distance(copy.tables.begin(), copy.tables.end()), 4);
  expect_what_is_said(copy);
  EXPECT_EQ(read, (std::vector<std::string>{"en", "it", "english", "en", "english", "it"}));
}

}  // namespace
}  // namespace nonio
