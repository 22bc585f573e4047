// SPDX-License-Identifier: Apache-2.0
//
// Each language has the same files of words with the same keys, and each text the same places.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "nonio/host/manifest.h"

namespace nonio::host {
namespace {

namespace fs = std::filesystem;

std::map<std::string, Settings> files_of(const std::string& language) {
  std::map<std::string, Settings> out;
  for (const auto& entry : fs::directory_iterator(fs::path(NONIO_WORDS) / language)) {
    std::ostringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    auto settings = parse_settings(text.str(), entry.path().string());
    EXPECT_TRUE(settings) << settings.error().message;
    if (settings) out[entry.path().filename().string()] = std::move(*settings);
  }
  return out;
}

std::multiset<std::string> places(const std::string& text) {
  static const std::regex place("\\{[^}]*\\}");
  return {std::sregex_token_iterator(text.begin(), text.end(), place), {}};
}

std::set<std::string> keys(const Settings& file) {
  std::set<std::string> out;
  for (const auto& [key, value] : file.values) out.insert(key);
  return out;
}

TEST(WordFiles, LanguagesAgree) {
  const auto english = files_of("en");
  ASSERT_GE(english.size(), 3U);
  std::set<std::string> languages;
  for (const auto& entry : fs::directory_iterator(NONIO_WORDS))
    languages.insert(entry.path().filename().string());
  ASSERT_TRUE(languages.count("it"));
  for (const std::string& language : languages) {
    const auto other = files_of(language);
    ASSERT_EQ(other.size(), english.size()) << language;
    for (const auto& [file, words] : english) {
      ASSERT_TRUE(other.count(file)) << language << "/" << file;
      EXPECT_EQ(keys(other.at(file)), keys(words)) << language << "/" << file;
      for (const auto& [key, value] : words.values) {
        const std::string there = other.at(file).text(key);
        EXPECT_FALSE(there.empty()) << language << "/" << file << " " << key;
        EXPECT_EQ(places(there), places(words.text(key))) << language << "/" << file << " " << key;
      }
    }
  }
}

// A remark without words would appear in English in every language.
TEST(WordFiles, EveryRemarkHasThem) {
  std::set<std::string> known;
  for (const auto& [file, words] : files_of("en"))
    for (const auto& [key, value] : words.values)
      if (key.starts_with("note.")) known.insert(key.substr(5));
  static const std::regex id(
      "\"((?:method|csv|fanuc|siemens|heidenhain|linuxcnc)\\.[a-z0-9-]{2,}|measurement\\.unread|"
      "table\\.(?:left-out|one-direction|reversal-unjudged))\"");
  std::set<std::string> used;
  const fs::path root = fs::path(NONIO_WORDS) / ".." / "..";
  for (const char* folder : {"plugins", "engine/host/src"})
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      if (entry.path().extension() != ".cpp") continue;
      std::ostringstream text;
      text << std::ifstream(entry.path()).rdbuf();
      const std::string source = text.str();
      for (std::sregex_iterator it(source.begin(), source.end(), id), end; it != end; ++it)
        used.insert((*it)[1]);
    }
  EXPECT_GE(used.size(), 15U);
  EXPECT_EQ(used, known);
}

}  // namespace
}  // namespace nonio::host
