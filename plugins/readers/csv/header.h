// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::csv {

/// What a column holds.
enum class Role : std::uint8_t {
  run,
  direction,
  target,
  reading,
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

/// The separator with which most names of the header row are known ones.
char find_separator(std::string_view row);

/// How many names of the row are known ones.
std::size_t known_names(std::string_view row, char separator);

Expected<Header> parse_header(std::string_view row, const Expectation& expectation);

}  // namespace nonio::csv
