// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace nonio::math {

/// One pass in one direction: positions in the order of motion and their deviations, m or rad.
struct Pass {
  std::vector<double> position;
  std::vector<double> deviation;
};

/// Periodic error over a declared period p, of passes in one direction:
///
///     d(x) = a_q + b_q x + sum_(k=1,2) [C_k cos(2 pi k x/p) + S_k sin(2 pi k x/p)]   of pass q
///     folded(j) = mean of d(x) - a_q - b_q x over the readings whose phase is j/n, j = 0..n-1
///     range = max folded - min folded;  c_k = sqrt(C_k^2 + S_k^2), peak to valley 2 c_k
///
/// All passes are fitted together by least squares. The u of c_k results from white noise with a
/// slow part in the residuals, the u of the folded means from the scatter about them. Source: ASME
/// B5.54 and the annex of ISO 230-2 on dense runs, as interpreted in docs/dev/estimators.md. Every
/// pass must cover two periods in steps of at most p/20.
struct PeriodicError {
  enum class Answer { given, no_pass, too_short, too_coarse };
  struct Harmonic {
    double amplitude = 0.0;  ///< c_k, m or rad
    /// phase, 0..2 pi rad: the first maximum is at the position phase p/(2 pi k)
    double phase = 0.0;
    double u = 0.0;
  };
  Answer answer = Answer::no_pass;
  double periods = 0.0;
  double step = 0.0;  ///< widest step of all passes, m or rad
  std::array<Harmonic, 2> harmonics{};
  /// means over the readings of one phase, m or rad; phases without readings are omitted
  std::vector<double> folded;
  double range = 0.0;
  double s = 0.0;  ///< standard deviation of a reading about the folded mean; NaN with dof 0
  /// standard uncertainty of the folded mean with the fewest readings, m or rad
  double u_folded = 0.0;
  double dof = 0.0;
};
PeriodicError periodic_error(std::span<const Pass>, double period);

/// Single steps of one commanded size, in both directions. d is the deviation of adjacent readings
/// of one run and direction:
///
///     step_j = d_(j+1) - d_j, in the direction of motion   deviation of the step, m
///     first  = deviation of the step in which the direction reverses: from the last target of one
///              direction to the first target of the other, if they are one step apart
///
/// A step is not followed if the axis moves less than half of the commanded distance. Source:
/// laboratory method (docs/dev/estimators.md); the standards for small steps were not available.
struct SmallSteps {
  enum class Answer { given, too_few, several_sizes };
  struct One {
    double error = 0.0;  ///< deviation of the step, m: positive if it is too long
    bool first = false;  ///< whether the step is the first one after a reversal
    std::uint32_t run = 0;
    double position = 0.0;        ///< position at the end of the step, m
    int direction = 0;            ///< direction of motion, 1 or -1
    double from = 0.0, to = 0.0;  ///< deviations at the start and at the end of the step, m
  };
  Answer answer = Answer::too_few;
  double commanded = 0.0;  ///< commanded size of a step, m
  std::vector<One> steps;
  /// indices of the largest and smallest error among steps not directly after a reversal
  std::size_t largest = 0, least = 0;
  /// index of the smallest error among first steps after a reversal; steps.size() if there is none
  std::size_t least_first = 0;
  std::size_t not_followed = 0;  ///< without the steps directly after a reversal
  double s = 0.0;    ///< standard deviation about the mean of equal steps, m; NaN if dof is 0
  double dof = 0.0;  ///< degrees of freedom of s; 0 if no step was repeated
};
struct SteppedReading {
  double position = 0.0, deviation = 0.0;
  std::uint32_t run = 0;
  int direction = 0;
};
/// Readings may be in any order; those of one target, run and direction are averaged.
SmallSteps small_steps(std::span<const SteppedReading>);

}  // namespace nonio::math
