// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/causes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "nonio/sdk/format.h"
#include "platform/storage/files.h"

namespace nonio::config {

namespace {

const char* const one = R"toml(format = 1
[[cause]]
name = "crane"
title = "The crane"
axis = "linear"
expression = "z*max(0, t/duration - f)"
parameters = [{ name = "z", unit = "um" }, { name = "f", unit = "1", start = 0.5, range = [0.1, 0.9] }]
is = "It tilts the foundation."
size = "5 um."
remedy = "Park it elsewhere."
prior = "rare"
)toml";

Templates with(const std::string& name, const std::string& text) {
  Templates t;
  t.files[name] = text;
  return t;
}

std::string changed(const std::string& from, const std::string& to) {
  std::string text = one;
  return text.replace(text.find(from), from.size(), to);
}

void read_words(const std::vector<Cause>& causes, Templates& t) {
  t.tables.read_later({"de", "en", "it"}, [&](const std::string& language, auto& tables) {
    add_words(causes, language, tables);
  });
}

std::string message(const Templates& t) {
  const auto causes = causes_in(t);
  if (causes) return "";
  const Error& e = causes.error().front();
  return e.file + ":" + std::to_string(e.line) + ": " + e.message;
}

TEST(Causes, EachOneThatIsShippedPassesTheTrialOfItsUnits) {
  Templates t;
  const std::filesystem::path folder = std::filesystem::path(NONIO_WORDS).parent_path() / "causes";
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    const auto text = storage::read_file(file.path());
    ASSERT_TRUE(text);
    t.files["causes/" + file.path().filename().string()] = *text;
  }
  const auto causes = causes_in(t);
  ASSERT_TRUE(causes) << message(t);
  EXPECT_GE((*causes)->size(), 60U);
  for (const Cause& c : **causes) {
    const auto effect = c.effect(false);
    EXPECT_TRUE(effect) << c.formula.name << ": " << effect.error().message;
  }
}

TEST(Causes, OneOfASiteIsReadWithItsTextsAndItsPrice) {
  Templates t = with("causes/site/shop.toml", one);
  const auto causes = causes_in(t);
  ASSERT_TRUE(causes) << message(t);
  ASSERT_EQ((*causes)->size(), 1U);
  EXPECT_NEAR((*causes)->front().price(), 2.0 * std::log(10.0), 1e-12);
  read_words(**causes, t);
  EXPECT_EQ(words(t, "en", "effect.crane.remedy"), "Park it elsewhere.");
}

TEST(Causes, AFormerKeyIsReadWithAWarning) {
  Templates t = with("causes/site/shop.toml", changed("remedy =", "cure ="));
  const auto causes = causes_in(t);
  ASSERT_TRUE(causes) << message(t);
  EXPECT_EQ((*causes)->front().remedy, "Park it elsewhere.");
  const auto warnings = warnings_of_causes(t);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].message.find("cause.cure is now named cause.remedy"), std::string::npos)
      << warnings[0].message;
  EXPECT_TRUE(warnings_of_causes(with("causes/site/shop.toml", one)).empty());
}

TEST(Causes, AColumnThatNoReadingHasIsRefused) {
  const std::string text = std::string(one) + "columns = [\"tiem_s\"]\n";
  EXPECT_EQ(
      message(with("causes/site/shop.toml", text)),
      "causes/shop.toml:12: cause.columns: expected one of time_s; found \"tiem_s\" (nearest: "
      "\"time_s\")");
}

TEST(Causes, ATitleMayHaveLanguages) {
  Templates t = with("causes/site/shop.toml",
                     changed("\"The crane\"", "{ en = \"The crane\", de = \"Der Kran\" }"));
  const auto causes = causes_in(t);
  ASSERT_TRUE(causes) << message(t);
  EXPECT_EQ("The crane", (*causes)->front().title);
  read_words(**causes, t);
  EXPECT_EQ("The crane", words(t, "en", "effect.crane.title"));
  EXPECT_EQ("Der Kran", words(t, "de", "effect.crane.title"));
  EXPECT_EQ("", words(t, "it", "effect.crane.title")) << "English takes its place";
  EXPECT_EQ(
      message(with("causes/site/shop.toml", changed("\"The crane\"", "{ de = \"Der Kran\" }"))),
      "causes/shop.toml:4: cause.title: expected a text, or one for en among the texts by "
      "language");
}

TEST(Causes, ANameInTwoPlacesNamesBoth) {
  Templates t = with("causes/machine.toml", one);
  t.files["causes/site/shop.toml"] = one;
  EXPECT_EQ(message(t),
            "causes/shop.toml:3: cause.name: \"crane\" is in templates/causes/machine.toml:3 "
            "already; give one of them another name");
}

TEST(Causes, AMistakeInASitesFileIsReportedWithItsLine) {
  const std::string name = "causes/site/shop.toml";
  const std::string key = message(with(name, changed("prior =", "sise = 1\nprior =")));
  EXPECT_NE(key.find("causes/shop.toml:11"), std::string::npos) << key;
  const std::string unit = message(with(name, changed("z*max(0, t/duration - f)", "z*t*f")));
  EXPECT_NE(unit.find("causes/shop.toml:6"), std::string::npos) << unit;
  EXPECT_NE(unit.find("time"), std::string::npos) << unit;
  EXPECT_NE(message(with(name, changed("\"rare\"", "\"often\""))), "");
}

TEST(Causes, OnlyFilesDirectlyInTheFolderCount) {
  EXPECT_TRUE(is_causes_file("causes/machine.toml"));
  EXPECT_TRUE(is_causes_file("causes/site/shop.toml"));
  EXPECT_FALSE(is_causes_file("causes/site/campaign.toml"));
  EXPECT_FALSE(is_causes_file("causes/site/x/shop.toml"));
  EXPECT_FALSE(is_causes_file("words/en/causes.toml"));
}

}  // namespace

}  // namespace nonio::config
