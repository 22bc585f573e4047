// SPDX-License-Identifier: Apache-2.0
// Displacements between tool and workpiece over time (thermal tests) and over the angle of a
// spindle. Each sensor is a line. The position of axis "S" is the accumulated spindle angle.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "header.h"
#include "nonio/sdk/channels.h"
#include "nonio/sdk/fields.h"
#include "nonio/sdk/format.h"
#include "rows.h"
#include "spatial.h"

namespace nonio::csv {

namespace {

constexpr double heat_turn = 2.0 * std::numbers::pi, heat_deg = std::numbers::pi / 180.0;

/// A sensor of a nest around a test mandrel; 1 is nearer to the spindle than 2.
struct Sensor {
  const char *column, *name;
  std::size_t coordinate;
};
constexpr Sensor nest[] = {{"x_um", "X", 0}, {"x1_um", "X1", 0}, {"x2_um", "X2", 0},
                           {"y_um", "Y", 1}, {"y1_um", "Y1", 1}, {"y2_um", "Y2", 1},
                           {"z_um", "Z", 2}};

constexpr std::string_view displacement_end = "_um", tilt_end = "_arcsec";

std::string without(std::string_view name, std::string_view end) {
  return std::string(name.substr(0, name.size() - end.size()));
}

std::vector<Observations::Channel> channels_of(const Table& table) {
  std::vector<Observations::Channel> out;
  const auto& time = *table.column("time_s");
  for (const auto& [name, values] : table.numbers)
    for (const ChannelEnding& e : channel_endings) {
      if (!name.ends_with(e.end) || name == "humidity_pct") continue;
      Observations::Channel c{without(name, e.end), std::string(e.unit), {}, {}};
      for (std::size_t row = 0; row < time.size(); ++row) {
        if (!std::isfinite(values[row])) continue;
        c.time.push_back(time[row]);
        c.value.push_back(values[row]);
      }
      if (!c.value.empty()) out.push_back(std::move(c));
    }
  return out;
}

std::vector<ColumnSpec> with_sensors(std::vector<ColumnSpec> columns) {
  for (const Sensor& s : nest) columns.push_back({s.column});
  for (const char* name : {"material_c", "air_c", "pressure_hpa", "humidity_pct"})
    columns.push_back({name});
  return columns;
}

std::vector<Sensor> nest_of(const Table& table) {
  std::vector<Sensor> out;
  for (const Sensor& s : nest)
    if (table.column(s.column) != nullptr) out.push_back(s);
  return out;
}

Expected<std::vector<Sensor>> sensors_of(const Table& table) {
  std::vector<Sensor> out = nest_of(table);
  if (out.empty())
    return fail(
        "missing column: expected a sensor: x_um, y_um, z_um, x1_um, x2_um, y1_um or y2_um");
  return out;
}

struct Displacement {
  std::string column, name;
  Sense sense{};
};

std::vector<Displacement> tilts_of(const Table& table) {
  std::vector<Displacement> out;
  for (const auto& [name, values] : table.numbers)
    if (name.ends_with(tilt_end)) out.push_back({name, without(name, tilt_end), {}});
  return out;
}

std::vector<Displacement> displacements_of(const Table& table) {
  std::vector<Displacement> out;
  for (const Sensor& s : nest_of(table)) {
    out.push_back({s.column, s.name, {}});
    out.back().sense[s.coordinate] = 1.0;
  }
  for (const auto& [name, values] : table.numbers)
    if (name.ends_with(displacement_end) &&
        std::none_of(out.begin(), out.end(),
                     [&, &n = name](const auto& d) { return d.column == n; }))
      out.push_back({name, without(name, displacement_end), {}});
  return out;
}

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

/// Removes rows that are equal to the row before, and adds a note. Error: a time that is not later
/// than that of the row before.
Expected<void> put_in_time(Table& table, Observations& obs) {
  const auto& time = *table.column("time_s");
  std::vector<char> repeated(time.size(), 0);
  for (std::size_t i = 1; i < time.size(); ++i) {
    if (time[i] > time[i - 1]) continue;
    const bool equal = std::all_of(table.numbers.begin(), table.numbers.end(), [&](const auto& c) {
      return same(c.second[i], c.second[i - 1]);
    });
    if (!equal)
      return fail(at_line(table.line[i], "time_s",
                          "expected a time later than that of line " +
                              std::to_string(table.line[i - 1]) + ", " +
                              short_text(time[i - 1], 9) + " s, found " + short_text(time[i], 9) +
                              " s" + (time[i] < time[i - 1] ? "" : " with other values")));
    repeated[i] = 1;
  }
  const auto first = std::find(repeated.begin(), repeated.end(), 1);
  if (first == repeated.end()) return {};
  const auto rows = static_cast<std::uint64_t>(std::count(first, repeated.end(), 1));
  const std::uint64_t line = table.line[static_cast<std::size_t>(first - repeated.begin())];
  const auto drop = [&](auto& column) {
    std::size_t to = 0;
    for (std::size_t i = 0; i < repeated.size(); ++i)
      if (repeated[i] == 0) column[to++] = column[i];
    column.resize(to);
  };
  for (auto& [name, column] : table.numbers) drop(column);
  drop(table.line);
  obs.notes.push_back({"csv.repeated-rows", {count("rows", rows), count("line", line)}});
  return {};
}

/// Accumulated spindle angle and direction of rotation from the speed, which applies until the next
/// row that has one. Without speeds the spindle is at rest.
struct Turning {
  std::vector<double> angle;
  std::vector<std::int8_t> turns;
};

Expected<Turning> turning_of(const Table& table) {
  const auto& time = *table.column("time_s");
  const auto* stated = table.column("speed_rpm");
  Turning out;
  double angle = 0.0, speed = 0.0;
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (i > 0) angle += speed / 60.0 * heat_turn * (time[i] - time[i - 1]);
    if (stated != nullptr && std::isfinite((*stated)[i])) speed = (*stated)[i];
    if (std::fabs(speed) > 1e6)
      return fail(
          at_line(table.line[i], "speed_rpm",
                  "expected a speed from -1000000 to 1000000 rpm, found " + short_text(speed, 9)));
    out.angle.push_back(angle);
    out.turns.push_back(speed > 0.0 ? std::int8_t{1} : speed < 0.0 ? std::int8_t{-1} : 0);
  }
  return out;
}

/// Only channels are used outside of the period.
bool in_period(const Measurement& m, double time) {
  const std::vector<double> period = m.settings.numbers("period");
  return period.size() != 2 || (time >= period[0] && time < period[1]);
}

Expected<Observations> read_nest(const ReadInput& input, Table& table) {
  const auto displacements = displacements_of(table), tilts = tilts_of(table);
  Observations obs = begin(input.measurement, table);
  const Measurement& m = input.measurement;
  obs.angular = m.settings.text("unit") == "arcsec" || displacements.empty();
  const auto& sensors = obs.angular ? tilts : displacements;
  if (sensors.empty())
    return fail("missing column: expected a displacement, a column whose name ends with " +
                std::string(tilts.empty() ? "_um or _arcsec" : displacement_end));
  const auto& all = input.campaign.measurements;
  if (!obs.angular && !tilts.empty() &&
      std::none_of(all.begin(), all.end(), [&](const Measurement& other) {
        return other.file == m.file && other.settings.text("unit") == "arcsec";
      }))
    obs.notes.push_back({"csv.tilts-not-evaluated", {count("columns", tilts.size())}});
  const double si = obs.angular ? 1.0 / arcsec_per_rad : 1e-6;
  if (auto ordered = put_in_time(table, obs); !ordered) return fail(std::move(ordered).error());
  NONIO_TRY(const auto turning, turning_of(table));
  const auto& time = *table.column("time_s");
  obs.axes = {{"S", true, {}, {}}};
  obs.channels = channels_of(table);
  for (const Displacement& s : sensors) {
    const auto number = static_cast<std::uint32_t>(obs.lines.size());
    obs.lines.push_back({s.name, s.sense});
    const auto& deviation = *table.column(s.column);
    for (std::size_t row = 0; row < table.size(); ++row) {
      if (!in_period(input.measurement, time[row])) continue;
      if (!std::isfinite(deviation[row])) {
        ++obs.missing;
        continue;
      }
      obs.deviation.push_back(deviation[row] * si);
      obs.line.push_back(number);
      obs.run.push_back(1);
      obs.axes[0].position.push_back(turning.angle[row]);
      obs.axes[0].approach.push_back(turning.turns[row]);
      put_further_columns(obs, table, row);
    }
  }
  for (auto* temperatures : {&obs.air, &obs.material})
    std::replace(temperatures->begin(), temperatures->end(), no_thermometer, double{NAN});
  return complete(std::move(obs));
}

/// An axis that cycles between targets: each reading of a target and direction is a new cycle.
Expected<Observations> read_exercised(const ReadInput& input, Table& table) {
  const Measurement& m = input.measurement;
  const Axis* axis = input.campaign.machine.axis(m.axis);
  if (axis == nullptr || axis->rotary || coordinate_of(m.axis) > 2)
    return fail(
        "columns of an axis that is exercised: expected `axis` of a linear axis X, Y or Z "
        "in the manifest, found \"" +
        m.axis + "\"");
  Observations obs = begin(input.measurement, table);
  if (auto ordered = put_in_time(table, obs); !ordered) return fail(std::move(ordered).error());
  obs.axes = {{m.axis, false, {}, {}}};
  Observations::Line line{m.id, {}};
  line.sense[coordinate_of(m.axis)] = 1.0;
  obs.lines.push_back(std::move(line));
  const auto &target = *table.column("target_mm"), &direction = *table.column("direction"),
             &deviation = *table.column("deviation_um");
  std::map<std::pair<double, double>, std::uint32_t> cycles;
  for (std::size_t row = 0; row < table.size(); ++row) {
    const std::uint32_t cycle = ++cycles[{target[row], direction[row]}];
    if (!std::isfinite(deviation[row])) {
      ++obs.missing;
      continue;
    }
    obs.axes[0].position.push_back(target[row] * 1e-3);
    obs.axes[0].approach.push_back(direction[row] > 0.0 ? std::int8_t{1} : std::int8_t{-1});
    obs.deviation.push_back(deviation[row] * 1e-6);
    obs.run.push_back(cycle);
    put_further_columns(obs, table, row);
  }
  return complete(std::move(obs));
}

/// Angles from one pulse per revolution, rad, with equal steps between pulses; NaN before the first
/// and after the last pulse.
std::vector<double> angles_by_pulses(const std::vector<double>& index) {
  std::vector<double> out(index.size(), NAN);
  std::vector<std::size_t> pulses;
  for (std::size_t i = 0; i < index.size(); ++i)
    if (index[i] > 0.5) pulses.push_back(i);
  for (std::size_t k = 0; k + 1 < pulses.size(); ++k)
    for (std::size_t i = pulses[k]; i <= pulses[k + 1]; ++i)
      out[i] =
          heat_turn * (static_cast<double>(k) + static_cast<double>(i - pulses[k]) /
                                                    static_cast<double>(pulses[k + 1] - pulses[k]));
  return out;
}

/// Orientation of the ball on the spindle, and of the sensors, deg.
struct SetUp {
  double ball = 0.0, sensor = 0.0;
  auto operator<=>(const SetUp&) const = default;
};

std::string set_up_name(const Sensor& s, const SetUp& at) {
  std::string name = std::string(s.name) + " ball ";
  append_shortest(name, at.ball);
  append_shortest(name += " sensor ", at.sensor);
  return name;
}

Expected<std::vector<double>> angles_of(const Table& table, const std::vector<std::size_t>& rows) {
  std::vector<double> out;
  if (const auto* angle = table.column("angle_deg")) {
    // Decreasing angles (opposite rotation) change their sign.
    const bool falls = rows.size() > 1 && (*angle)[rows[1]] < (*angle)[rows[0]];
    for (std::size_t k = 0; k < rows.size(); ++k) {
      out.push_back((*angle)[rows[k]] * (falls ? -heat_deg : heat_deg));
      if (k > 0 && !(out[k] > out[k - 1]))
        return fail(at_line(table.line[rows[k]], "angle_deg",
                            "expected angles that grow (or fall) from row to row and go on beyond "
                            "360, found " +
                                short_text((*angle)[rows[k]], 9) + " behind " +
                                short_text((*angle)[rows[k - 1]], 9)));
    }
    return out;
  }
  const auto* index = table.column("index");
  if (index == nullptr)
    return fail(
        "missing column: expected angle_deg, or index (1 in the row of each pulse, else 0)");
  std::vector<double> own;
  for (const std::size_t row : rows) {
    const double pulse = (*index)[row];
    if (pulse != 0.0 && pulse != 1.0)
      return fail(at_line(table.line[row], "index", "expected 1 in the row of a pulse, else 0"));
    own.push_back(pulse);
  }
  return angles_by_pulses(own);
}

Expected<void> put_set_up(Observations& obs, const Table& table, const Sensor& s, const SetUp& at,
                          const std::vector<std::size_t>& rows, std::uint64_t& outside) {
  NONIO_TRY(const auto angles, angles_of(table, rows));
  Observations::Line line{set_up_name(s, at), {}};
  // The sensors rotate about the spindle axis Z, so the direction of Z is constant.
  const double c = std::cos(at.sensor * heat_deg), t = std::sin(at.sensor * heat_deg);
  if (s.coordinate == 0) line.sense = {c, t, 0.0};
  if (s.coordinate == 1) line.sense = {-t, c, 0.0};
  if (s.coordinate == 2) line.sense = {0.0, 0.0, 1.0};
  const auto number = static_cast<std::uint32_t>(obs.lines.size());
  obs.lines.push_back(std::move(line));
  const auto& deviation = *table.column(s.column);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (!std::isfinite(angles[k])) {
      ++outside;
      continue;
    }
    if (!std::isfinite(deviation[rows[k]])) {
      ++obs.missing;
      continue;
    }
    obs.axes[0].position.push_back(angles[k]);
    obs.axes[1].position.push_back(at.ball * heat_deg);
    obs.axes[2].position.push_back(at.sensor * heat_deg);
    obs.deviation.push_back(deviation[rows[k]] * 1e-6);
    obs.line.push_back(number);
    obs.run.push_back(1);
    put_further_columns(obs, table, rows[k]);
  }
  return {};
}

}  // namespace

