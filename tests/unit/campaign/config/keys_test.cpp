// SPDX-License-Identifier: Apache-2.0
#include "campaign/config/keys.h"

#include <gtest/gtest.h>

#include <cctype>
#include <functional>
#include <set>
#include <stdexcept>

#include "campaign/config/manifest.h"
#include "campaign/config/toml_reader.h"
#include "certificates/users.h"
#include "simulation/simulate_spec.h"

namespace nonio::keys_test {
namespace {

using Holds = config::Key::Holds;

constexpr std::string_view turning[] = {"rotary"};
constexpr config::Choice kinds[] = {{"linear"}, {"rotary"}};
constexpr config::Key some_keys[] = {
    {"kind", Holds::text, "", kinds},
    {"teeth", Holds::whole, "", config::declared::only({"kind", turning})},
};
constexpr config::Key some{"some.toml", Holds::table, "", some_keys};

enum class Size { small, large };
struct Part {
  std::string name;
  double length = 1.0;
  std::optional<double> mass{};
  Size size = Size::small;
  std::uint64_t line = 0;
};
struct Whole {
  std::vector<Part> parts;
  std::map<std::string, Part> named;
  std::optional<Part> spare{};
  std::optional<std::pair<double, double>> ends{};
  std::vector<std::string> words;
};
void check_part(config::TableReader& reader, Part& part, Whole&) {
  part.line = reader.line();
  if (part.name == "none") reader.error("name", "expected a part");
}

namespace declared {
using namespace config::declared;
constexpr config::Choice sizes[] = {choice(Size::large, "large"), choice(Size::small, "small")};
constexpr config::Key part_keys[] = {
    {"name", into<&Part::name>, "", required},
    {"length_mm", into<&Part::length>, "", config::declared::Unit{"mm", 1e-3},
     from(0.0, "expected from 0")},
    {"mass", into<&Part::mass>, ""},
    {"size", into<&Part::size>, "", sizes},
};
constexpr config::Key whole_keys[] = {
    {"part", checked<check_part, &Whole::parts>, "", part_keys},
    {"named", nested<&Whole::named>, "", part_keys},
    {"spare", nested<&Whole::spare>, "", part_keys},
    {"ends", into<&Whole::ends>, "", config::declared::Unit{"mm", 1e-3}},
    {"words", into<&Whole::words>, ""},
    {"note", text, "Not filled, and checked."},
};
constexpr config::Key whole_file{"whole.toml", file<Whole>, "", whole_keys};
}  // namespace declared

/// What filling a struct by these keys reports.
std::string filled(const std::string& text, Whole& whole) {
  const std::string name = "whole.toml";
  const auto root = config::parse_toml(text, name);
  if (!root) return root.error().message;
  std::vector<Error> errors;
  config::TableReader reader(*root, declared::whole_file, name, errors);
  reader.fill(whole);
  reader.finish();
  std::string all;
  for (const Error& e : errors) all += std::to_string(e.line) + ": " + e.message + "\n";
  return all;
}

/// What reading a text with these keys says; "threw: ..." if the reader holds it for a mistake of
/// the program.
std::string read(const std::string& text, const std::function<void(config::TableReader&)>& how) {
  const auto root = config::parse_toml(text, "some.toml");
  if (!root) return root.error().message;
  const std::string file = "some.toml";
  std::vector<Error> errors;
  config::TableReader reader(*root, some, file, errors);
  try {
    how(reader);
    reader.finish();
  } catch (const std::logic_error& e) {
    return std::string("threw: ") + e.what();
  }
  std::string all;
  for (const Error& e : errors) all += std::to_string(e.line) + ": " + e.message + "\n";
  return all;
}

void every_key(const config::Key& table, const std::string& place,
               const std::function<void(const config::Key&, const std::string&)>& look) {
  for (const config::Key& key : table.keys) {
    const std::string here = place + "." + std::string(key.name);
    look(key, here);
    every_key(key, here, look);
  }
}

}  // namespace

void kind(config::TableReader& r) { config::value_of<std::string>(r, some_keys[0]); }
void teeth(config::TableReader& r) { config::value_of<int>(r, some_keys[1]); }

TEST(Keys, WhatIsDeclaredIsRead) {
  const auto both = [](config::TableReader& r) {
    kind(r);
    teeth(r);
  };
  EXPECT_EQ(read("kind = \"linear\"", kind), "");
  EXPECT_EQ(read("kind = \"rotary\"\nteeth = 3", both), "");
  EXPECT_EQ(read("", [](config::TableReader&) {}),
            "threw: some.toml (kind): declared and not read");
  EXPECT_EQ(read("kind = \"rotary\"", kind), "threw: some.toml (teeth): declared and not read");
}

TEST(Keys, KnownOnlyUnderACondition) {
  EXPECT_EQ(read("kind = \"linear\"\nteeth = 3", kind), "2: unknown key teeth\n");
  EXPECT_EQ(read("teeth = 3", kind), "1: unknown key teeth\n");
  const auto settled = [](config::TableReader& r) {
    kind(r);
    r.settle("kind", "rotary");
    teeth(r);
  };
  EXPECT_EQ(read("teeth = 3", settled), "");
}

TEST(Keys, FillTheirMembers) {
  Whole whole;
  EXPECT_EQ(filled("ends = [1, 2]\nwords = [\"a\"]\nnote = \"n\"\n[[part]]\nname = \"p\"\n"
                   "length_mm = 2\nsize = \"large\"\n[[part]]\nname = \"q\"\nmass = 3\n"
                   "[named.x]\nname = \"r\"\n[spare]\nname = \"s\"\n",
                   whole),
            "");
  ASSERT_EQ(whole.parts.size(), 2U);
  EXPECT_EQ(whole.parts[0].name, "p");
  EXPECT_EQ(whole.parts[0].length, 2e-3);
  EXPECT_EQ(whole.parts[0].size, Size::large);
  EXPECT_FALSE(whole.parts[0].mass);
  EXPECT_EQ(whole.parts[0].line, 4U);
  EXPECT_EQ(whole.parts[1].mass, 3.0);
  EXPECT_EQ(whole.parts[1].length, 1.0) << "what is absent leaves the default";
  EXPECT_EQ(whole.parts[1].size, Size::small);
  EXPECT_EQ(whole.named.at("x").name, "r");
  ASSERT_TRUE(whole.spare);
  EXPECT_EQ(whole.spare->name, "s");
  EXPECT_EQ(whole.ends, std::pair(1e-3, 2e-3));
  EXPECT_EQ(whole.words, std::vector<std::string>{"a"});
}

TEST(Keys, FillingReportsWhatIsWrong) {
  Whole whole;
  EXPECT_EQ(filled("note = 1\n[[part]]\nname = \"none\"\nsize = \"larg\"\nlength_mm = -1\n"
                   "[spare]\nnames = \"s\"\n",
                   whole),
            "5: part.length_mm: expected from 0; found -1\n"
            "4: part.size: expected one of large, small; found \"larg\" (nearest: \"large\")\n"
            "3: part.name: expected a part\n"
            "6: spare.name is missing\n"
            "7: unknown key spare.names (nearest: \"name\")\n"
            "1: note: expected a text in quotes, found a whole number\n");
  EXPECT_FALSE(filled("spare = 1", whole).empty());
}

TEST(Keys, OfAnotherStructAreRefused) {
  const auto wrong = [] {
    return config::Key("whole.toml", config::declared::file<Part>, "", declared::whole_keys);
  };
  EXPECT_THROW(wrong(), std::logic_error);
  std::vector<Error> errors;
  const std::string file;
  const toml::table empty;
  config::TableReader reader(empty, declared::whole_file, file, errors);
  Part part;
  EXPECT_THROW(reader.fill(part), std::logic_error);
}

TEST(Keys, DeclarationsAreSound) {
  std::size_t seen = 0;
  const auto look = [&](const config::Key& key, const std::string& place) {
    ++seen;
    ASSERT_FALSE(key.help.empty()) << place;
    EXPECT_TRUE(std::isupper(static_cast<unsigned char>(key.help.front()))) << place;
    const bool restricted = key.least || key.most || key.longest_list != 0 || key.distinct ||
                            key.holds == Holds::span || key.text.longest != 0 ||
                            !key.text.letters.empty() || !key.text.begins.empty();
    EXPECT_EQ(restricted, !key.wanted.empty()) << place << ": a rule needs its words";
    EXPECT_EQ(
        key.holds == Holds::table || key.holds == Holds::tables || key.holds == Holds::named_tables,
        !key.keys.empty())
        << place;
    std::set<std::string_view> names;
    for (const config::Key& inner : key.keys)
      EXPECT_TRUE(names.insert(inner.name).second) << place << "." << inner.name;
    for (const config::Key& inner : key.keys)
      for (const config::When* when : {&inner.only, &inner.needed})
        EXPECT_TRUE(when->key.empty() || when->key == config::cycle_axis ||
                    names.contains(when->key))
            << place << "." << inner.name;
    // A unit is a part of the name, unless it depends on something else or needs no telling.
    const bool has_suffix =
        key.unit == "um" || key.unit == "arcsec" || key.unit == "K" || key.unit == "MB";
    EXPECT_TRUE(!has_suffix || key.name.find(key.unit) != std::string_view::npos) << place;
  };
  for (const config::Key* file :
       {&config::campaign_file(), &config::site_file(), &config::machine_file(),
        &certificates::users_file(), &simulation::specification_file()})
    every_key(*file, std::string(file->name), look);
  EXPECT_GT(seen, 120U);
}

TEST(Keys, DefaultsAreThoseOfAnEmptyFile) {
  const auto site = config::parse_site("[limits]\n[certificate]\n", "site.toml");
  ASSERT_TRUE(site);
  const config::Signing signing;
  const auto otherwise = [](const config::Key& file, const char* table, const char* key) {
    return std::string(config::find_key(config::find_key(file.keys, table)->keys, key)->otherwise);
  };
  EXPECT_EQ(std::stod(otherwise(config::site_file(), "limits", "seconds")), site->limits.seconds);
  EXPECT_EQ(std::stod(otherwise(config::site_file(), "limits", "memory_MB")),
            site->limits.memory_MB);
  EXPECT_EQ(std::stod(otherwise(config::site_file(), "limits", "disk_seconds")),
            site->limits.disk_seconds);
  EXPECT_EQ(otherwise(config::site_file(), "certificate", "numbering"), site->numbering.pattern);
  EXPECT_EQ(otherwise(config::site_file(), "certificate", "register"),
            site->numbering.register_file);
  EXPECT_EQ(std::stoi(otherwise(config::site_file(), "signing", "time_stamp_seconds")),
            signing.time_stamp_seconds);
  EXPECT_EQ(otherwise(config::site_file(), "signing", "time_stamp_missing") == "fail",
            signing.time_stamp_required);
  EXPECT_EQ(otherwise(config::campaign_file(), "model", "compensate") == "model",
            Campaign().compensate_model);
}

TEST(Keys, RulesOfTexts) {
  EXPECT_TRUE(config::obeys("a-1_b.c", config::campaign_id_rule));
  for (const char* bad : {"A", ".a", "a/b", "summary.json", "a b", "\xC3\xA8"})
    EXPECT_FALSE(config::obeys(bad, config::campaign_id_rule)) << bad;
  EXPECT_TRUE(config::obeys(std::string(100, 'a'), config::campaign_id_rule));
  EXPECT_FALSE(config::obeys(std::string(101, 'a'), config::campaign_id_rule));
  EXPECT_TRUE(config::obeys("b-c", {.letters = "a-c-"}));
  EXPECT_FALSE(config::obeys("https://x", {.begins = "http://"}));
  EXPECT_FALSE(config::obeys("a\\b", {.not_letters = "/\\"}));
}

}  // namespace nonio::keys_test
