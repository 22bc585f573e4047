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
/// Symbols: d, c_k, rest in m; t, w, tau_k in s. Sources: ISO 230-3 (ranges over the test and in
/// its first 60 min; text not available); the largest range in any window: according to ASME B5.54,
/// environmental tests (inferred); time constants: a body that is heated evenly and cools by its
/// surface (Newton's law of cooling). Range: times ascending, all finite.
namespace nonio::math {

/// Readings of one sensor: the times ascend.
struct Track {
  std::vector<double> time;  ///< s
  std::vector<double> d;     ///< m
  std::size_t size() const { return time.size(); }
};

struct RangeOf {
  double range = 0.0;
  std::size_t low = 0, high = 0;  ///< readings that make it
  double from = 0.0, to = 0.0;    ///< of the window, s
};

/// Of all readings; none of an empty track.
std::optional<RangeOf> whole_range(const Track&);
/// Of those up to w after the first one; none if the test is shorter than w.
std::optional<RangeOf> first_range(const Track&, double w);
/// Largest in any window of w; none if the test is shorter than w.
std::optional<RangeOf> largest_range(const Track&, double w);

/// Scatter of a reading by second differences, s^2 = sum (d_(i-1) - 2 d_i + d_(i+1))^2/(6 (n - 2)):
/// what is smooth over three readings drops out. Uneven steps in time are allowed for.
struct ReadingNoise {
  double s = 0.0;
  double dof = 0.0;  ///< 18/35 (n - 2), of the variance of second differences; 0: too few
};
ReadingNoise reading_noise(const Track&);

/// By how much noise of s, added once more, makes a range larger. What is in it already has made it
/// larger by up to 1/(sqrt 2 - 1) of that: the largest of many grows as their scatter does. Always the
/// same for the same values.
double range_excess(std::span<const double> d, double s);

struct TimeConstants {
  enum class Answer {
    resolved,
    too_few,     ///< fewer than twelve readings
    none,        ///< the displacement does not level off by an exponential: c is not significant
    too_short,   ///< a time constant above half of the test
    unresolved,  ///< u of a time constant above a quarter of it
  };
  struct Part {
    double c = 0.0, tau = 0.0, u_c = 0.0, u_tau = 0.0;
  };
  Answer answer = Answer::too_few;
  std::vector<Part>
      parts;  ///< one or two, the longest first; also of an answer too_short, unresolved
  double d0 = 0.0;
  double s = 0.0;        ///< of a mean over an interval, about the curve
  double dof = 0.0;      ///< effective: neighbours are correlated
  double largest = 0.0;  ///< time constant that this test could have resolved, s
  /// Covariance of d0, then c and ln tau of each part.
  std::vector<std::vector<double>> covariance;

  double at(double t) const;
  /// Distance from the end: sum c exp(-t/tau).
  double rest(double t) const;
  /// When abs(rest) falls to `limit` and stays there, with its standard uncertainty; 0 if at once.
  struct Time {
    double t = 0.0, u = 0.0;
  };
  Time settled(double limit) const;
};

/// Time from the first reading on. The noise of neighbours is estimated with the curve (REML).
TimeConstants time_constants(const Track&);

/// An axis that is exercised: one target from one side, over its cycles.
struct Visits {
  double position = 0.0;  ///< m
  int direction = 1;
  Track track;
};

/// Rows of a table by time, each time once: of readings at one time the first row stands for where
/// the machine was, and the mean of their deviations counts. Every row has a time.
struct InTime {
  std::vector<std::size_t> rows;
  Track track;
};
InTime in_time(const Observations&, std::vector<std::size_t> rows);

/// What the readings of an exercised axis state about each target from each side, ascending; times
/// from the first reading on. Places that were read once only are left out.
std::vector<Visits> visits_of(const Observations&);

/// Slope of the change since the first cycle over the targets, against time: each cycle a reading, at
/// the mean of its times. With two targets: difference of the changes over their distance.
Track growth(const std::vector<Visits>&);
/// Mean over the targets of (+) less (-), less the same of the first cycle.
Track reversal_change(const std::vector<Visits>&);

}  // namespace nonio::math
