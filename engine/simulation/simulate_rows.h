// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/sdk/observations.h"
#include "simulation/simulate_spec.h"

/// Readings of a specification as a reader of files returns them: those of an exact machine with
/// the specified setup of straightedges and squares, before effects and noise.
namespace nonio::simulation {

/// Contains only the data of the file to be written, so that effects depend on nothing else.
Expected<Observations> rows_of(const Specification&, const CycleSpec&,
                               const std::vector<double>& targets);

/// Position of a ball rotated by an exact axis: c + R(n, angle) (ball - c).
std::array<double, 3> turned(const std::array<double, 3>& ball, const std::array<double, 3>& centre,
                             const std::array<double, 3>& direction, double angle);

/// Rows of a measurement of kind ball-centres or rtcp; the deviations are the readings of a machine
/// with exact linear axes. An error if a rotary axis has no [[simulation.rotary]], or if, for rtcp,
/// this table does not state what the axis carries.
Expected<Observations> rotary_rows(const Specification&, const CycleSpec&);

/// Computes the times and temperatures of successive readings.
class Clock {
 public:
  explicit Clock(const CycleSpec& c) : c_(c) {}
  /// Advances the time by a move of `way`, m or rad, and by the dwell, except for the first
  /// reading, and appends time (s) and material temperature (degC) to `o`; NaN if the file does not
  /// contain them.
  void reading(Observations& o, double way);
  void pause() { t_ += c_.pause; }

 private:
  const CycleSpec& c_;
  double t_ = 0.0;
  bool first_ = true;
};

std::string header_of(const CycleSpec&);
/// Returns the row of the file that begins with reading `at`: one reading, or the three of a ball
/// center or of a probe. `deviation` (m or rad) replaces the deviations of these readings.
std::string row_of(const CycleSpec&, const Observations&, std::size_t at,
                   const std::vector<double>& deviation);
std::string table_of(const Method&, const Readings&);
std::size_t readings_in_row(const CycleSpec&);

}  // namespace nonio::simulation
