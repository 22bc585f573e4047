// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/sdk/observations.h"
#include "simulation/simulate_spec.h"

/// Readings of a specification, measurement by measurement, in the form in which a reader of files
/// returns them: those of an exact machine with the stated set-up of straightedges and squares,
/// before effects and noise.
namespace nonio::simulation {

/// Returns the rows of one measurement. They contain only what its file will contain, so that
/// effects depend on nothing else.
Expected<Observations> rows_of(const Specification&, const CycleSpec&,
                               const std::vector<double>& targets);

/// Returns the position of a ball rotated by an exact axis: c + R(n, angle) (ball - c).
std::array<double, 3> turned(const std::array<double, 3>& ball, const std::array<double, 3>& centre,
                             const std::array<double, 3>& direction, double angle);

/// Returns the rows of a measurement of kind ball-centres or rtcp, with the readings of a machine
/// with exact linear axes as deviations. An error if a rotary axis has no [[simulation.rotary]], or
/// if, for rtcp, this table does not state what the axis carries.
Expected<Observations> rotary_rows(const Specification&, const CycleSpec&);

/// Computes the times and temperatures of readings that are taken one after the other.
class Clock {
 public:
  explicit Clock(const CycleSpec& c) : c_(c) {}
  /// Advances the time by a move of `way`, m or rad, and by the dwell, except for the first
  /// reading, and appends time (s) and material temperature (degC) of the reading to `o`; NaN for
  /// those that the file does not contain.
  void reading(Observations& o, double way);
  void pause() { t_ += c_.pause; }

 private:
  const CycleSpec& c_;
  double t_ = 0.0;
  bool first_ = true;
};

/// Returns the header row of a measurement's file.
std::string header_of(const CycleSpec&);
/// Returns the row of the file that begins with reading `at`: one reading, or the three of a ball
/// centre or of a probe. `deviation` (m or rad) replaces the deviations of these readings.
std::string row_of(const CycleSpec&, const Observations&, std::size_t at,
                   const std::vector<double>& deviation);
/// Returns a whole file with the columns that a method declares.
std::string table_of(const Method&, const Readings&);
/// Returns the number of readings in one row of the file.
std::size_t readings_in_row(const CycleSpec&);

}  // namespace nonio::simulation