Expected<Observations> read_thermal(const ReadInput& input) {
  const bool exercised = !input.measurement.axis.empty();
  std::vector<ColumnSpec> columns{{"time_s", Kind::place, true}};
  if (exercised) {
    columns.push_back({"target_mm", Kind::place, true});
    columns.push_back({"direction", Kind::sign, true});
    columns.push_back({"deviation_um", Kind::number, true});
    for (const char* name : {"material_c", "air_c", "pressure_hpa", "humidity_pct"})
      columns.push_back({name});
  } else {
    columns.push_back({"speed_rpm"});
    columns = with_channels(with_sensors(std::move(columns)));
    columns.push_back({"*" + std::string(displacement_end)});
    columns.push_back({"*" + std::string(tilt_end)});
  }
  auto table = read_table(input.bytes, columns);
  auto obs = !table      ? Expected<Observations>(fail(table.error()))
             : exercised ? read_exercised(input, *table)
                         : read_nest(input, *table);
  if (!obs) obs.error().file = input.measurement.file;
  return obs;
}

namespace {

Expected<Observations> read_turns(const ReadInput& input, const Table& table) {
  NONIO_TRY(const auto sensors, sensors_of(table));
  Observations obs = begin(input.measurement, table);
  obs.axes = {{"S", true, {}, {}}, {"ball", true, {}, {}}, {"sensor", true, {}, {}}};
  const auto *ball = table.column("ball_deg"), *sensor = table.column("sensor_deg");
  std::map<SetUp, std::vector<std::size_t>> set_ups;
  for (std::size_t row = 0; row < table.size(); ++row)
    set_ups[{ball == nullptr ? 0.0 : (*ball)[row], sensor == nullptr ? 0.0 : (*sensor)[row]}]
        .push_back(row);
  constexpr std::size_t most = 1000;
  if (set_ups.size() > most)
    return fail("expected at most 1000 set-ups (ball_deg, sensor_deg), found " +
                std::to_string(set_ups.size()));
  std::uint64_t outside = 0;
  for (const auto& [at, rows] : set_ups)
    for (const Sensor& s : sensors)
      if (auto done = put_set_up(obs, table, s, at, rows, outside); !done)
        return fail(done.error());
  if (outside > 0) obs.notes.push_back({"csv.outside-pulses", {count("readings", outside)}});
  return complete(std::move(obs));
}

}  // namespace

Expected<Observations> read_spindle(const ReadInput& input) {
  auto table = read_table(input.bytes, with_sensors({{"angle_deg", Kind::place},
                                                     {"index", Kind::place},
                                                     {"ball_deg", Kind::place},
                                                     {"sensor_deg", Kind::place},
                                                     {"time_s"}}));
  auto obs = table ? read_turns(input, *table) : Expected<Observations>(fail(table.error()));
  if (!obs) obs.error().file = input.measurement.file;
  return obs;
}

}  // namespace nonio::csv
