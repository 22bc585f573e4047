// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/results.h"

namespace nonio {

/// Component of vectors in space along which a linear axis moves: 0, 1, 2 for X, Y, Z (and X1, Y2,
/// ...); 3 if the name does not state it.
inline std::size_t coordinate_of(std::string_view axis) {
  const std::size_t at =
      axis.empty() ? std::string_view::npos : std::string_view("XYZ").find(axis[0]);
  return at == std::string_view::npos ? 3 : at;
}

/// Commanded positions that lie nearer together are one target: 0.0001 mm, 0.02 arcsec. m or rad.
inline constexpr double grid_tolerance = 1e-7;

/// The one table that all measurements reduce to: a row is one reading that was taken. Columns have
/// `size()` entries, or none where the file did not have them. SI: m, rad, s, degC. Signs:
/// deviation = actual - target (ISO 230-2), drawn in docs/conventions.md. The conditions for its
/// values are those of `check` (sdk/check.h).
struct Observations {
  /// Commanded position of one axis, and the direction from which it was reached.
  struct AxisColumn {
    std::string axis;
    bool rotary = false;
    std::vector<double> position;       ///< m, or rad
    std::vector<std::int8_t> approach;  ///< +1, -1; empty if the axis did not move
  };
  /// Readings of one line share one unknown zero and one direction of sensing.
  struct Line {
    std::string name;
    std::array<double, 3> sense{};  ///< unit vector; all 0 on a rotary axis (deviation is an angle)
    /// Lines of one rigid body whose place and turn in the machine are unknown have its name.
    std::string body{};
    bool body_size_known = true;  ///< false: its temperature is unknown, too
  };

  /// What was recorded next to the deviations: a temperature at some place, a speed, a load. With
  /// times of its own: it may begin before the first reading and end after the last one.
  struct Channel {
    std::string name;             ///< of its column without the unit: "t4", "speed"
    std::string unit;             ///< "degC", "rpm", "%", "kW", "A"
    std::vector<double> time;     ///< s, ascending
    std::vector<double> value;    ///< in this unit; finite
    std::string place{}, role{};  ///< of the manifest (`Measurement::Channel`)

    bool is_temperature() const { return unit == "degC"; }
  };

  std::string measurement;  ///< its id in the manifest
  bool angular = false;     ///< deviation is an angle (rad), else a length (m)
  std::vector<AxisColumn> axes;
  std::vector<Line> lines;

  std::vector<double> deviation;           ///< actual - target, m or rad; always finite
  std::vector<double> u;                   ///< standard uncertainty of the deviation
  std::vector<std::uint32_t> run;          ///< as numbered in the file, from 1
  std::vector<std::uint32_t> line;         ///< index into `lines`; empty: all in lines[0]
  std::vector<std::uint32_t> source_line;  ///< line of the file, 1-based
  std::vector<double> time;                ///< s; NaN where blank
  std::vector<double> material, air;       ///< degC; NaN where blank
  std::vector<double> pressure, humidity;  ///< hPa, % ; NaN where blank

  std::vector<Channel> channels{};  ///< of a measurement over time

  /// Direction of sensing of each reading, where it differs within a line; else empty.
  std::vector<std::array<double, 3>> sense{};

  /// Of the machine (manifest), for effects that depend on it.
  std::string structure{};

  /// False: the order in which the rows were taken is not known (manifest, `order = "unknown"`).
  bool order_known = true;

  std::uint64_t missing = 0;  ///< readings that were not taken
  std::vector<Remark> notes;  ///< what the reader did that a user would want to know
  /// Contradictions between file and manifest: findings `plausibility.*`, for which no table is
  /// written before a person states why.
  std::vector<Finding> doubts{};

  std::size_t size() const { return deviation.size(); }
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
  /// Of a reading, also if the file does not contain it.
  std::uint32_t line_of(std::size_t i) const { return line.empty() ? 0 : line[i]; }
  std::uint32_t run_of(std::size_t i) const { return run.empty() ? 1 : run[i]; }
  std::uint32_t source_line_of(std::size_t i) const {
    return source_line.empty() ? 0 : source_line[i];
  }
  const std::array<double, 3>& sense_of(std::size_t i) const {
    return sense.empty() ? lines[line_of(i)].sense : sense[i];
  }
};

/// Calls f(column...) for each column that was measured in addition to the deviation, with that of
/// each table: u, run, source_line, time, material, air, pressure, humidity.
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

/// Calls f(column) for each column that has an entry for each reading, those of the axes first.
template <class Table, class F>
void for_each_column(Table& o, F f) {
  // A new member of Observations stops the compiler here: is it a column?
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

/// Appends the readings of `more` to those of `to`: the deviations, and what was measured with
/// them. In a column that only one of the two has, the rows of the other are NaN; run 1, source
/// line 0. Axes, lines and channels are the caller's.
void append_measured(Observations& to, const Observations& more);
/// The rows that `kept` has something at, in their order, and nothing of the others.
void keep_rows(Observations& o, const std::vector<char>& kept);
/// Row `order[i]` as row i; lines and their names stay.
Observations rearranged(const Observations& o, const std::vector<std::uint32_t>& order);

}  // namespace nonio
