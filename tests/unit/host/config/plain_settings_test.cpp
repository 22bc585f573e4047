// SPDX-License-Identifier: Apache-2.0
//
// What the short reader of words gives, the parser of TOML gives too.
#include "host/config/plain_settings.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "host/config/manifest.h"

namespace nonio::host::plain_settings_test {
namespace {

namespace fs = std::filesystem;
using Values = decltype(Settings::values);

/// By the parser of TOML: a number is nothing for the short reader.
std::optional<Values> parsed(const std::string& text) {
  auto settings = config::parse_settings("before_all = 1\n" + text, "x.toml");
  if (!settings) return std::nullopt;
  settings->values.erase("before_all");
  return settings->values;
}

TEST(PlainSettings, FilesOfWordsAreReadAsTomlReadsThem) {
  std::size_t read = 0;
  for (const auto& entry : fs::recursive_directory_iterator(NONIO_WORDS)) {
    if (entry.path().extension() != ".toml") continue;
    std::ostringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    const auto plain = config::plain_settings(text.str());
    // These have a table within a line.
    EXPECT_EQ(plain.has_value(), entry.path().filename() != "pictures.toml") << entry.path();
    if (!plain) continue;
    ++read;
    EXPECT_EQ(std::optional(plain->values), parsed(text.str())) << entry.path();
  }
  EXPECT_GE(read, 50U);
}

TEST(PlainSettings, LeavesToTheParserWhatItDoesNotKnow) {
  EXPECT_EQ(config::plain_settings("a = \"b \\\"c\\\"\" # no more\n"), std::nullopt);
  for (const char* text : {"a = 1",
                           "a = 'b'",
                           "a = \"\"\"b\"\"\"",
                           "a = \"\\n\"",
                           "a = \"b\"\r\n",
                           "[[a]]",
                           "[a] # b",
                           "[a",
                           "a",
                           "= \"b\"",
                           "a = \"b",
                           "a.b. = \"c\"",
                           "\"\" = \"a\"",
                           "a.\"\" = \"b\"",
                           "a = \"b\"\na = \"c\"",
                           "[a]\n[a]",
                           "a = \"b\"\n[a]",
                           "[a.b]\n[a]\nb = \"c\"",
                           "a.b = \"c\"\n[a]",
                           "a = \"b\"\na.c = \"d\"",
                           "\xEF\xBB\xBF"
                           "a = \"b\"",
                           "a = \"\xC3\"",
                           "a = \"\x7F\"",
                           "a = \"\t\"",
                           "\xC3\xA4 = \"b\"",
                           "a.b.c.d.e.f.g.h.i.j = \"k\""})
    EXPECT_FALSE(config::plain_settings(text)) << text;
  const auto plain = config::plain_settings(
      "# words\n\nx.y = \"z\"\n[a.\"b.c\"]\nd=\"\xC3\xA4 \\\"e\\\"\"\n[a]\n\"f g\"  =  \"\"");
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->values, (Values{{"x.y", "z"}, {"a.b.c.d", "\xC3\xA4 \"e\""}, {"a.f g", ""}}));
}

TEST(PlainSettings, RandomTextsAreReadAsTomlReadsThem) {
  const unsigned seed = 20261126;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const auto one_of = [&](const std::vector<std::string>& all) {
    return all[std::uniform_int_distribution<std::size_t>(0, all.size() - 1)(random)];
  };
  const std::vector<std::string> keys{"a",   "b",    "c",        "\"a\"",       "\"a.b\"",
                                      "a-1", "\"\"", "\"\\\"\"", "\"\xC3\xA4\""};
  const std::vector<std::string> texts{"",
                                       "x",
                                       "\\\"",
                                       "\\\\",
                                       "{n}",
                                       "#",
                                       "\xE2\x80\xA8",
                                       "\xC2\x85",
                                       "\xEF\xBF\xBF",
                                       "\xF4\x8F\xBF\xBF",
                                       "\xED\xA0\x80",
                                       "\xC0\x80",
                                       "'",
                                       "=",
                                       "]"};
  const auto path = [&] {
    std::string keys_of = one_of(keys);
    while (random() % 3 == 0) keys_of += "." + one_of(keys);
    return keys_of;
  };
  std::size_t plain_ones = 0, refused = 0;
  for (int i = 0; i < 4000; ++i) {
    std::string text;
    for (auto lines = 1 + random() % 6; lines > 0; --lines) {
      const auto kind = random() % 12;
      if (kind < 4)
        text += "[" + path() + "]";
      else if (kind < 10)
        text += path() + one_of({" = ", "=", "  =", "= ", " "}) + "\"" + one_of(texts) +
                one_of(texts) + "\"" + one_of({"", "", "", "", " ", "\""});
      else
        text += one_of({"", "# " + one_of(texts), "  ", "a = 1", "a = [\"b\"]"});
      text += "\n";
    }
    const auto wanted = parsed(text);
    refused += wanted ? 0 : 1;
    const auto plain = config::plain_settings(text);
    if (!plain) continue;
    ++plain_ones;
    ASSERT_EQ(wanted, std::optional(plain->values)) << text;
  }
  EXPECT_GE(plain_ones, 300U);
  EXPECT_GE(refused, 300U);
}

}  // namespace
}  // namespace nonio::host::plain_settings_test
