// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/control.h"

namespace nonio::controllers {

using AxisSettings = NumberTable;

struct KnownAxis {
  std::string name;
  std::size_t number = 0;  ///< setting `number`; 0 if not stated
  bool rotary = false;
  AxisSettings settings;

  std::optional<double> setting(std::string_view key) const;
  /// Returns a length or angle in SI: "first" reads first_mm or first_deg.
  std::optional<double> position_setting(std::string_view key) const;
  double per_si() const { return rotary ? deg_per_rad : 1e3; }
};

/// Returns the tables of option `axes`, by axis. In `keys`, "reference" allows reference_mm and
/// reference_deg, a name that ends with ':' a plain number; empty allows any key. Settings of a
/// machine record are always allowed: number, reference, from, to, backlash, resolution, largest,
/// slope. Error: an unknown key.
Expected<NumberTables> settings_of_axes(const Settings& options,
                                        const std::vector<std::string_view>& keys = {});

/// Error in option `axes`: in one of its keys ("X.number"), or in the whole option.
tl::unexpected<Error> wrong_axes(std::string message, const std::string& key = {});

Expected<std::vector<KnownAxis>> known_axes(const TableInput&);
/// An unknown number gives a linear axis with this number as its name.
KnownAxis axis_numbered(const std::vector<KnownAxis>&, std::size_t number);
/// `axis_of_file` finds the axis by a file name with prefix, such as "linuxcnc-X-before.comp"; for
/// any other name it returns the only axis of the machine.
KnownAxis axis_of_file(const std::vector<KnownAxis>&, std::string_view file,
                       std::string_view prefix);
KnownAxis axis_named(const std::vector<KnownAxis>&, std::string_view name);

}  // namespace nonio::controllers
