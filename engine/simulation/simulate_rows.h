// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/sdk/observations.h"
#include "simulation/simulate_spec.h"

/// Readings of a specification, measurement by measurement: as a reader of files makes them, with
/// what an exact machine would have read, before effects and noise.
namespace nonio::simulation {

/// Rows of one measurement; the effects get only what its file will contain.
Expected<Observations> rows_of(const Specification&, const CycleSpec&,
                               const std::vector<double>& targets);

/// The places of a ball that turns with an exact axis: c + R(n, angle) (ball - c).
std::array<double, 3> turned(const std::array<double, 3>& ball, const std::array<double, 3>& centre,
                             const std::array<double, 3>& direction, double angle);

/// Ball centres and rtcp: the deviations of exact linear axes are in them.
Expected<Observations> rotary_rows(const Specification&, const CycleSpec&);

/// When readings are taken, one after the other.
class Clock {
 public:
  explicit Clock(const CycleSpec& c) : c_(c) {}
  /// Moves by `way` and puts time and temperature of the reading into the table.
  void reading(Observations& o, double way);
  void pause() { t_ += c_.pause; }

 private:
  const CycleSpec& c_;
  double t_ = 0.0;
  bool first_ = true;
};

/// The file of one measurement: its header row, then a row a reading, or one for three of them.
std::string header_of(const CycleSpec&);
/// The row of readings `at` (three of a ball's centre), with `deviation` in place of the table's.
std::string row_of(const CycleSpec&, const Observations&, std::size_t at,
                   const std::vector<double>& deviation);
/// A whole file of the columns that a method declares.
std::string table_of(const Method&, const Readings&);
/// How many readings of the table make one row of the file.
std::size_t readings_in_row(const CycleSpec&);

}  // namespace nonio::simulation
