// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "nonio/sdk/column_map.h"
#include "nonio/sdk/fields.h"
#include "nonio/sdk/plugin.h"

namespace nonio::readers {

/// An error at a line of the measurement's file.
Error at_line(std::uint64_t line, std::string message);

std::vector<std::string_view> by_blanks(std::string_view line);

/// ' ' means any number of blanks; '|' is also accepted at both ends of the line. None if a quote
/// is not closed.
std::optional<std::vector<std::string_view>> by_separator(std::string_view line, char separator);

/// Parses the numbers of one file, all of which must have the same decimal mark.
class Numbers {
 public:
  explicit Numbers(bool comma_allowed) : comma_allowed_(comma_allowed) {}
  /// Returns NaN for a missing reading. An error states that `what` was expected.
  Expected<double> reading(std::string_view text, std::uint64_t line, std::string_view what);
  /// An error states that `what` was expected.
  Expected<double> number(std::string_view text, std::uint64_t line, std::string_view what);

 private:
  bool comma_allowed_;
  /// First line with each decimal mark; 0 without such a line.
  std::uint64_t first_point_ = 0, first_comma_ = 0;
};

/// Returns 1 to `most`; 0 for any other text.
std::uint32_t whole_number(std::string_view text, std::uint32_t most);

/// Error: the manifest does not contain the axis of the measurement.
Expected<const Axis*> axis_of(const ReadInput& input);
/// Adds the file to an error of `read`, unless it is an error of an option.
Expected<Observations> read_of_axis(const ReadInput& input,
                                    Expected<Observations> (*read)(const ReadInput&, const Axis&));

/// Whether a name in a file is that of another axis of the machine, or of the control's axis on the
/// other side of a gantry.
bool is_other_axis(const Machine& machine, const Measurement& m, std::string_view name);

/// Whether a name begins with the letter of another axis (ISO 841) than `own`.
bool is_other_letter(std::string_view own, std::string_view name);

/// One reading, SI; a missing one has the deviation NaN.
struct Reading {
  std::uint32_t run = 0;
  std::int8_t approach = 0;
  double target = 0.0, deviation = 0.0;
  std::uint64_t line = 0;
  double time = std::numeric_limits<double>::quiet_NaN();
};

class Runs {
 public:
  Runs(const ReadInput& input, const Axis& axis, bool angular);
  /// Error: a reading of the same run, direction and target already exists.
  Expected<void> add(const Reading& reading);
  Observations& observations() { return obs_; }
  /// Error: there is no reading.
  Expected<Observations> finish();

 private:
  std::map<std::tuple<std::uint32_t, std::int8_t, double>, std::uint64_t> lines_;
  std::vector<std::uint64_t> not_taken_{};  ///< line numbers of missing readings
  Observations obs_;
};

/// Returns +1 or -1 for strictly monotonic values, otherwise 0.
int sense_of(const std::vector<double>& values);

/// Line y = offset + slope x by least squares; NaN if all x are equal.
struct Straight {
  double offset = 0.0, slope = 0.0;
};
Straight straight_through(const std::vector<double>& x, const std::vector<double>& y);

Number counted(std::string name, std::uint64_t n);

}  // namespace nonio::readers
