// SPDX-License-Identifier: Apache-2.0
// Spreadsheets with changed bytes: what is read is what was written, or the file is refused.
#include <Poco/Zip/Compress.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>
#include <string>

#include "archive.h"
#include "spreadsheet.h"

namespace nonio {
namespace {

using Random = std::mt19937_64;
using Members = std::vector<std::pair<std::string, std::string>>;

std::uint64_t chosen_seed() {
  const char* const given = std::getenv("NONIO_SEED");
  return given == nullptr ? std::random_device{}() : std::strtoull(given, nullptr, 10);
}

std::string bytes_of(const std::string& name) {
  std::ifstream file(std::string(SPREADSHEETS) + "/" + name, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

Expected<Observations> read(const std::string& bytes) {
  static const Measurement measurement{.id = "Z",
                                       .kind = "axis",
                                       .axis = "Z",
                                       .lateral = "",
                                       .file = "z",
                                       .reader = "",
                                       .from = {},
                                       .to = {}};
  static const Campaign campaign = [] {
    Campaign made;
    made.machine.axes = {{.name = "Z"}};
    made.measurements = {measurement};
    return made;
  }();
  static const Settings options;
  return spreadsheet::read(
      {.bytes = bytes, .campaign = campaign, .measurement = measurement, .options = options});
}

void change_bytes(std::string& bytes, Random& random) {
  const std::size_t times = std::size_t{1} << (random() % 6);
  for (std::size_t k = 0; k < times && !bytes.empty(); ++k) {
    const std::size_t at = random() % bytes.size();
    switch (random() % 4) {
      case 0:
        bytes.insert(at, 1, static_cast<char>(random()));
        break;
      case 1:
        bytes.erase(at, random() % 20);
        break;
      default:
        bytes[at] = static_cast<char>(random());
    }
  }
  if (random() % 8 == 0) bytes.resize(random() % (bytes.size() + 1));
}

Members members_of(const std::string& archive) {
  Members out;
  for (const char* name : {"mimetype", "content.xml", "[Content_Types].xml", "xl/workbook.xml",
                           "xl/_rels/workbook.xml.rels", "xl/sharedStrings.xml", "xl/styles.xml",
                           "xl/worksheets/sheet1.xml", "xl/worksheets/sheet2.xml"})
    if (auto found = spreadsheet::member(archive, name); found && *found)
      out.emplace_back(name, **found);
  return out;
}

std::string archive_of(const Members& members) {
  std::ostringstream out;
  Poco::Zip::Compress zip(out, true);
  for (const auto& [name, bytes] : members) {
    std::istringstream in(bytes);
    zip.addFile(in, Poco::DateTime(2026, 1, 1), Poco::Path(name, Poco::Path::PATH_UNIX),
                Poco::Zip::ZipCommon::CM_STORE);
  }
  zip.close();
  return out.str();
}

class Mutants : public testing::TestWithParam<const char*> {};

// The check sums of the archive find what was changed in a cell.
TEST_P(Mutants, OfTheFileAreReadAsItWasOrRefused) {
  const std::string whole = bytes_of(GetParam());
  const auto original = read(whole);
  ASSERT_TRUE(original) << original.error().message;
  ASSERT_EQ(original->size(), 130u);
  const std::uint64_t seed = chosen_seed();
  SCOPED_TRACE("seed " + std::to_string(seed) + " (NONIO_SEED)");
  Random random(seed);
  int refused = 0;
  for (int k = 0; k < 1000; ++k) {
    std::string bytes = whole;
    change_bytes(bytes, random);
    const auto got = read(bytes);
    if (!got) {
      ++refused;
      ASSERT_FALSE(got.error().message.empty());
      continue;
    }
    ASSERT_EQ(got->deviation, original->deviation) << k;
    ASSERT_EQ(got->axes.front().position, original->axes.front().position) << k;
    ASSERT_EQ(got->axes.front().approach, original->axes.front().approach) << k;
    ASSERT_EQ(got->run, original->run) << k;
  }
  EXPECT_GT(refused, 100);
}

// Any XML, packed with the right check sums.
TEST_P(Mutants, OfTheXmlAreReadOrRefused) {
  const Members members = members_of(bytes_of(GetParam()));
  const auto original = read(archive_of(members));
  ASSERT_TRUE(original) << original.error().message;
  const std::uint64_t seed = chosen_seed();
  SCOPED_TRACE("seed " + std::to_string(seed) + " (NONIO_SEED)");
  Random random(seed);
  for (int k = 0; k < 300; ++k) {
    Members changed = members;
    change_bytes(changed[random() % changed.size()].second, random);
    const auto got = read(archive_of(changed));
    if (!got) {
      ASSERT_FALSE(got.error().message.empty());
      continue;
    }
    for (const double deviation : got->deviation) ASSERT_TRUE(std::isfinite(deviation));
    ASSERT_EQ(got->run.size(), got->size());
  }
}

// One changed byte makes the last record one of Zip64, whose length would be that of 10 PB.
TEST_P(Mutants, WithAnImpossibleLengthAreRefused) {
  std::string bytes = bytes_of(GetParam());
  const std::size_t end = bytes.rfind("PK\5\6");
  ASSERT_NE(end, std::string::npos);
  bytes[end + 2] = 6;
  EXPECT_FALSE(read(bytes));
}

INSTANTIATE_TEST_SUITE_P(Spreadsheets, Mutants,
                         testing::Values("openpyxl.xlsx", "libreoffice.xlsx", "libreoffice.ods"));

}  // namespace
}  // namespace nonio
