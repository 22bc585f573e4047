// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "laboratory/assessment/changes.h"
#include "laboratory/assessment/days.h"
#include "laboratory/assessment/series.h"

/// Machines as a store would give them, made without one.
namespace nonio::test {
namespace morning = assessment;
namespace history = store;
namespace config = config;

/// A machine whose campaigns come every half year from 2020-01-15 on.
class MadeMachine {
 public:
  explicit MadeMachine(std::string name, std::size_t campaigns = 8, std::uint64_t run = 1)
      : name_(std::move(name)) {
    for (std::size_t i = 0; i < campaigns; ++i) add_campaign(day(i), run);
  }

  static std::string day(std::size_t i) {
    return assessment::months_later("2020-01-15", 6 * static_cast<int>(i));
  }

  void add_campaign(const std::string& of_day, std::uint64_t run) {
    const std::string number = std::to_string(stored_.campaigns.size() + 1);
    stored_.campaigns.push_back({.id = name_ + "-" + number,
                                 .day = of_day,
                                 .customer = "C",
                                 .purpose = "periodic",
                                 .status = "ok",
                                 .instrument = {"O", "L", "1", "", "", ""},
                                 .evaluation = static_cast<std::int64_t>(stored_.campaigns.size()),
                                 .run = run});
    stored_.findings.emplace_back();
  }

  /// Of every campaign one value.
  void follow(const std::string& axis, const std::string& quantity,
              const std::vector<double>& values, double u,
              const std::string& conditions = R"({"from":0.0,"to":800.0})") {
    for (std::size_t i = 0; i < values.size(); ++i)
      stored_.results.push_back({.campaign = i,
                                 .measurement = axis,
                                 .axis = axis,
                                 .quantity = quantity,
                                 .unit = "um",
                                 .state = "as-found",
                                 .decision = {},
                                 .conditions = conditions,
                                 .followed = true,
                                 .value = values[i],
                                 .u_repeat = u});
  }

  /// A result with a limit of 8 um, U = 0.5 um, judged.
  void judge(const std::string& axis, const std::string& quantity,
             const std::vector<double>& values, const std::string& source = "") {
    for (std::size_t i = 0; i < values.size(); ++i)
      stored_.results.push_back({.campaign = i,
                                 .measurement = axis,
                                 .axis = axis,
                                 .quantity = quantity,
                                 .source = source,
                                 .unit = "um",
                                 .state = "as-found",
                                 .decision = values[i] > 8.5   ? "does not conform"
                                             : values[i] > 7.5 ? "cannot be decided"
                                                               : "conforms",
                                 .conditions = {},
                                 .value = values[i],
                                 .expanded = 0.5,
                                 .k = 2.0,
                                 .tolerance = 8.0});
  }

  store::StoredMachine& stored() { return stored_; }
  std::vector<config::Event>& events() { return events_; }

  std::vector<assessment::FollowedSeries> series() const {
    return assessment::followed_series(stored_, events_);
  }

  assessment::AssessedMachine assessed() const {
    assessment::AssessedMachine m{
        {{name_, {name_, "M", "V", name_}, stored_.campaigns.size()}, 1, {}},
        stored_,
        events_,
        {},
        {}};
    m.followed = assessment::followed_series(stored_, events_);
    m.shown = assessment::shown_series(stored_, events_);
    return m;
  }

 private:
  std::string name_;
  store::StoredMachine stored_;
  std::vector<config::Event> events_;
};

/// `n` values around 0, from `step` on larger by `size`.
inline std::vector<double> around(std::mt19937_64& random, std::size_t n, double sigma,
                                  std::size_t step = 1000, double size = 0.0) {
  std::normal_distribution<double> normal(0.0, sigma);
  std::vector<double> out;
  for (std::size_t i = 0; i < n; ++i) out.push_back(normal(random) + (i >= step ? size : 0.0));
  return out;
}

inline void not_asked() {}

/// Learned and judged, as in a run.
inline void judge_all(std::vector<assessment::AssessedMachine>& machines) {
  assessment::Fits fits;
  assessment::learn(machines, fits);
  assessment::find_changes(machines, {}, fits, not_asked);
}

}  // namespace nonio::test
