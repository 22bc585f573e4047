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

/// What changed, over all machines of a site.
namespace nonio::assessment {

/// Share of runs with a false alarm: in the worklist, and in a mail.
inline constexpr double significant_below = 0.05, mailed_below = 0.01;
/// A step at a place where something is known to have happened.
inline constexpr double declared_below = 0.01;

/// What all series of one quantity show together but none of them alone.
struct OfQuantity {
  double excess = 1.0;  ///< by which factor campaigns scatter more than their u
  double spread = 0.0;  ///< standard deviation of slopes, per year, in the printed unit
};

/// What is learned from one series.
struct Lesson {
  std::string quantity;  ///< and its unit
  std::uint64_t points = 0;
  std::vector<double> ratios{};  ///< see `kernel::Scatter`
  std::optional<nonio::statistics::Slope> slope{};
};
/// From how many of the first evaluations a laboratory is learned: from all, and of 10,000 and more
/// from the first ones, in two digits of their number. So a new campaign seldom moves what was
/// stated of all other machines.
std::uint64_t learned_from(std::uint64_t evaluations);
/// From the first `evaluations`: of the points before the first one that came later.
Lesson lesson_of(const FollowedSeries& series, Fits& fits,
                 std::uint64_t evaluations = std::numeric_limits<std::uint64_t>::max());

/// By quantity and unit, for all machines of a site, in coarse steps.
struct Learned {
  std::map<std::string, OfQuantity> of;
  double drift_below = 1.0;  ///< share of series
};
Learned learn(const std::vector<const Lesson*>& lessons);

/// How a series is fitted.
struct Manner {
  double excess = 1.0, spread = 0.0, drift_below = 0.0;
  bool operator==(const Manner&) const = default;
};
Manner manner_of(const std::string& quantity, const Learned& learned);
/// With the trend.
void fit(FollowedSeries& series, const Manner& manner, Fits& fits);

/// The tests of one series in the run of its last point.
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

/// p of a change, adjusted for all tests of its run.
struct Adjusted {
  double news = 1.0;  ///< Benjamini and Hochberg: few of the reported changes are false
  double any = 1.0;   ///< Holm: the probability that the run reports any false one
};

/// Of each change of each series. `asked`: number of tests of each run.
std::vector<std::vector<Adjusted>> adjusted_by_run(
    const std::vector<const SeriesTests*>& tests,
    const std::map<std::uint64_t, std::uint64_t>& asked);

/// Whether a change is reported, whether it is surely more than its instrument, and whether it is sure
/// enough for a mail.
struct Verdict {
  bool significant = false, surely = false, mailed = false;
};
Verdict verdict_of(const SeriesTests::Of& test, const Adjusted& adjusted);
/// Puts the verdicts into a series that was fitted.
void tell(FollowedSeries& series, const std::vector<Adjusted>& adjusted);
/// Removes steps that no test of the run confirmed: one of a hundred level series has one by
/// chance, and it would change slope and forecast.
void drop_unstated(FollowedSeries& series, Fits& fits);
/// A significant change in one quantity of an axis is tested in its other quantities at that place.
void ask_others(AssessedMachine& machine, Fits& fits);

/// All of the above for all machines of a site: `learn`, put into their series.
std::map<std::string, OfQuantity> learn(std::vector<AssessedMachine>& machines, Fits& fits);

/// Then fits the trends and decides which of their changes are significant. A test belongs to the
/// run in which its series got its last point.
void find_changes(std::vector<AssessedMachine>& machines,
                  const std::map<std::uint64_t, std::uint64_t>& asked, Fits& fits,
                  const std::function<void()>& alive);

}  // namespace nonio::assessment
