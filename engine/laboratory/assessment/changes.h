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

/// Finds the changes of all machines of a site and decides which are significant.
namespace nonio::assessment {

/// Significance levels of a change: in the worklist, for p adjusted by Benjamini and Hochberg, and
/// in a mail, for p adjusted by Holm.
inline constexpr double significant_below = 0.05, mailed_below = 0.01;
/// Significance level of a step at a place where an event is stated.
inline constexpr double declared_below = 0.01;

/// Statistics that are estimated from all series of one quantity together.
struct OfQuantity {
  double excess = 1.0;  ///< factor by which campaigns scatter more than their u
  double spread = 0.0;  ///< standard deviation of slopes, per year, in the printed unit
};

/// Scatter and slope of one series, from which the statistics of the laboratory are estimated.
struct Lesson {
  std::string quantity;  ///< quantity and unit, separated by a space
  std::uint64_t points = 0;
  std::vector<double> ratios{};  ///< ratios of `statistics::Scatter`, of the points that have one
  std::optional<nonio::statistics::Slope> slope{};
};
/// Returns how many of the first evaluations are used for the statistics of the laboratory: all
/// below 10,000, otherwise their number rounded down to two digits, so that a new campaign rarely
/// changes the results of other machines.
std::uint64_t learned_from(std::uint64_t evaluations);
/// Estimates scatter and slope of a series from the points that the first `evaluations` contain.
Lesson lesson_of(const FollowedSeries& series, Fits& fits,
                 std::uint64_t evaluations = std::numeric_limits<std::uint64_t>::max());

/// Statistics by quantity and unit, for all machines of a site, rounded in coarse steps.
struct Learned {
  std::map<std::string, OfQuantity> of;
  /// significance level of a drift: `significant_below` divided by the number of series with three
  /// points or more, which is rounded up to two digits from 10,000 on
  double drift_below = 1.0;
};
Learned learn(const std::vector<const Lesson*>& lessons);

/// Parameters with which a series is fitted.
struct Manner {
  double excess = 1.0, spread = 0.0, drift_below = 0.0;
  bool operator==(const Manner&) const = default;
};
Manner manner_of(const std::string& quantity, const Learned& learned);
void fit(FollowedSeries& series, const Manner& manner, Fits& fits);

/// Tests of one series, which belong to the run of its last point.
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

/// p of a change, adjusted for all tests of its run by two procedures.
struct Adjusted {
  double news = 1.0;  ///< Benjamini and Hochberg: limits the share of false positives among the
                      ///< reported changes
  double any = 1.0;   ///< Holm: limits the probability that the run reports any false change
};

/// Returns the adjusted p of each change of each series. `asked`: number of tests by run.
std::vector<std::vector<Adjusted>> adjusted_by_run(
    const std::vector<const SeriesTests*>& tests,
    const std::map<std::uint64_t, std::uint64_t>& asked);

/// Whether a change is reported, whether it is too significant to be explained by the instrument,
/// and whether a mail reports it.
struct Verdict {
  bool significant = false, surely = false, mailed = false;
};
Verdict verdict_of(const SeriesTests::Of& test, const Adjusted& adjusted);
/// Stores the verdicts and the adjusted p in a fitted series.
void tell(FollowedSeries& series, const std::vector<Adjusted>& adjusted);
/// Fits the series again without steps that are not significant. One of a hundred level series has
/// such a step by chance, and it would change slope and forecast.
void drop_unstated(FollowedSeries& series, Fits& fits);
/// Tests the other quantities of an axis for a step where one quantity changed significantly.
void ask_others(AssessedMachine& machine, Fits& fits);

/// Estimates the statistics from the series of all machines, and sets the parameters of each
/// series.
std::map<std::string, OfQuantity> learn(std::vector<AssessedMachine>& machines, Fits& fits);

/// Fits the trends of all series and decides which of their changes are significant. A test belongs
/// to the run in which its series got its last point.
void find_changes(std::vector<AssessedMachine>& machines,
                  const std::map<std::uint64_t, std::uint64_t>& asked, Fits& fits,
                  const std::function<void()>& alive);

}  // namespace nonio::assessment
