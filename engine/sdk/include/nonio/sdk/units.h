// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>
#include <string_view>

namespace nonio {

/// The kind of a number. All numbers are SI (m, rad, s; temperatures in degC); a formatter
/// multiplies by `unit_of(q).per_si` and prints `unit_of(q).symbol`. Factors are exact (1 um = 1e-6
/// m, 1 h = 3600 s) except for 180/pi, which is rounded once.
enum class Quantity {
  number,                  ///< dimensionless
  count,                   ///< dimensionless integer
  ratio,                   ///< dimensionless, printed without conversion (0.83)
  probability,             ///< dimensionless
  length,                  ///< position, travel: m, printed in mm
  deviation,               ///< deviation of a position: m, printed in um
  angle,                   ///< position of a rotary axis: rad, printed in deg
  angular_deviation,       ///< deviation of an angle: rad, printed in arcsec
  small_angle,             ///< squareness and the like: rad, printed in urad
  deviation_per_length,    ///< m/m, printed in um/m
  deviation_per_angle,     ///< rad/rad, printed in arcsec/deg
  expansion,               ///< 1/K, printed in um/(m K)
  temperature,             ///< degC
  temperature_difference,  ///< K
  time,                    ///< s
  deviation_per_time,      ///< m/s, printed in um/h
  angle_per_time,          ///< rad/s, printed in arcsec/h
  growth,                  ///< expansion rate: 1/s, printed in um/(m h)
  angular_growth,          ///< expansion rate of an angle: 1/s, printed in arcsec/(deg h)
  angular_expansion,       ///< 1/K, printed in arcsec/(deg K)
  // The index of a reading replaces the time if times were not measured.
  readings,                    ///< number of readings instead of a time
  deviation_per_reading,       ///< m, printed in um/reading
  angle_per_reading,           ///< rad, printed in arcsec/reading
  growth_per_reading,          ///< m/m, printed in um/(m reading)
  angular_growth_per_reading,  ///< rad/rad, printed in arcsec/(deg reading)
  // Drift of a zero point with temperature.
  deviation_per_kelvin,  ///< m/K, printed in um/K
  angle_per_kelvin,      ///< rad/K, printed in arcsec/K
};

/// Returns the quantity that replaces `q` if the index of a reading replaces the time.
constexpr Quantity by_readings(Quantity q) {
  switch (q) {
    case Quantity::time:
      return Quantity::readings;
    case Quantity::deviation_per_time:
      return Quantity::deviation_per_reading;
    case Quantity::angle_per_time:
      return Quantity::angle_per_reading;
    case Quantity::growth:
      return Quantity::growth_per_reading;
    case Quantity::angular_growth:
      return Quantity::angular_growth_per_reading;
    default:
      return q;
  }
}

struct Unit {
  std::string_view symbol;  ///< "um"
  std::string_view suffix;  ///< part of a JSON or column name: "_um"
  double per_si;            ///< printed value = SI value * per_si
};

/// 1 deg = pi/180 rad, 1 arcsec = 1 deg/3600.
inline constexpr double arcsec_per_rad = 180.0 * 3600.0 / std::numbers::pi;
inline constexpr double deg_per_rad = 180.0 / std::numbers::pi;

constexpr Unit unit_of(Quantity q) {
  switch (q) {
    case Quantity::number:
    case Quantity::count:
    case Quantity::ratio:
    case Quantity::probability:
      return {"", "", 1.0};
    case Quantity::length:
      return {"mm", "_mm", 1e3};
    case Quantity::deviation:
      return {"um", "_um", 1e6};
    case Quantity::angle:
      return {"deg", "_deg", deg_per_rad};
    case Quantity::angular_deviation:
      return {"arcsec", "_arcsec", arcsec_per_rad};
    case Quantity::small_angle:
      return {"urad", "_urad", 1e6};
    case Quantity::deviation_per_length:
      return {"um/m", "_um_per_m", 1e6};
    case Quantity::deviation_per_angle:
      return {"arcsec/deg", "_arcsec_per_deg", 3600.0};
    case Quantity::expansion:
      return {"um/(m K)", "_um_per_m_K", 1e6};
    case Quantity::temperature:
      return {"degC", "_c", 1.0};
    case Quantity::temperature_difference:
      return {"K", "_K", 1.0};
    case Quantity::deviation_per_kelvin:
      return {"um/K", "_um_per_K", 1e6};
    case Quantity::angle_per_kelvin:
      return {"arcsec/K", "_arcsec_per_K", arcsec_per_rad};
    case Quantity::time:
      return {"s", "_s", 1.0};
    case Quantity::deviation_per_time:
      return {"um/h", "_um_per_h", 3600e6};
    case Quantity::angle_per_time:
      return {"arcsec/h", "_arcsec_per_h", 3600.0 * arcsec_per_rad};
    case Quantity::growth:
      return {"um/(m h)", "_um_per_m_h", 3600e6};
    case Quantity::angular_growth:
      return {"arcsec/(deg h)", "_arcsec_per_deg_h", 3600.0 * 3600.0};
    case Quantity::angular_expansion:
      return {"arcsec/(deg K)", "_arcsec_per_deg_K", 3600.0};
    case Quantity::readings:
      return {"readings", "_readings", 1.0};
    case Quantity::deviation_per_reading:
      return {"um/reading", "_um_per_reading", 1e6};
    case Quantity::angle_per_reading:
      return {"arcsec/reading", "_arcsec_per_reading", arcsec_per_rad};
    case Quantity::growth_per_reading:
      return {"um/(m reading)", "_um_per_m_reading", 1e6};
    case Quantity::angular_growth_per_reading:
      return {"arcsec/(deg reading)", "_arcsec_per_deg_reading", 3600.0};
  }
  return {"", "", 1.0};
}

/// Quantities of a position, of a deviation, and of a slope (deviation per position).
constexpr Quantity position_of(bool rotary) { return rotary ? Quantity::angle : Quantity::length; }
constexpr Quantity deviation_of(bool rotary) {
  return rotary ? Quantity::angular_deviation : Quantity::deviation;
}
constexpr Quantity slope_of(bool rotary) {
  return rotary ? Quantity::deviation_per_angle : Quantity::deviation_per_length;
}

}  // namespace nonio
