// SPDX-License-Identifier: Apache-2.0
#include "laboratory/assessment/fits.h"

#include <gtest/gtest.h>

#include <sstream>

#include "made.h"

namespace nonio::test::fits_test {
namespace {

class WorklistFits : public ::testing::Test {
 protected:
  /// What a site says of itself, by what is kept.
  std::size_t run(std::uint64_t seed, std::size_t more = 0) {
    std::mt19937_64 random(seed);
    std::vector<assessment::AssessedMachine> machines;
    for (int k = 0; k < 6; ++k) {
      MadeMachine m("S-" + std::to_string(k));
      m.follow("X", "B_mean", around(random, 8, 0.1, 4, k == 2 ? -1.0 : 0.0), 0.1);
      if (k == 5 && more > 0) m.stored().results.back().value += 0.01;
      machines.push_back(m.assessed());
    }
    assessment::Fits fits = assessment::Fits::of(kept_);
    assessment::learn(machines, fits);
    assessment::find_changes(machines, {}, fits, not_asked);
    EXPECT_EQ(fits.is_new(), fits.kept() != kept_);
    kept_ = fits.kept();
    said_.str("");
    for (const auto& m : machines)
      for (const auto& s : m.followed) {
        said_ << static_cast<int>(s.trend.model) << ' ' << s.trend.chi2 << ' ' << s.trend.dof;
        for (const auto& c : s.trend.changes)
          said_ << ' ' << c.after << ' ' << c.size << ' ' << c.p;
        for (const auto& g : s.trend.segments)
          said_ << ' ' << g.from << ' ' << g.last << ' ' << g.slope;
        for (const double x : s.trend.covariance) said_ << ' ' << x;
        for (const bool significant : s.significant) said_ << (significant ? '+' : '-');
        said_ << s.trend.smallest_change.value_or(-1.0) << '\n';
      }
    return fits.computed();
  }

  std::string kept_;
  std::ostringstream said_;
};

TEST_F(WorklistFits, AreComputedOnceAndChangeNothing) {
  const std::size_t first = run(21);
  const std::string said = said_.str();
  EXPECT_GE(first, 12U);
  EXPECT_EQ(run(21), 0U);
  EXPECT_EQ(said_.str(), said);
  kept_.clear();
  EXPECT_EQ(run(21), first);
  EXPECT_EQ(said_.str(), said);
}

TEST_F(WorklistFits, OneNewCampaignIsOneNewTrend) {
  run(21);
  EXPECT_EQ(run(21, 1), 2U);  // its trend and its slope
}

TEST_F(WorklistFits, WhatIsNotRequestedIsNotKept) {
  run(21);
  const std::size_t size = kept_.size();
  run(22);
  EXPECT_LT(kept_.size(), 2 * size - 1000);
}

TEST_F(WorklistFits, WhatIsCutOffIsNone) {
  const std::size_t first = run(21);
  const std::string said = said_.str(), whole = kept_;
  for (const std::size_t size :
       {std::size_t{1}, std::size_t{70}, whole.size() / 2, whole.size() - 1}) {
    kept_ = whole.substr(0, size);
    EXPECT_EQ(run(21), first) << size;
    EXPECT_EQ(said_.str(), said);
  }
}

}  // namespace
}  // namespace nonio::test::fits_test
