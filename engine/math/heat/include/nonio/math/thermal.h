// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "nonio/sdk/observations.h"

/// Thermal tests: displacement d against time t, d = 0 at the start.
///
///     range in a window     max d - min d over the readings with t in [a, a + w], ends included; the
///                           largest over all a for which the window is within the test
///     time constants        d(t) = d0 + sum_k c_k (1 - exp(-t/tau_k)), one or two
///     warm-up time          smallest t after which abs(sum_k c_k exp(-t/tau_k)) <= rest
///
/// Symbols: d, c_k in m; t, w, tau_k in s; rest: permitted distance from the final value, m.
/// Sources: ISO 230-3 (ranges over the test and in its first 60 min; text not available); the
/// largest range in any window: according to ASME B5.54, environmental tests (inferred); time
/// constants: a body that is heated evenly and cools by its surface (Newton's law of cooling).
/// Range: times ascending, all finite.
namespace nonio::math {

/// Readings of one sensor, in ascending order of time.
struct Track {
  std::vector<double> time;  ///< time of each reading, s
  std::vector<double> d;     ///< displacement at each time, m
  std::size_t size() const { return time.size(); }
};

struct RangeOf {
  double range = 0.0;
  std::size_t low = 0, high = 0;  ///< indices of the smallest and largest reading
  double from = 0.0, to = 0.0;    ///< start and end of the window, s
};

/// Returns the range of all readings; none for an empty track.
std::optional<RangeOf> whole_range(const Track&);
/// Returns the range of the readings up to w, s, after the first one; none if the test is shorter
/// than w.
std::optional<RangeOf> first_range(const Track&, double w);
/// Returns the largest range in any window of w, s; none if the test is shorter than w.
std::optional<RangeOf> largest_range(const Track&, double w);

/// Standard deviation of a reading from second differences, s^2 = sum (d_(i-1) - 2 d_i +
/// d_(i+1))^2/(6 (n - 2)): a displacement that is linear over three readings cancels. Uneven time
/// steps are taken into account.
struct ReadingNoise {
  double s = 0.0;
  double dof = 0.0;  ///< 18/35 (n - 2), for the variance of second differences; 0: too few
};
ReadingNoise reading_noise(const Track&);

/// Returns by how much, m, the range of `d` grows if noise of standard deviation s, m, is added to
/// it once more. The noise that `d` already contains has increased its range by up to 1/(sqrt 2 -
/// 1) times this result, because the extreme of many readings grows with their scatter. Equal input
/// gives an equal result.
double range_excess(std::span<const double> d, double s);

struct TimeConstants {
  enum class Answer {
    resolved,
    too_few,     ///< fewer than twelve readings, or intervals with readings
    none,        ///< the displacement is not exponential: c is not significant
    too_short,   ///< a time constant is above half of the test
    unresolved,  ///< the standard uncertainty of a time constant is above a quarter of its value
  };
  struct Part {
    double c = 0.0, tau = 0.0, u_c = 0.0, u_tau = 0.0;
  };
  Answer answer = Answer::too_few;
  /// One or two time constants, the longest first; also for answers other than `resolved`, but
  /// empty for too_few and for equal readings.
  std::vector<Part> parts;
  double d0 = 0.0;
  double s = 0.0;        ///< standard deviation of a mean over an interval, about the curve
  double dof = 0.0;      ///< effective degrees of freedom, reduced by correlation
  double largest = 0.0;  ///< longest time constant that this test can resolve, s
  /// Covariance matrix of d0, then c and ln tau of each part.
  std::vector<std::vector<double>> covariance;

  double at(double t) const;
  /// Returns the distance from the final value: sum c exp(-t/tau), m.
  double rest(double t) const;
  /// A time and its standard uncertainty, s. `settled` returns the time after which abs(rest)
  /// remains below `limit`, m; 0 if it is below from the start, without a time constant, or for a
  /// limit that is not above 0.
  struct Time {
    double t = 0.0, u = 0.0;
  };
  Time settled(double limit) const;
};

/// Fits time constants; times are relative to the first reading. The correlation of the noise is
/// estimated together with the curve (REML).
TimeConstants time_constants(const Track&);

/// Readings of an axis that moves in cycles: one target from one side, over the cycles.
struct Visits {
  double position = 0.0;  ///< position of the target, m
  int direction = 1;
  Track track;
};

/// Rows of a table sorted by time, each time once. Of several readings at one time, the first row
/// gives the position, and their deviations are averaged. Every row must have a time.
struct InTime {
  std::vector<std::size_t> rows;
  Track track;
};
InTime in_time(const Observations&, std::vector<std::size_t> rows);

/// Returns the readings of an axis that moves in cycles, for each target and side, ascending; times
/// are relative to the first reading. Targets that were read only once are omitted.
std::vector<Visits> visits_of(const Observations&);

/// Returns the growth over time, m/m: for each cycle that contains every target, the slope over the
/// targets of the change since the first cycle, at the mean time of the cycle. With two targets, it
/// is the difference of their changes divided by their distance. Empty if there is only one
/// position.
Track growth(const std::vector<Visits>&);
/// Returns the change of the reversal since the first cycle, m: mean over the targets of (+) minus
/// (-), for each cycle that contains every target. Empty if no target was read from both sides.
Track reversal_change(const std::vector<Visits>&);

}  // namespace nonio::math
