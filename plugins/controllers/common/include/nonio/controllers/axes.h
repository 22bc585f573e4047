// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/control.h"

/// The axes of the machine as a control knows them: option `axes` holds what each has of its own.
namespace nonio::controllers {

using AxisSettings = NumberTable;

struct KnownAxis {
  std::string name;
  std::size_t number = 0;  ///< setting `number`; 0: not stated, and not guessed
  bool rotary = false;
  AxisSettings settings;

  std::optional<double> setting(std::string_view key) const;
  /// A length or angle in SI: "first" reads first_mm or first_deg.
  std::optional<double> position_setting(std::string_view key) const;
  double per_si() const { return rotary ? deg_per_rad : 1e3; }
};

/// Tables of option `axes`, by axis. `keys`: "reference" is reference_mm and
/// reference_deg, a name with ':' at its end for a plain number; none: any. What the record of a
/// machine may state is always taken: number, reference, from, to, backlash, resolution, largest,
/// slope.
Expected<NumberTables> settings_of_axes(const Settings& options,
                                        const std::vector<std::string_view>& keys = {});

/// Error of option `axes`: of a key in it ("X.number"), or of the whole.
tl::unexpected<Error> wrong_axes(std::string message, const std::string& key = {});

/// The axes of the manifest with their settings.
Expected<std::vector<KnownAxis>> known_axes(const TableInput&);
/// A linear axis with that name if it is not known.
KnownAxis axis_numbered(const std::vector<KnownAxis>&, std::size_t number);
/// By the name of its file, "linuxcnc-X-before.comp" after this prefix: the axis in it, or the only
/// axis of the machine if the file has another name.
KnownAxis axis_of_file(const std::vector<KnownAxis>&, std::string_view file,
                       std::string_view prefix);
KnownAxis axis_named(const std::vector<KnownAxis>&, std::string_view name);

}  // namespace nonio::controllers
