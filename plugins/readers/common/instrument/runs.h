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

/// What the readers of instrument files share: runs of one axis, each reading once.
namespace nonio::readers {

/// An error with its line; the file is that of the measurement.
Error at_line(std::uint64_t line, std::string message);

/// The fields of a line with blanks between them.
std::vector<std::string_view> by_blanks(std::string_view line);

/// The fields of a line of a table whose separator a user named: ' ' is any number of blanks, '|'
/// is accepted at both ends too. Nothing where a quote is not closed.
std::optional<std::vector<std::string_view>> by_separator(std::string_view line, char separator);

/// Numbers of one file: a decimal point everywhere, or a decimal comma everywhere.
class Numbers {
 public:
  explicit Numbers(bool comma_allowed) : comma_allowed_(comma_allowed) {}
  /// A number, NaN where none was taken; an error that states `what` was wanted.
  Expected<double> reading(std::string_view text, std::uint64_t line, std::string_view what);
  /// The same, but it must be there.
  Expected<double> number(std::string_view text, std::uint64_t line, std::string_view what);

 private:
  bool comma_allowed_;
  std::uint64_t first_point_ = 0, first_comma_ = 0;  ///< lines with that decimal mark; 0: none
};

/// A whole number from 1 to `most`; 0 if it is anything else.
std::uint32_t whole_number(std::string_view text, std::uint32_t most);

/// The axis of the measurement, which must be in the manifest.
Expected<const Axis*> axis_of(const ReadInput& input);
/// What `read` gives for that axis. An error that is not one of an option names the file.
Expected<Observations> read_of_axis(const ReadInput& input,
                                    Expected<Observations> (*read)(const ReadInput&, const Axis&));

/// Whether a name that a file states is that of an axis of the machine, or of the control on the
/// other side of a gantry, and of another one than the measurement's.
bool is_other_axis(const Machine& machine, const Measurement& m, std::string_view name);

/// Whether a name is that of an axis by its letter (ISO 841), and by its letter of another one.
bool is_other_letter(std::string_view own, std::string_view name);

/// One reading of one axis, SI. A deviation of NaN: it was not taken.
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
  /// An error if there is a reading of the same run, direction and target.
  Expected<void> add(const Reading& reading);
  Observations& observations() { return obs_; }
  /// An error if not one reading was taken.
  Expected<Observations> finish();

 private:
  std::map<std::tuple<std::uint32_t, std::int8_t, double>, std::uint64_t> lines_;
  std::vector<std::uint64_t> not_taken_{};  ///< lines
  Observations obs_;
};

/// +1 or -1 if the values only rise or only fall, else 0.
int sense_of(const std::vector<double>& values);

/// y = offset + slope x by least squares; NaN where the x do not differ.
struct Straight {
  double offset = 0.0, slope = 0.0;
};
Straight straight_through(const std::vector<double>& x, const std::vector<double>& y);

Number counted(std::string name, std::uint64_t n);

}  // namespace nonio::readers
