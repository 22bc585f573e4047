// SPDX-License-Identifier: Apache-2.0
//
// The shop floor of the coverage bench: readings come about from physical causes, one after the
// other in time, as they would on a machine. Nothing of the engine's budget is used: what hangs
// together does so because one thing causes it (one laser, one material, one sensor, one
// temperature).
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "nonio/sdk/campaign.h"

namespace nonio::coverage {

inline constexpr double um = 1e-6, urad = 1e-6;

/// Temperature of the shop while the lines are measured, within what the manifest states.
enum class Warmth {
  steady,         ///< at the limit all the time
  day_and_night,  ///< at either limit, line by line
  anywhere        ///< anywhere within it: milder than what is stated
};
/// Sensors of the machine's temperature.
enum class Sensors {
  stay,  ///< one error for the whole campaign: the calibration of a sensor that is not moved
  anew   ///< one for each line: where and how it was laid
};
/// Drift during a line: random walk, or a range that a slope or a warming-up takes.
enum class Course { walk, linear, settling };

/// What the manifest states, and what then happens.
struct Scenario {
  const char* name;
  double size;                        ///< longest travel, m
  double U_fixed, U_per_length;       ///< um, um/m: expanded
  double misalignment;                ///< mm: the beam ends on a disc of this radius
  double sensor, from_20, expansion;  ///< K range, K, um/(m K) range
  double drift;                       ///< um
  double repeatability;               ///< um, standard deviation of an approach
  double sphere = 1.0, probe = 1.0;   ///< um ranges
  Warmth warmth = Warmth::steady;
  Sensors sensors = Sensors::stay;
  Course course = Course::walk;
};

/// All of them, for every method.
const std::vector<Scenario>& scenarios();

/// The campaign as its manifest states it: axes X, Y, Z.
Campaign stated(const Scenario&);

/// Where the machine stops, and how it got there.
struct Visit {
  std::size_t stop = 0;
  int direction = 1;
  std::uint32_t run = 1;
};
/// Up and down over n stops, `runs` times.
std::vector<Visit> there_and_back(std::size_t n, int runs);
/// Once over n stops.
std::vector<Visit> once(std::size_t n);

/// One line: distances of its stops from the first, and the mean positions of the machine at them,
/// by direction of approach.
struct Line {
  std::vector<double> distance, mean;
  double reversal = 0.0;
};

/// A reading as displayed, and what a perfect instrument in a perfect shop would have displayed.
struct Reading {
  double seen = 0.0, real = 0.0;
};

/// The causes of one campaign.
class Day {
 public:
  /// size: of all causes; 0 to see that the truth is right.
  Day(const Scenario&, unsigned seed, double size = 1.0);

  /// The display is preset at the first stop before the first visit.
  std::vector<Reading> measured(const Line&, const std::vector<Visit>&);

  /// One coordinate axis of the machine with a probe.
  struct Coordinate {
    double offset = 0.0, stretch = 0.0;
    std::vector<double> drift;
  };
  /// Of n touches of a ball, one after the other.
  Coordinate coordinate(std::size_t n);
  double touch();  ///< form of the ball where it was touched, and repeatability of the machine

  double normal(double sigma);
  double uniform(double half);

 private:
  double strain();  ///< what is not corrected of the machine's expansion along one line
  double shortening(double length);
  std::vector<double> drift(std::size_t n);

  const Scenario& s_;
  std::mt19937_64 rng_;
  std::normal_distribution<double> normal_;
  double size_, laser_ = 0.0, material_ = 0.0, sensor_ = 0.0;
};

}  // namespace nonio::coverage
