// SPDX-License-Identifier: Apache-2.0
//
// Every finding of the axis analyses has words in each language, and every place in the words is
// filled by its evidence.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

namespace nonio::words_test {
namespace {

namespace fs = std::filesystem;

// [finding."id"] with the text of its keys; enough of TOML for the files of words.
std::map<std::string, std::string> sections(const fs::path& file) {
  std::map<std::string, std::string> out;
  std::ifstream in(file);
  std::string id;
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("[finding.\"", 0) == 0)
      id = line.substr(10, line.find("\"]") - 10);
    else if (line.starts_with('['))
      id.clear();
    else if (!id.empty())
      out[id] += line + "\n";
  }
  return out;
}

std::set<std::string> places(const std::string& text) {
  static const std::regex place("\\{([\\w-]*)(?:±(\\w*))?%?\\}");
  std::set<std::string> out;
  for (std::sregex_iterator it(text.begin(), text.end(), place), end; it != end; ++it)
    for (const int of : {1, 2})
      if ((*it)[of].matched) out.insert((*it)[of]);
  return out;
}

std::string all_sources() {
  const fs::path root = fs::path(NONIO_WORDS) / ".." / "..";
  std::ostringstream text;
  for (const char* folder : {"engine/math", "plugins/analyses/vdi-dgq-3441"})
    for (const auto& entry : fs::recursive_directory_iterator(root / folder))
      if (entry.path().extension() == ".cpp") text << std::ifstream(entry.path()).rdbuf();
  return text.str();
}

TEST(Words, AllLanguagesSayTheSameFindings) {
  const auto en = sections(fs::path(NONIO_WORDS) / "en" / "findings.toml");
  ASSERT_GE(en.size(), 25U);
  const std::string sources = all_sources();
  for (const char* language : {"de", "it"}) {
    const auto other = sections(fs::path(NONIO_WORDS) / language / "findings.toml");
    ASSERT_EQ(en.size(), other.size()) << language;
    for (const auto& [id, text] : en) {
      ASSERT_TRUE(other.count(id)) << language << " " << id;
      EXPECT_EQ(places(text), places(other.at(id))) << language << " " << id;
      for (const char* key : {"title = ", "says = ", "advice = "})
        EXPECT_NE(other.at(id).find(key), std::string::npos) << language << " " << id;
    }
  }
  for (const auto& [id, text] : en) {
    for (const char* key : {"title = ", "says = ", "advice = "})
      EXPECT_NE(text.find(key), std::string::npos) << id;
    const std::string stem = id.substr(0, id.find("-left-out"));
    EXPECT_NE(sources.find("\"" + stem), std::string::npos) << "no source gives " << id;
    for (const std::string& place : places(text))
      EXPECT_NE(sources.find("\"" + place + "\""), std::string::npos) << id << " {" << place << "}";
  }
}

TEST(Words, EveryFindingHasThem) {
  const auto en = sections(fs::path(NONIO_WORDS) / "en" / "findings.toml");
  static const std::regex id(
      "\"((?:drift|reversal|repeatability|target|targets|reading|readings|direction|runs|plan|"
      "uncertainty|vdi|rotary)\\.[a-z-]+|eccentricity)\"");
  const std::string sources = all_sources();
  int found = 0;
  for (std::sregex_iterator it(sources.begin(), sources.end(), id), end; it != end; ++it, ++found)
    EXPECT_TRUE(en.count((*it)[1])) << (*it)[1];
  EXPECT_GE(found, 20);
}

}  // namespace
}  // namespace nonio::words_test
