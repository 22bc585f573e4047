// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "laboratory/assessment/targets.h"
#include "laboratory/statistics/series.h"
#include "laboratory/statistics/trend.h"
#include "laboratory/store/reader.h"

/// Which numbers of a machine's campaigns are points of one series, and what is known to have
/// happened between them.
namespace nonio::assessment {

/// One quantity of one axis, as far as its campaigns can be compared.
struct FollowedSeries {
  std::string axis, quantity, unit;
  std::vector<std::size_t> results;          ///< of the points: indices into StoredMachine::results
  std::vector<std::uint64_t> evaluations{};  ///< of the points
  std::vector<nonio::statistics::Point> stated{};  ///< the points as their campaigns have them
  std::vector<PointTargets> targets{};             ///< of the points, where all are known
  /// The stretch of the axis over which the points are compared; none: as they are.
  std::optional<nonio::statistics::Stretch> over{};
  std::vector<std::uint64_t> seeds{};  ///< of the series up to each of its points
  /// Numbers of the same quantity before this series began, which cannot be joined.
  struct Apart {
    std::size_t result = 0;
    std::string why;  ///< id of the word: span, place, across, model, period, radius,
                      ///< feed, other
  };
  std::vector<Apart> apart{};
  nonio::statistics::Series series;
  std::vector<std::string> said{};   ///< text of each declared event, as entered
  std::vector<std::string> kinds{};  ///< and its kind: crash, repair, ..., table, instrument
  bool ended = false;                ///< later campaigns measure it otherwise
  std::uint64_t run = 0;             ///< in which its last point came
  nonio::statistics::Trend trend{};
  /// Of each change of the trend: p, adjusted for all tests of its run.
  std::vector<double> p_adjusted{};
  /// Whether it is reported, and whether a mail reports it.
  std::vector<bool> significant{}, mailed{};
};

/// Largest deviations and the like of one axis: shown, and compared with limits.
struct ShownSeries {
  std::string axis, quantity, unit;
  std::vector<std::size_t> results;
  /// Of each campaign that compares the quantity with a limit, the result that decides: as left
  /// before as found; the worst of several lines of the axis. Empty if none does.
  std::vector<std::size_t> judged{};
  bool ended = false;  ///< later campaigns have it in another unit: the axis is another
};

/// All that is followed of a machine, by axis and quantity. `events`: those of this machine.
std::vector<FollowedSeries> followed_series(const store::StoredMachine& machine,
                                            const std::vector<config::Event>& events);

/// The series as it was when it had only its first `count` points: no later one moves it.
nonio::statistics::Series first_points(const FollowedSeries& series, std::size_t count);

/// The points as they are compared, each with its own u.
std::vector<nonio::statistics::Point> compared_points(const FollowedSeries& series);

std::vector<ShownSeries> shown_series(const store::StoredMachine& machine);

/// A machine with all that its history is made of.
struct AssessedMachine {
  store::MachineState state;
  store::StoredMachine stored;
  std::vector<config::Event> events;
  std::vector<FollowedSeries> followed;
  std::vector<ShownSeries> shown;
};

/// Events by machine, each list by day: stated under its name, an alias, or a serial number that no
/// other machine has and that is not the name of another machine. Looked up once for all machines.
class MachineEvents {
 public:
  MachineEvents(const std::vector<store::MachineState>& all, const store::StoredLogs& logs);
  const std::vector<config::Event>& of(const std::string& machine) const;
  /// Those that name no machine of which there is a campaign.
  const std::vector<config::Event>& of_none() const { return of_none_; }

 private:
  std::map<std::string, std::vector<config::Event>> by_machine_{};
  std::vector<config::Event> of_none_{};
};

}  // namespace nonio::assessment
