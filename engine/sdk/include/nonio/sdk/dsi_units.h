// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>
#include <utility>

namespace nonio {

/// Units as `unit_of` prints them and in D-SI notation (PTB's D-SI 2.2: names of siunitx).
inline constexpr std::array<std::pair<std::string_view, std::string_view>, 23> dsi_units = {{
    {"", "\\one"},
    {"mm", "\\milli\\metre"},
    {"um", "\\micro\\metre"},
    {"deg", "\\degree"},
    {"arcsec", "\\arcsecond"},
    {"urad", "\\micro\\radian"},
    {"um/m", "\\micro\\metre\\per\\metre"},
    {"arcsec/deg", "\\arcsecond\\per\\degree"},
    {"um/(m K)", "\\micro\\metre\\per\\metre\\per\\kelvin"},
    {"degC", "\\degreecelsius"},
    {"K", "\\kelvin"},
    {"s", "\\second"},
    {"um/h", "\\micro\\metre\\per\\hour"},
    {"arcsec/h", "\\arcsecond\\per\\hour"},
    {"um/(m h)", "\\micro\\metre\\per\\metre\\per\\hour"},
    {"arcsec/(deg h)", "\\arcsecond\\per\\degree\\per\\hour"},
    {"arcsec/(deg K)", "\\arcsecond\\per\\degree\\per\\kelvin"},
    {"hPa", "\\hecto\\pascal"},
    {"readings", "\\one"},
    {"um/reading", "\\micro\\metre"},
    {"arcsec/reading", "\\arcsecond"},
    {"um/(m reading)", "\\micro\\metre\\per\\metre"},
    {"arcsec/(deg reading)", "\\arcsecond\\per\\degree"},
}};

/// Empty if there is no D-SI name.
constexpr std::string_view dsi_of(std::string_view unit) {
  for (const auto& [ours, theirs] : dsi_units)
    if (ours == unit) return theirs;
  return {};
}

}  // namespace nonio
