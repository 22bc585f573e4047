// SPDX-License-Identifier: Apache-2.0
//
// Series of very many runs: each pass is compared with all others in a time that does not depend on how many these are.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "campaign/reading/plausibility/plausibility_strokes.h"
#include "campaign/reading/plausibility/running_mean.h"

namespace nonio::reading::long_series_test {
namespace {

constexpr double um = 1e-6;

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

double squares_of(const std::vector<double>& values) {
  const double mean = mean_of(values);
  double sum = 0.0;
  for (const double v : values) sum += (v - mean) * (v - mean);
  return sum;
}

/// Both directions of so many runs along nine targets.
class Series {
 public:
  explicit Series(std::size_t runs) {
    o.axes.push_back({"X", false, {}, {}});
    for (std::uint32_t run = 1; run <= runs; ++run) {
      for (int i = 0; i < 9; ++i) add(run, +1, i);
      for (int i = 8; i >= 0; --i) add(run, -1, i);
    }
  }

  /// The row of a reading.
  std::size_t row(std::uint32_t run, int direction, int target) const {
    const int place = direction > 0 ? target : 17 - target;
    return 18 * (static_cast<std::size_t>(run) - 1) + static_cast<std::size_t>(place);
  }

  Observations o;

 private:
  void add(std::uint32_t run, int direction, int i) {
    constexpr double pitch[] = {0, 7, -5, 9, 2, -8, 6, -3, 4};
    const double scatter = std::normal_distribution<double>(0.0, 0.3)(random_);
    const double value = pitch[i] + (direction < 0 ? -6.0 : 0.0) + scatter;
    o.run.push_back(run);
    o.axes.front().position.push_back(0.1 * i);
    o.axes.front().approach.push_back(static_cast<std::int8_t>(direction));
    o.deviation.push_back(std::round(1e3 * value) * 1e-3 * um);
  }

  std::mt19937 random_{20261128};
};

const Finding* found(const std::vector<Finding>& findings, const std::string& id) {
  for (const Finding& f : findings)
    if (f.id == id) return &f;
  return nullptr;
}

std::vector<Finding> findings_of(const Series& series) {
  std::vector<Finding> findings;
  implausible_passes(passes_of(series.o), series.o, true, findings);
  return findings;
}

TEST(RunningMean, without_a_value_it_is_the_mean_of_the_others) {
  std::mt19937 random(20261128);
  std::normal_distribution<double> noise;
  std::vector<double> values;
  RunningMean all;
  for (int i = 0; i < 1000; ++i) all.add(values.emplace_back(1e4 + noise(random)));
  for (std::size_t k = 0; k < values.size(); ++k) {
    std::vector<double> others = values;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    const RunningMean rest = all.without(values[k]);
    EXPECT_EQ(rest.count, 999.0);
    EXPECT_NEAR(rest.mean, mean_of(others), 1e-11);
    EXPECT_NEAR(rest.squares, squares_of(others), 1e-8);
  }
}

TEST(RunningMean, equal_values_have_no_scatter_when_another_one_is_taken_out) {
  RunningMean all;
  for (int i = 0; i < 9; ++i) all.add(0.1);
  all.add(0.7);
  EXPECT_EQ(all.without(0.7).squares, 0.0);
  RunningMean one;
  one.add(0.3);
  EXPECT_EQ(one.without(0.3).count, 0.0);
}

TEST(LongSeries, a_pass_that_is_one_row_off_is_found_among_16000) {
  Series series(8000);
  const Series right(8000);
  for (int i = 0; i < 8; ++i)
    series.o.deviation[series.row(4321, +1, i)] = right.o.deviation[series.row(4321, +1, i + 1)];
  std::vector<Finding> findings;
  shifted_rows(passes_of(series.o), Quantity::deviation, findings);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings.front().texts.front().second, "4321 +");
}

TEST(LongSeries, a_run_with_exchanged_directions_is_found_among_8000) {
  Series series(8000);
  for (int i = 0; i < 9; ++i)
    std::swap(series.o.deviation[series.row(777, +1, i)],
              series.o.deviation[series.row(777, -1, i)]);
  const auto findings = findings_of(series);
  const Finding* swapped = found(findings, "plausibility.directions-swapped");
  ASSERT_NE(swapped, nullptr);
  EXPECT_EQ(swapped->evidence.front().value, 777.0);
}

TEST(LongSeries, runs_of_another_machine_are_found) {
  Series series(8000);
  for (std::uint32_t run = 6001; run <= 8000; ++run)
    for (const int direction : {+1, -1})
      for (int i = 0; i < 9; ++i)
        series.o.deviation[series.row(run, direction, i)] += (i % 2 == 0 ? 5.0 : -5.0) * um;
  const auto findings = findings_of(series);
  EXPECT_NE(found(findings, "plausibility.two-curves"), nullptr);
}

TEST(LongSeries, a_pass_of_means_is_found) {
  Series series(2000);
  for (int i = 0; i < 9; ++i) {
    double sum = 0.0;
    for (std::uint32_t run = 1; run < 2000; ++run)
      sum += series.o.deviation[series.row(run, -1, i)];
    series.o.deviation[series.row(2000, -1, i)] = std::round(sum / 1999.0 / um * 1e3) * 1e-3 * um;
  }
  const auto findings = findings_of(series);
  const Finding* means = found(findings, "plausibility.pass-of-means");
  ASSERT_NE(means, nullptr);
  EXPECT_EQ(means->texts.front().second, "2000 -");
}

TEST(LongSeries, a_reading_that_is_far_off_is_found) {
  Series series(2000);
  series.o.deviation[series.row(1234, +1, 4)] = 0.09;
  const auto findings = findings_of(series);
  const Finding* far = found(findings, "plausibility.reading-far-off");
  ASSERT_NE(far, nullptr);
  EXPECT_EQ(far->evidence.front().value, 0.09);
}

TEST(LongSeries, without_a_mistake_it_has_no_finding) {
  const Series series(8000);
  const Passes passes = passes_of(series.o);
  std::vector<Finding> findings;
  implausible_passes(passes, series.o, true, findings);
  shifted_rows(passes, Quantity::deviation, findings);
  EXPECT_TRUE(findings.empty());
}

}  // namespace
}  // namespace nonio::reading::long_series_test
