// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "nonio/sdk/observations.h"

/// Thermal tests: displacement d against time t, d = 0 at the start.
///
///     range in a window     max d - min d for t in [a, a + w], ends included, of the window within
///                           the test in which it is largest
///     time constants        d(t) = d0 + sum_k c_k (1 - exp(-t/tau_k)), one or two
///     warm-up time          smallest t after which abs(sum_k c_k exp(-t/tau_k)) <= rest
///
/// d, c_k, rest in m; t, w, tau_k in s. Sources: ISO 230-3 (ranges over the test and in its first
/// 60 min; text not available); ASME B5.54 (largest range in any window, inferred); Newton's law of
/// cooling (time constants).
namespace nonio::math {

/// Readings of one sensor in ascending order of time: times in s, displacements d in m.
struct Track {
  std::vector<double> time;
  std::vector<double> d;
  std::size_t size() const { return time.size(); }
};

struct RangeOf {
  double range = 0.0;
  std::size_t low = 0, high = 0;
  double from = 0.0, to = 0.0;
};

/// Returns nothing for an empty track.
std::optional<RangeOf> whole_range(const Track&);
/// Range of the readings in the first w, s; std::nullopt if the test is shorter than w.
std::optional<RangeOf> first_range(const Track&, double w);
/// Returns the largest range in any window of w, s; std::nullopt if the test is shorter than w.
std::optional<RangeOf> largest_range(const Track&, double w);

/// Standard deviation of a reading from second differences, s^2 = sum (d_(i-1) - 2 d_i +
/// d_(i+1))^2/(6 (n - 2)): a displacement that is linear over three readings cancels.
struct ReadingNoise {
  double s = 0.0;
  double dof = 0.0;  ///< 18/35 (n - 2), for the variance of second differences; 0: too few
};
ReadingNoise reading_noise(const Track&);

/// Growth of the range of `d`, m, if noise of standard deviation s, m, is added once more. The
/// noise in `d` has increased its range by up to 1/(sqrt 2 - 1) times this result.
double range_excess(std::span<const double> d, double s);

/// A change of the sensor between two readings that is faster than heat moves a machine.
struct Jump {
  std::size_t before = 0;  ///< index of the last reading before it
  double size = 0.0;       ///< m
};
/// None if there are more than five, which are how the machine moves. `moves_at_once` states whether
/// a speed or a load changes between two times, s, and moves the machine.
std::vector<Jump> jumps_of(const Track&,
                           const std::function<bool(double, double)>& moves_at_once = {});

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
  /// The longest time constant first; empty for too_few and for equal readings.
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
  /// `settled` returns the time, s, after which abs(rest) remains below `limit`, m; 0 without a
  /// time constant, or for a limit that is not above 0.
  struct Time {
    double t = 0.0, u = 0.0;
  };
  Time settled(double limit) const;
};

/// Times relative to the first reading. Noise correlation and curve are estimated together (REML).
TimeConstants time_constants(const Track&);

/// Readings of an axis that moves in cycles: one target from one side, over the cycles.
struct Visits {
  double position = 0.0;
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

/// Growth over time, m/m: for each cycle with every target, the slope over the targets of the
/// change since the first cycle, at the mean time of the cycle. Empty with one position.
Track growth(const std::vector<Visits>&);
/// Returns the change of the reversal since the first cycle, m: mean over the targets of (+) minus
/// (-), for each cycle that contains every target. Empty if no target was read from both sides.
Track reversal_change(const std::vector<Visits>&);

}  // namespace nonio::math
