// SPDX-License-Identifier: Apache-2.0
#include "host/morning/fits.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "made.h"

namespace nonio::test::fits_test {
namespace {
namespace fs = std::filesystem;

class MorningFits : public ::testing::Test {
 protected:
  MorningFits() { fs::create_directories(out_ / ".nonio"); }
  ~MorningFits() override { fs::remove_all(out_); }

  /// What a site says of itself, by what is kept.
  std::size_t night(std::uint64_t seed, std::size_t more = 0) {
    std::mt19937_64 random(seed);
    std::vector<morning::AssessedMachine> machines;
    for (int k = 0; k < 6; ++k) {
      MadeMachine m("S-" + std::to_string(k));
      m.follow("X", "B_mean", around(random, 8, 0.1, 4, k == 2 ? -1.0 : 0.0), 0.1);
      if (k == 5 && more > 0) m.stored().results.back().value += 0.01;
      machines.push_back(m.assessed());
    }
    morning::Fits fits = morning::Fits::kept_in(out_);
    morning::learn(machines, fits);
    morning::find_changes(machines, {}, fits, not_asked);
    fits.keep_in(out_);
    said_.str("");
    for (const auto& m : machines)
      for (const auto& s : m.followed) {
        said_ << static_cast<int>(s.trend.model) << ' ' << s.trend.chi2 << ' ' << s.trend.dof;
        for (const auto& c : s.trend.changes)
          said_ << ' ' << c.after << ' ' << c.size << ' ' << c.p;
        for (const auto& g : s.trend.segments)
          said_ << ' ' << g.from << ' ' << g.last << ' ' << g.slope;
        for (const double x : s.trend.covariance) said_ << ' ' << x;
        for (const bool told : s.told) said_ << (told ? '+' : '-');
        said_ << s.trend.smallest_change.value_or(-1.0) << '\n';
      }
    return fits.computed();
  }

  const fs::path out_ = fs::temp_directory_path() / ("nonio-fits-" + std::to_string(::getpid()));
  std::ostringstream said_;
};

TEST_F(MorningFits, AreComputedOnceAndChangeNothing) {
  const std::size_t first = night(21);
  const std::string said = said_.str();
  EXPECT_GE(first, 12U);
  EXPECT_EQ(night(21), 0U);
  EXPECT_EQ(said_.str(), said);
  fs::remove(out_ / ".nonio" / "trends");
  EXPECT_EQ(night(21), first);
  EXPECT_EQ(said_.str(), said);
}

TEST_F(MorningFits, OneNewCampaignIsOneNewTrend) {
  night(21);
  EXPECT_EQ(night(21, 1), 2U);  // its trend and its slope
}

TEST_F(MorningFits, WhatIsDamagedIsNone) {
  const std::size_t first = night(21);
  const std::string said = said_.str();
  const fs::path path = out_ / ".nonio" / "trends";
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  for (const std::size_t at : {std::size_t{3}, std::size_t{100}, bytes.str().size() / 2}) {
    std::string spoiled = bytes.str();
    spoiled[at] = static_cast<char>(spoiled[at] ^ 1);
    std::ofstream(path, std::ios::binary) << spoiled;
    EXPECT_EQ(night(21), first) << at;
    EXPECT_EQ(said_.str(), said);
  }
  std::ofstream(path, std::ios::binary) << bytes.str().substr(0, bytes.str().size() / 2);
  EXPECT_EQ(night(21), first);
  EXPECT_EQ(said_.str(), said);
}

}  // namespace
}  // namespace nonio::test::fits_test
