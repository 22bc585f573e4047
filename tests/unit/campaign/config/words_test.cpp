// SPDX-License-Identifier: Apache-2.0
//
// Each language has the same files of words with the same keys, and each text the same places.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <regex>
#include <set>
#include <sstream>

#include "campaign/config/manifest.h"
#include "campaign/config/plain_texts.h"

namespace nonio::words_test {
namespace {

namespace fs = std::filesystem;

std::map<std::string, Settings> files_of(const std::string& language) {
  std::map<std::string, Settings> out;
  for (const auto& entry : fs::directory_iterator(fs::path(NONIO_WORDS) / language)) {
    std::ostringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    auto settings = config::parse_settings(text.str(), entry.path().string());
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
  for (const char* language : {"de", "it"}) ASSERT_TRUE(languages.count(language)) << language;
  for (const std::string& language : languages) {
    const auto other = files_of(language);
    // English, Italian and German say everything; the others what a certificate needs, and what
    // holds it up.
    const bool whole = language == "en" || language == "it" || language == "de";
    ASSERT_EQ(other.size(), whole ? english.size() : 4) << language;
    for (const auto& [file, words] : english) {
      if (!whole && file != "certificate.toml" && file != "results.toml" &&
          file != "plausibility.toml" && file != "positioning.toml")
        continue;
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

// A sentence that is the English one was copied and not translated.
TEST(WordFiles, GermanAndItalianSentencesAreTranslated) {
  static const std::regex place("\\{[^}]*\\}"), three_words("[a-z]+ [a-z]+ [a-z]+");
  const auto english = files_of("en");
  std::size_t count = 0;
  for (const char* language : {"de", "it"}) {
    const auto other = files_of(language);
    for (const auto& [file, words] : english)
      for (const auto& [key, value] : words.values) {
        const std::string text = words.text(key);
        if (!std::regex_search(std::regex_replace(text, place, ""), three_words)) continue;
        ++count;
        EXPECT_NE(other.at(file).text(key), text) << language << "/" << file << " " << key;
      }
  }
  EXPECT_GE(count, 1000U);
}

/// The sources of everything that speaks.
std::string sources() {
  std::ostringstream text;
  for (const char* folder : {"plugins", "engine", "reports"})
    for (const auto& entry :
         fs::recursive_directory_iterator(fs::path(NONIO_WORDS) / ".." / ".." / folder))
      if (entry.path().extension() == ".cpp" || entry.path().extension() == ".h")
        text << std::ifstream(entry.path()).rdbuf();
  return text.str();
}

/// The texts between quotes in a source, line by line.
std::set<std::string> quoted(const std::string& source) {
  std::set<std::string> out;
  bool inside = false;
  std::string text;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const char c = source[i];
    const bool character = !inside && c == '\'' && source.substr(i, 3) == "'\"'";
    if (character) {
      i += 2;
    } else if (c == '\n') {
      inside = false;
    } else if (c == '"') {
      if (inside) out.insert(text);
      inside = !inside;
      text.clear();
    } else if (inside) {
      text += c;
      if (c == '\\' && i + 1 < source.size()) text += source[++i];
    }
  }
  return out;
}

/// Whole, or put together: at a point or a dash, with a unit at its end, or "place.A x B".
bool said(const std::set<std::string>& quotes, const std::string& id) {
  if (quotes.count(id)) return true;
  for (std::size_t k = 1; k < id.size(); ++k) {
    const char before = id[k - 1], behind = id[k];
    const bool seam =
        before == '.' || before == '-' || behind == '.' || behind == '-' || behind == '_';
    if (seam && quotes.count(id.substr(k)) && said(quotes, id.substr(0, k))) return true;
  }
  const std::size_t x = id.find(" x ");
  return x != std::string::npos && quotes.count(" x ") && said(quotes, id.substr(0, x)) &&
         quotes.count(id.substr(x + 3));
}

// A text that no source uses is a leftover; a placeholder that is never filled would be printed.
TEST(WordFiles, EveryFindingIsSaidAndFilled) {
  const auto quotes = quoted(sources());
  std::size_t count = 0;
  for (const auto& [file, words] : files_of("en"))
    for (const auto& [key, value] : words.values) {
      if (!key.starts_with("finding.") && !key.starts_with("note.")) continue;
      ++count;
      const std::string id =
          key.starts_with("note.") ? key.substr(5) : key.substr(8, key.find_last_of('.') - 8);
      EXPECT_TRUE(said(quotes, id)) << file << ": no source gives " << id;
      for (const std::string& place : places(words.text(key))) {
        const bool example = place.find(' ') != std::string::npos;  // of a manifest
        static const std::regex name("[^{}%\xC2\xB1]+");  // {name}, {name\u00b1U}, {name%}
        for (std::sregex_iterator it(place.begin(), place.end(), name), end; it != end; ++it)
          EXPECT_TRUE(example || said(quotes, it->str()))
              << file << ": no source fills " << place << " of " << id;
      }
    }
  EXPECT_GE(count, 300U);
}

// A finding without words would show its bare id.
TEST(WordFiles, EverySaidFindingHasThem) {
  std::set<std::string> known, families, other;
  for (const auto& [file, words] : files_of("en"))
    for (const auto& [key, value] : words.values) {
      const bool finding = key.starts_with("finding.");
      if (finding) known.insert(key.substr(8, key.find_last_of('.') - 8));
      if (key.starts_with("note.")) known.insert(key.substr(5));
      other.insert(key);
    }
  for (const std::string& id : known)
    if (id.find('.') != std::string::npos) families.insert(id.substr(0, id.find('.')));
  static const std::regex id_like("[a-z-]+\\.[a-z-]+");
  std::size_t count = 0;
  for (const std::string& quote : quoted(sources())) {
    if (!std::regex_match(quote, id_like) || !families.count(quote.substr(0, quote.find('.'))))
      continue;
    const bool file_name =
        quote.ends_with(".h") || quote.ends_with(".json") || quote.ends_with(".csv");
    const bool manifest_key = quote == "model.effects";
    // Checks are named on the terminal only; [certificate] has keys, and gives files.
    const bool check_of_verify =
        quote.starts_with("signature.") || quote.starts_with("certificate.");
    const auto part_of = known.lower_bound(quote);  // put together with what follows it
    ++count;
    EXPECT_TRUE(file_name || manifest_key || check_of_verify || known.count(quote) ||
                other.count(quote) || other.count("terminal." + quote) ||
                (part_of != known.end() && part_of->starts_with(quote)))
        << quote << " has no words";
  }
  EXPECT_GE(count, 150U);
}

// A plugin may bring several effects.
TEST(WordFiles, EveryEffectHasItsCard) {
  std::set<std::string> cards, said_by_none;
  for (const auto& [file, words] : files_of("en"))
    for (const auto& [key, value] : words.values)
      if (key.starts_with("effect.")) {
        const std::string name = key.substr(7, key.find('.', 7) - 7);
        if (!cards.insert(name).second) continue;
        for (const char* part : {"title", "is", "size", "appearance", "similar", "remedy"})
          EXPECT_TRUE(words.has("effect." + name + "." + part)) << name << " " << part;
      }
  said_by_none = cards;
  const fs::path root = fs::path(NONIO_WORDS) / ".." / ".." / "plugins" / "effects";
  for (const auto& folder : fs::directory_iterator(root)) {
    if (!fs::exists(folder.path() / "README.md")) continue;
    bool any = false;
    for (const auto& entry : fs::directory_iterator(folder.path())) {
      std::ostringstream text;
      text << std::ifstream(entry.path()).rdbuf();
      for (const std::string& quote : quoted(text.str())) {
        any = any || cards.count(quote) != 0;
        said_by_none.erase(quote);
      }
    }
    EXPECT_TRUE(any) << folder.path() << " has no card in effects.toml";
  }
  for (const std::string& name : said_by_none) ADD_FAILURE() << "no effect " << name;
}

// A remark without words would appear in English in every language.
TEST(WordFiles, EveryRemarkHasThem) {
  std::string sources;
  const fs::path root = fs::path(NONIO_WORDS) / ".." / "..";
  for (const char* folder : {"plugins", "engine"})
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      if (entry.path().extension() != ".cpp") continue;
      std::ostringstream text;
      text << std::ifstream(entry.path()).rdbuf();
      sources += text.str();
    }
  std::set<std::string> known;
  for (const auto& [file, words] : files_of("en"))
    for (const auto& [key, value] : words.values)
      if (key.starts_with("note.")) known.insert(key.substr(5));
  static const std::regex said(
      "(?:notes\\.push_back\\(\\{|remark\\(job, |say\\((?=\"table))\"([^\"]+)\"");
  std::size_t count = 0;
  for (std::sregex_iterator it(sources.begin(), sources.end(), said), end; it != end; ++it, ++count)
    EXPECT_TRUE(known.count((*it)[1])) << (*it)[1];
  EXPECT_GE(count, 15U);
}

/// A number among the texts sends them to the parser of all TOML.
Expected<Settings> parsed(const std::string& text) {
  auto settings = config::parse_settings("a-number = 1\n" + text, "words.toml");
  if (settings) settings->values.erase("a-number");
  return settings;
}

TEST(WordFiles, AreReadDirectlyAsTheParserReadsThem) {
  std::vector<std::string> texts;
  for (const auto& entry : fs::recursive_directory_iterator(NONIO_WORDS)) {
    if (!entry.is_regular_file()) continue;
    std::ostringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    texts.push_back(text.str());
    const auto plain = config::plain_texts(text.str());
    ASSERT_TRUE(plain) << entry.path();
    const auto other = parsed(text.str());
    ASSERT_TRUE(other) << entry.path();
    EXPECT_EQ(plain->values, other->values) << entry.path();
  }
  ASSERT_GT(texts.size(), 50U);
}

TEST(WordFiles, WhatIsReadDirectlyIsNeverWhatTheParserRefuses) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const std::vector<std::string> headers = {"[a]", "[a.b]", "[b]", "[a.\"b.c\"]", "[[a]]"},
                                 keys = {"a", "b", "c", "\"a.b\"", "\"\"", "a.c", "a.b", "b.c.a"},
                                 values = {"\"x\"", "\"\\\"\"", "\"\\\\\"", "\"\\n\"", "'x'", "1"},
                                 pieces = {"\"", "=",      "\n", " ", "# t\n", "\xC3\xA4", "\xFF",
                                           "\t", "\"\"\"", ".",  "[", "]",     "\r\n",     "a"};
  const auto one_of = [&](const auto& list) { return list[random() % list.size()]; };
  std::size_t read = 0;
  for (int round = 0; round < 20000; ++round) {
    std::string text;
    for (auto lines = random() % 7; lines > 0; --lines)
      text += (random() % 3 == 0 ? one_of(headers) : one_of(keys) + " = " + one_of(values)) + "\n";
    for (auto edits = random() % 3; edits > 1; --edits)
      text.insert(random() % (text.size() + 1), one_of(pieces));
    const auto plain = config::plain_texts(text);
    if (!plain) continue;
    ++read;
    const auto other = parsed(text);
    ASSERT_TRUE(other) << text << other.error().message;
    ASSERT_EQ(plain->values, other->values) << text;
  }
  EXPECT_GT(read, 1000U);
}

}  // namespace
}  // namespace nonio::words_test
