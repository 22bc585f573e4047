// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::csv {

enum class Role : std::uint8_t {
  run,
  direction,
  target,
  reading,
  ignored,  ///< excluded by option `columns`
  time,
  material,
  air,
  pressure,
  humidity,
  channel  ///< a temperature, speed or load of any name
};

/// Unit of a channel according to the end of its column name.
struct ChannelEnding {
  std::string_view end, unit;
};
inline constexpr ChannelEnding channel_endings[] = {
    {"_c", "degC"}, {"_rpm", "rpm"}, {"_pct", "%"}, {"_kw", "kW"}, {"_a", "A"}};

inline constexpr std::string_view ignore = "ignore";

/// Option `columns`: pairs of the name in the file (or "#3" for the third column) and a known name
/// or "ignore".
class StatedColumns {
 public:
  /// Parses entries such as "Soll mm = target_mm". `names`: known names; without them those of
  /// readings of an axis. An entry for the columns of another kind of measurement, to which the same
  /// option belongs, is omitted. Error: any other form.
  static Expected<StatedColumns> of(const std::vector<std::string>& entries,
                                    std::vector<std::string_view> names = {});
  bool empty() const { return names_.empty(); }
  /// The known name of column `index` (from 0); `name` itself if the option does not contain it.
  std::string_view known(std::string_view name, std::size_t index) const;
  bool all_in(const std::vector<std::string_view>& row) const;
  /// 0 if the option contains only names.
  std::size_t last_number() const;
  /// Separated by commas, for messages.
  std::string list() const;

 private:
  struct Stated {
    std::string name;        ///< as in the option, including "#3"
    std::size_t number = 0;  ///< column number from 1; 0 if identified by name
    std::string known;
  };
  std::vector<Stated> names_{};
};

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
  std::vector<Role> roles;
  std::vector<std::string> names;
  bool reading_is_position = false;

  bool has(Role role) const;
  bool comma_allowed() const { return separator != ','; }
};

/// The separator with the most known names in the header row.
char find_separator(std::string_view row, const StatedColumns& stated = {});

/// Number of names in the row that are known or in `stated`.
std::size_t known_names(std::string_view row, char separator, const StatedColumns& stated = {});

/// Whether the name is that of a channel by its ending, and not a misspelled known name.
bool is_channel(std::string_view name);

/// Error for a name that is not known, with the nearest one.
tl::unexpected<Error> unknown_column(std::string_view name, std::size_t number);

Expected<Header> parse_header(std::string_view row, const Expectation& expectation,
                              const StatedColumns& stated = {});

}  // namespace nonio::csv
