// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "laboratory/assessment/fits.h"
#include "laboratory/assessment/series.h"

namespace nonio::assessment {

/// Significance levels: of changes in the worklist for p adjusted by Benjamini and Hochberg, of
/// changes in a mail for p adjusted by Holm.
inline constexpr double significant_below = 0.05, mailed_below = 0.01;
/// Significance level of a step where an event is recorded.
inline constexpr double declared_below = 0.01;

/// Statistics that all series of a quantity have in common.
struct OfQuantity {
  double excess = 1.0;  ///< factor from the stated u to the scatter of campaigns
  double spread = 0.0;  ///< standard deviation of the slopes, printed unit per year
  double p = 1.0;       ///< of the scatter, if the stated u were right (statistics::p_of_ratios)
};

/// Scatter and slope of one series, from which the statistics of the laboratory are estimated.
struct Lesson {
  std::string quantity;  ///< quantity and unit, separated by a space
  std::uint64_t points = 0;
  std::vector<double> ratios{};  ///< ratios of statistics::Scatter
  std::optional<nonio::statistics::Slope> slope{};
};
/// Returns the largest number of evaluations used for the statistics of the laboratory: below
/// 10,000 evaluations no limit, otherwise their number rounded down to two digits, so that a new
/// campaign rarely changes the results of other machines.
std::uint64_t learned_from(std::uint64_t evaluations);
/// Uses only the points of the first `evaluations` of the laboratory.
Lesson lesson_of(const FollowedSeries& series, Fits& fits,
                 std::uint64_t evaluations = std::numeric_limits<std::uint64_t>::max());

/// Statistics of all machines by quantity and unit, in coarse steps.
struct Learned {
  std::map<std::string, OfQuantity> of;
  /// Significance level of a drift: `significant_below` divided by the number of series with three
  /// or more points, which is rounded up to two digits if it is 10,000 or more.
  double drift_below = 1.0;
};
Learned learn(const std::vector<const Lesson*>& lessons);

struct Manner {
  double excess = 1.0, spread = 0.0, drift_below = 0.0;
  bool operator==(const Manner&) const = default;
};
Manner manner_of(const std::string& quantity, const Learned& learned);
void fit(FollowedSeries& series, const Manner& manner, Fits& fits);

struct SeriesTests {
  std::uint64_t run = 0;
  bool has_model = false;
  struct Of {
    double p = 1.0;
    bool declared = false, shows_instrument = false;
  };
  std::vector<Of> changes;
};
SeriesTests tests_of(const FollowedSeries& series);

/// p of a change, adjusted for all tests of the run.
struct Adjusted {
  /// Benjamini and Hochberg: controls the proportion of false changes among those reported.
  double news = 1.0;
  double any = 1.0;  ///< Holm: controls the probability of any false change in the run
};

/// Returns the adjusted p by series and change. `asked` is the number of tests by run.
std::vector<std::vector<Adjusted>> adjusted_by_run(
    const std::vector<const SeriesTests*>& tests,
    const std::map<std::uint64_t, std::uint64_t>& asked);

/// `surely` means too significant for a change of the instrument as the cause.
struct Verdict {
  bool significant = false, surely = false, mailed = false;
};
Verdict verdict_of(const SeriesTests::Of& test, const Adjusted& adjusted);
void tell(FollowedSeries& series, const std::vector<Adjusted>& adjusted);
/// Repeats the fit without steps that are not significant, because one of a hundred constant series
/// has such a step by chance, and it would change slope and forecast.
void drop_unstated(FollowedSeries& series, Fits& fits);
void ask_others(AssessedMachine& machine, Fits& fits);

/// Estimates the statistics from the series of all machines and sets the parameters of their fits.
std::map<std::string, OfQuantity> learn(std::vector<AssessedMachine>& machines, Fits& fits);

/// Fits the trends of all series and decides which changes are significant. A test belongs to the
/// run of the last point of its series.
void find_changes(std::vector<AssessedMachine>& machines,
                  const std::map<std::uint64_t, std::uint64_t>& asked, Fits& fits,
                  const std::function<void()>& alive);

}  // namespace nonio::assessment
