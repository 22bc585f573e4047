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

/// Joins the results of a machine's campaigns to series, and declares the known events between
/// their points.
namespace nonio::assessment {

/// One quantity of one axis over the campaigns that can be compared.
struct FollowedSeries {
  std::string axis, quantity, unit;
  std::vector<std::size_t> results;          ///< index of each point into StoredMachine::results
  std::vector<std::uint64_t> evaluations{};  ///< number of each point's evaluation
  std::vector<nonio::statistics::Point> stated{};  ///< the points as their campaigns state them
  std::vector<PointTargets> targets{};             ///< targets of each point; empty unless known
                                                   ///< for all
  /// Stretch of the axis over which the points are compared; none: the points are used as stated.
  std::optional<nonio::statistics::Stretch> over{};
  std::vector<std::uint64_t> seeds{};  ///< seed of the series up to each point
  /// A result of the same quantity before this series began that cannot be joined to it.
  struct Apart {
    std::size_t result = 0;
    std::string why;  ///< why it cannot be joined, as the id of a text: span, place, across, model,
                      ///< period, radius, feed, other
  };
  std::vector<Apart> apart{};
  nonio::statistics::Series series;
  std::vector<std::string> said{};   ///< text of each declared event, as entered
  std::vector<std::string> kinds{};  ///< kind of each declared event: crash, repair, ..., table,
                                     ///< instrument
  bool ended = false;                ///< whether later campaigns measure the quantity in a way that
                                     ///< cannot be joined
  std::uint64_t run = 0;             ///< run that added the last point
  nonio::statistics::Trend trend{};
  /// p of each change of the trend, adjusted for all tests of its run.
  std::vector<double> p_adjusted{};
  /// Whether each change is reported, and whether a mail reports it.
  std::vector<bool> significant{}, mailed{};
};

/// A quantity of one axis that is shown and compared with limits, such as A, E or R.
struct ShownSeries {
  std::string axis, quantity, unit;
  std::vector<std::size_t> results;
  /// Deciding result of each campaign that compares the quantity with a limit: as left before as
  /// found, and the worst of several measurements of the axis.
  std::vector<std::size_t> judged{};
  bool ended = false;  ///< whether later campaigns use another unit, since the axis was changed
                       ///< between linear and rotary
};

/// Returns all followed series of a machine, by axis and quantity. `events`: those of this machine.
std::vector<FollowedSeries> followed_series(const store::StoredMachine& machine,
                                            const std::vector<config::Event>& events);

/// Returns the series as it was when it had only its first `count` points; later points have no
/// effect on it.
nonio::statistics::Series first_points(const FollowedSeries& series, std::size_t count);

/// Returns the points as compared over the common stretch, with the u of their campaigns instead of
/// the pooled u.
std::vector<nonio::statistics::Point> compared_points(const FollowedSeries& series);

std::vector<ShownSeries> shown_series(const store::StoredMachine& machine);

struct AssessedMachine {
  store::MachineState state;
  store::StoredMachine stored;
  std::vector<config::Event> events;
  std::vector<FollowedSeries> followed;
  std::vector<ShownSeries> shown;
};

/// Finds the events of each machine, in the order of `logs`. An event may name the machine, an
/// alias, or a serial number that belongs to no other machine and is not the name of another
/// machine.
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
