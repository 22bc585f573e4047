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

/// Functions shared by the readers of instrument files: runs of one axis, in which each reading
/// occurs once.
namespace nonio::readers {

/// Returns an error with its line; the file is that of the measurement.
Error at_line(std::uint64_t line, std::string message);

/// Splits a line at blanks.
std::vector<std::string_view> by_blanks(std::string_view line);

/// Splits a line of a table at the separator that a user stated: ' ' is any number of blanks, '|'
/// is also accepted at both ends. Nothing if a quote is not closed.
std::optional<std::vector<std::string_view>> by_separator(std::string_view line, char separator);

/// Parses the numbers of one file, which must all have a decimal point, or all a decimal comma.
class Numbers {
 public:
  explicit Numbers(bool comma_allowed) : comma_allowed_(comma_allowed) {}
  /// Parses a reading, NaN if it was not taken. The error states that `what` was expected.
  Expected<double> reading(std::string_view text, std::uint64_t line, std::string_view what);
  /// Parses a number that must exist. The error states that `what` was expected.
  Expected<double> number(std::string_view text, std::uint64_t line, std::string_view what);

 private:
  bool comma_allowed_;
  /// first lines with that decimal mark; 0: none
  std::uint64_t first_point_ = 0, first_comma_ = 0;
};

/// Parses an integer from 1 to `most`; 0 for any other text.
std::uint32_t whole_number(std::string_view text, std::uint32_t most);

/// Returns the axis of the measurement. Error: the manifest does not contain it.
Expected<const Axis*> axis_of(const ReadInput& input);
/// Calls `read` for the axis of the measurement. Adds the file to an error, unless it is an error
/// of an option.
Expected<Observations> read_of_axis(const ReadInput& input,
                                    Expected<Observations> (*read)(const ReadInput&, const Axis&));

/// Whether a name in a file is that of another axis than the measurement's: another axis of the
/// machine, or the control's axis of the other side of a gantry.
bool is_other_axis(const Machine& machine, const Measurement& m, std::string_view name);

/// Whether a name begins with the letter of an axis (ISO 841), but of another one than `own`.
bool is_other_letter(std::string_view own, std::string_view name);

/// One reading of one axis, SI. A deviation of NaN means that it was not taken.
struct Reading {
  std::uint32_t run = 0;
  std::int8_t approach = 0;
  double target = 0.0, deviation = 0.0;
  std::uint64_t line = 0;
  double time = std::numeric_limits<double>::quiet_NaN();
};

/// Collects the readings of one axis.
class Runs {
 public:
  Runs(const ReadInput& input, const Axis& axis, bool angular);
  /// Adds a reading. Error: there already is a reading of the same run, direction and target.
  Expected<void> add(const Reading& reading);
  Observations& observations() { return obs_; }
  /// Returns the observations. Error: no reading was taken.
  Expected<Observations> finish();

 private:
  std::map<std::tuple<std::uint32_t, std::int8_t, double>, std::uint64_t> lines_;
  std::vector<std::uint64_t> not_taken_{};  ///< line numbers of missing readings
  Observations obs_;
};

/// Returns +1 or -1 if the values only rise or only fall, else 0.
int sense_of(const std::vector<double>& values);

/// Line y = offset + slope x by least squares; NaN if all x are equal.
struct Straight {
  double offset = 0.0, slope = 0.0;
};
Straight straight_through(const std::vector<double>& x, const std::vector<double>& y);

Number counted(std::string name, std::uint64_t n);

}  // namespace nonio::readers
