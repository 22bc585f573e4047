// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/results.h"

namespace nonio {

/// Index of the coordinate along which a linear axis moves: 0, 1, 2 for names that start with X, Y,
/// Z; 3 for all other names.
inline std::size_t coordinate_of(std::string_view axis) {
  const std::size_t at =
      axis.empty() ? std::string_view::npos : std::string_view("XYZ").find(axis[0]);
  return at == std::string_view::npos ? 3 : at;
}

/// Commanded positions closer than this, m or rad, are one target: 0.0001 mm, 0.02 arcsec.
inline constexpr double grid_tolerance = 1e-7;

/// The table to which all measurements are converted: one row per reading. Columns have `size()`
/// entries, or none if the file does not contain them. Units: m, rad, s and degC, unless a member
/// states another one. deviation = actual - target (ISO 230-2), see docs/conventions.md. `check`
/// (sdk/check.h) defines the valid values.
struct Observations {
  struct AxisColumn {
    std::string axis;
    bool rotary = false;
    std::vector<double> position;  ///< commanded position, m or rad
    /// Direction of approach: +1, -1, or 0 if the axis did not move; empty if no direction is
    /// stated.
    std::vector<std::int8_t> approach;
  };
  /// Readings of one line have a common unknown zero and, without `Observations::sense`, a common
  /// direction of sensing.
  struct Line {
    std::string name;
    /// Direction of sensing, a unit vector; all 0 if the deviation is an angle, or if it is not
    /// stated.
    std::array<double, 3> sense{};
    /// Common name of the lines of one rigid body whose position and orientation in the machine are
    /// unknown.
    std::string body{};
    /// False if the size of the body is unknown, because its temperature is unknown.
    bool body_size_known = true;
    /// As stated: position of the zero of the body, m, and rotation about Z, rad.
    std::array<double, 3> body_origin{};
    double body_turned = 0.0;
    std::optional<double> feed{};  ///< feed along the path, m/s or rad/s, if stated
  };

  /// A quantity recorded in addition to the deviations: a temperature, a speed, a load. It has its
  /// own times, and may begin before the first reading and end after the last one.
  struct Channel {
    std::string name;           ///< column name without the unit: "t4", "speed"
    std::string unit;           ///< "degC", "rpm", "%", "kW", "A"
    std::vector<double> time;   ///< s, ascending
    std::vector<double> value;  ///< finite, in `unit`
    /// Place and role according to the manifest (`Measurement::Channel`).
    std::string place{}, role{};
    /// Indices of the lines next to which it was recorded, ascending; empty: next to all. A channel
    /// of several measurements occurs once for each, because their times have different origins.
    std::vector<std::uint32_t> lines{};
    /// Largest magnitude, in `unit`, to which the parameters of a source relate, where a model of
    /// other readings is applied; not set: that of `value`.
    std::optional<double> largest{};

    bool is_temperature() const { return unit == "degC"; }
  };

  std::string measurement;  ///< measurement id in the manifest
  bool angular = false;     ///< whether deviations are angles (rad) instead of lengths (m)
  std::vector<AxisColumn> axes;
  std::vector<Line> lines;

  std::vector<double> deviation;   ///< actual - target, m or rad; finite
  std::vector<double> u;           ///< standard uncertainty of the deviation, m or rad
  std::vector<std::uint32_t> run;  ///< number of the run in the file, from 1
  /// Index into `lines`; if empty, all readings belong to lines[0].
  std::vector<std::uint32_t> line;
  std::vector<std::uint32_t> source_line;  ///< line of the file, 1-based
  std::vector<double> time;                ///< s; NaN if blank
  std::vector<double> material, air;       ///< temperatures, degC; NaN if blank
  /// Air pressure, hPa; relative humidity, %; NaN if blank.
  std::vector<double> pressure, humidity;

  std::vector<Channel> channels{};

  /// Direction of sensing of each reading, if it differs within a line; otherwise empty.
  std::vector<std::array<double, 3>> sense{};

  /// Structure of the machine (manifest), for effects that depend on it.
  std::string structure{};

  /// False if the order in which the rows were taken is unknown (manifest: `order = "unknown"`).
  bool order_known = true;

  std::uint64_t missing = 0;  ///< number of missing readings
  std::vector<Remark> notes;  ///< remarks of the reader for the user
  /// Contradictions between file and manifest: findings `plausibility.*`. No table is written until
  /// a person accepts them with a reason.
  std::vector<Finding> doubts{};

  std::size_t size() const { return deviation.size(); }
  /// The first channel of this name.
  const Channel* channel(std::string_view name) const {
    for (const Channel& c : channels)
      if (c.name == name) return &c;
    return nullptr;
  }
  const AxisColumn* axis(std::string_view name) const {
    for (const AxisColumn& a : axes)
      if (a.axis == name) return &a;
    return nullptr;
  }
  /// Defaults if the file does not contain the column: line 0, run 1, source line 0, direction of
  /// the line.
  std::uint32_t line_of(std::size_t i) const { return line.empty() ? 0 : line[i]; }
  std::uint32_t run_of(std::size_t i) const { return run.empty() ? 1 : run[i]; }
  std::uint32_t source_line_of(std::size_t i) const {
    return source_line.empty() ? 0 : source_line[i];
  }
  const std::array<double, 3>& sense_of(std::size_t i) const {
    return sense.empty() ? lines[line_of(i)].sense : sense[i];
  }
};

/// Calls f(column...) for each column measured in addition to the deviation (u, run, source_line,
/// time, material, air, pressure, humidity), with one argument per table.
template <class F, class... Tables>
void for_each_measured_column(F f, Tables&... tables) {
  f(tables.u...);
  f(tables.run...);
  f(tables.source_line...);
  f(tables.time...);
  f(tables.material...);
  f(tables.air...);
  f(tables.pressure...);
  f(tables.humidity...);
}

/// Calls f(column) for each column with one entry per reading, those of the axes first.
template <class Table, class F>
void for_each_column(Table& o, F f) {
  // A new member of Observations causes a compile error here: decide whether it is a column.
  [[maybe_unused]] const auto& [measurement, angular, axes, lines, deviation, u, run, line,
                                source_line, time, material, air, pressure, humidity, channels,
                                sense, structure, order_known, missing, notes, doubts] = o;
  for (auto& axis : o.axes) {
    f(axis.position);
    f(axis.approach);
  }
  f(o.deviation);
  f(o.line);
  f(o.sense);
  for_each_measured_column(f, o);
}

/// Appends deviations and the columns measured with them. If only one of both has a column, the
/// rows of the other are NaN, run 1, or source line 0. The caller appends the other members (axes,
/// lines, indices of lines, senses, channels).
void append_measured(Observations& to, const Observations& more);
/// Keeps the rows i with kept[i] != 0, in their order.
void keep_rows(Observations& o, const std::vector<char>& kept);
/// Row i of the result is row `order[i]`; lines and their names do not change.
Observations rearranged(const Observations& o, const std::vector<std::uint32_t>& order);

}  // namespace nonio
