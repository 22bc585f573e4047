// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::csv {

/// What a column holds.
enum class Role : std::uint8_t {
  run,
  direction,
  target,
  reading,
  ignored,  ///< a person stated that it is none of these
  time,
  material,
  air,
  pressure,
  humidity,
  channel  ///< of any name: a temperature, speed or load next to the readings
};

/// What a channel holds, by the end of its column's name.
struct ChannelEnding {
  std::string_view end, unit;
};
inline constexpr ChannelEnding channel_endings[] = {
    {"_c", "degC"}, {"_rpm", "rpm"}, {"_pct", "%"}, {"_kw", "kW"}, {"_a", "A"}};

/// What a person stated of columns with other names (option `columns`): the name in the file, or
/// "#3" for the third column, and the known name, "ignore" for none.
class StatedColumns {
 public:
  /// Of entries such as "Soll mm = target_mm". An error if one has another form.
  static Expected<StatedColumns> of(const std::vector<std::string>& entries);
  bool empty() const { return names_.empty(); }
  /// The known name of column `index`, from 0; the same name where nothing is stated of it.
  std::string_view known(std::string_view name, std::size_t index) const;
  /// Whether the row has all the names and numbers that are stated.
  bool all_in(const std::vector<std::string_view>& row) const;
  /// The largest number of a column; 0: all are stated by name.
  std::size_t last_number() const;
  /// The names as a list, for messages.
  std::string list() const;

 private:
  struct Stated {
    std::string name;        ///< as it is stated, "#3" too
    std::size_t number = 0;  ///< of the column, from 1; 0: by its name
    std::string known;
  };
  std::vector<Stated> names_{};
};

/// What the file is expected to hold.
struct Expectation {
  std::string axis;
  bool rotary = false;
  bool straightness = false;
  bool angle = false;  ///< yaw, pitch or roll of a linear axis

  bool across() const { return straightness || angle; }
  bool angular_reading() const { return angle || (rotary && !straightness); }
  std::string target() const { return rotary ? "target_deg" : "target_mm"; }
  std::string deviation() const { return angular_reading() ? "deviation_arcsec" : "deviation_um"; }
};

struct Header {
  char separator = ',';
  std::vector<Role> roles;         ///< of each column
  std::vector<std::string> names;  ///< of each column
  bool reading_is_position = false;

  bool has(Role role) const;
  bool comma_allowed() const { return separator != ','; }
};

/// The separator with which most names of the header row are known or stated ones.
char find_separator(std::string_view row, const StatedColumns& stated = {});

/// How many names of the row are known or stated ones.
std::size_t known_names(std::string_view row, char separator, const StatedColumns& stated = {});

Expected<Header> parse_header(std::string_view row, const Expectation& expectation,
                              const StatedColumns& stated = {});

}  // namespace nonio::csv
