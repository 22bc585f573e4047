// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/control.h"

/// The axes of the machine with their settings in the control: option `axes` contains those of each
/// axis.
namespace nonio::controllers {

using AxisSettings = NumberTable;

struct KnownAxis {
  std::string name;
  std::size_t number = 0;  ///< setting `number`; 0: not stated, and not assumed
  bool rotary = false;
  AxisSettings settings;

  std::optional<double> setting(std::string_view key) const;
  /// Returns a setting that is a length or angle, in SI: "first" reads first_mm or first_deg.
  std::optional<double> position_setting(std::string_view key) const;
  double per_si() const { return rotary ? deg_per_rad : 1e3; }
};

/// Returns the tables of option `axes`, by axis. Error: an unknown key. `keys`: allowed keys;
/// "reference" is reference_mm and reference_deg, a name that ends with ':' is a plain number;
/// empty: any key. Settings from the record of a machine are always allowed: number, reference,
/// from, to, backlash, resolution, largest, slope.
Expected<NumberTables> settings_of_axes(const Settings& options,
                                        const std::vector<std::string_view>& keys = {});

/// Returns an error of option `axes`: of a key in it ("X.number"), or of the whole.
tl::unexpected<Error> wrong_axes(std::string message, const std::string& key = {});

/// Returns the axes of the manifest with their settings.
Expected<std::vector<KnownAxis>> known_axes(const TableInput&);
/// Returns the axis with this number. An unknown number gives a linear axis named by it.
KnownAxis axis_numbered(const std::vector<KnownAxis>&, std::size_t number);
/// `axis_of_file` finds the axis by a file name with prefix, such as "linuxcnc-X-before.comp"; for
/// any other name it returns the only axis of the machine. `axis_named` finds it by its name.
KnownAxis axis_of_file(const std::vector<KnownAxis>&, std::string_view file,
                       std::string_view prefix);
KnownAxis axis_named(const std::vector<KnownAxis>&, std::string_view name);

}  // namespace nonio::controllers
