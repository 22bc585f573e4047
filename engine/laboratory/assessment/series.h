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

namespace nonio::assessment {

/// A quantity of an axis over the campaigns that can be compared.
struct FollowedSeries {
  std::string axis, quantity, unit;
  std::string line{};                        ///< measurement, if several lines are followed
  std::vector<std::size_t> results;          ///< index of each point into StoredMachine::results
  std::vector<std::uint64_t> evaluations{};  ///< number of the evaluation of each point
  std::vector<nonio::statistics::Point> stated{};  ///< points as stated by their campaigns
  /// Targets of each point; empty unless known for all points.
  std::vector<PointTargets> targets{};
  /// Stretch of the axis over which the points are compared; std::nullopt if the points are used as
  /// stated.
  std::optional<nonio::statistics::Stretch> over{};
  std::vector<std::uint64_t> seeds{};  ///< seed of the series up to each point
  /// An earlier result of the quantity that is not comparable with the series.
  struct Apart {
    std::size_t result = 0;
    /// Id of the reason: span, place, across, model, period, radius, feed or other.
    std::string why;
  };
  std::vector<Apart> apart{};
  nonio::statistics::Series series;
  std::vector<std::string> said{};  ///< text of each declared event, as entered
  /// Kind of each declared event, such as crash, repair, table or instrument.
  std::vector<std::string> kinds{};
  /// Whether later campaigns measure the quantity in a way that is not comparable.
  bool ended = false;
  std::uint64_t run = 0;  ///< run of the last point
  nonio::statistics::Trend trend{};
  /// p of each change, adjusted for all tests of its run.
  std::vector<double> p_adjusted{};
  /// Whether each change is reported in the worklist and in a mail.
  std::vector<bool> significant{}, mailed{};
};

/// A quantity of an axis that is compared with limits but has no trend, such as A, E or R.
struct ShownSeries {
  std::string axis, quantity, unit;
  std::vector<std::size_t> results;
  /// Deciding result of each campaign with a limit: as left before as found, and the worst of
  /// several measurements.
  std::vector<std::size_t> judged{};
  /// Comparable results with U, if the quantity has a limit, for its forecast: the worst of each
  /// campaign and state, with all of its U as its own, which overestimates U of a drift.
  std::optional<FollowedSeries> course{};
  /// Whether later campaigns use another unit, because the axis was changed between linear and
  /// rotary.
  bool ended = false;
};

/// Returns the followed series by axis and quantity. `events` are those of this machine.
std::vector<FollowedSeries> followed_series(const store::StoredMachine& machine,
                                            const std::vector<config::Event>& events);

/// Returns the series of the first `count` points, on which later points have no effect.
nonio::statistics::Series first_points(const FollowedSeries& series, std::size_t count);

/// Returns the points compared over the common stretch, with the u of their campaigns instead of
/// the pooled u.
std::vector<nonio::statistics::Point> compared_points(const FollowedSeries& series);

std::vector<ShownSeries> shown_series(const store::StoredMachine& machine,
                                      const std::vector<config::Event>& events);

struct AssessedMachine {
  store::MachineState state;
  store::StoredMachine stored;
  std::vector<config::Event> events;
  std::vector<FollowedSeries> followed;
  std::vector<ShownSeries> shown;
};

/// Finds machines by a present or former name or a serial number. Keeps references to both
/// arguments.
class MachineNames {
 public:
  MachineNames(const std::vector<store::MachineState>& all, const store::StoredLogs& logs);
  /// Returns the present name; null if no machine, or several machines, have this name.
  const std::string* of(const std::string& stated) const;

 private:
  const store::StoredLogs& logs_;
  std::map<std::string, const std::string*>
      named_{};  ///< null: a serial number of several machines
};

/// Finds the events of each machine, in the order of `logs`. An event names the machine, an alias,
/// or a serial number that is unique and not the name of another machine.
class MachineEvents {
 public:
  MachineEvents(const std::vector<store::MachineState>& all, const store::StoredLogs& logs);
  const std::vector<config::Event>& of(const std::string& machine) const;
  /// Returns events that name no machine with a campaign.
  const std::vector<config::Event>& of_none() const { return of_none_; }

 private:
  std::map<std::string, std::vector<config::Event>> by_machine_{};
  std::vector<config::Event> of_none_{};
};

}  // namespace nonio::assessment
