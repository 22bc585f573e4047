// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <cmath>

#include "nonio/sdk/format.h"
#include "nonio/sdk/method.h"
#include "simulation/simulate_rows.h"

namespace nonio::simulation {
namespace {

std::string shortest(double value) {
  std::array<char, 64> buffer{};
  return {buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr};
}

bool of_ball(const CycleSpec& c) { return c.is("ball-centres") || c.is("rtcp"); }

std::string millimetres(double si) { return fixed_text(printed(si, Quantity::length), 5); }
std::string micrometres(double si) { return fixed_text(printed(si, Quantity::deviation), 3); }

double along(const CycleSpec& c, const Observations& o, std::size_t i) {
  double square = 0.0;
  for (const auto& axis : o.axes) {
    const double way = axis.position[i] - c.measurement.from.at(axis.axis);
    square += way * way;
  }
  return std::sqrt(square);
}

std::string step_row(const CycleSpec& c, const Observations& o, std::size_t i, double e) {
  const std::size_t step = i % (3 * c.steps + 1);
  const std::string& line = o.lines[o.line[i]].name;
  const std::string diagonal = line.substr(c.measurement.id.size() + 1, 3);
  return std::to_string(o.run[i]) + "," + diagonal + "," + std::to_string(step) + "," +
         "XYZ"[(step + 2) % 3] + "," + micrometres(e);
}

std::string ball_row(const CycleSpec& c, const Observations& o, std::size_t i,
                     const std::vector<double>& e) {
  std::string text = std::to_string(o.run[i]) + (o.axes[0].approach[i] > 0 ? ",+," : ",-,") +
                     shortest(printed(o.axes[0].position[i], Quantity::angle));
  if (!c.carrier.empty()) text += "," + shortest(printed(o.axes[4].position[i], Quantity::angle));
  const bool probe = c.sensor == "probe";
  for (std::size_t k = 0; k < 3; ++k)
    text += "," + millimetres(c.is("rtcp") ? o.axes[1 + k].position[i] : e[k]);
  if (!c.is("rtcp")) return text;
  if (probe)  // A probe reports the measured minus the commanded position.
    return text + "," + micrometres(-e[0]) + "," + micrometres(-e[1]) + "," + micrometres(-e[2]) +
           "," + o.lines[o.line[i]].name.substr(0, o.lines[o.line[i]].name.size() - 2);
  const auto& sense = c.sensor == "turns" ? o.lines[o.line[i]].sense : o.sense_of(i);
  for (const double n : sense) text += "," + shortest(n);
  return text + "," + micrometres(e[0]) + "," + o.lines[o.line[i]].name;
}

/// Angles are measured from the first axis of the plane toward the second.
std::string circle_row(const Observations& o, std::size_t i, double e) {
  const auto& n = o.sense_of(i);
  const double x = n[coordinate_of(o.axes[0].axis)], y = n[coordinate_of(o.axes[1].axis)];
  const double angle = std::atan2(y, x) * deg_per_rad;
  const bool counter_clockwise = x * o.axes[1].approach[i] - y * o.axes[0].approach[i] > 0.0;
  return std::to_string(o.run[i]) + (counter_clockwise ? ",+," : ",-,") +
         fixed_text(angle < 0.0 ? angle + 360.0 : angle, 4) + "," + micrometres(e);
}

}  // namespace

std::size_t readings_in_row(const CycleSpec& c) {
  return c.is("ball-centres") || c.sensor == "probe" ? 3 : 1;
}

std::string header_of(const CycleSpec& c) {
  std::string text;
  if (c.is("step-diagonal")) {
    text = "run,diagonal,step,moved,deviation_um";
  } else if (c.is("circle")) {
    text = "run,direction,angle_deg,deviation_um";
  } else if (of_ball(c)) {
    text = "run,direction,angle_deg" + (c.carrier.empty() ? "" : "," + c.carrier + "_deg") +
           ",x_mm,y_mm,z_mm";
    if (c.is("rtcp"))
      text += c.sensor == "probe"   ? ",dx_um,dy_um,dz_um,line"
              : c.sensor == "turns" ? ",tx,ty,tz,deviation_um,line"
                                    : ",nx,ny,nz,deviation_um,line";
  } else {
    text = std::string("run,direction,") +
           (c.axis.rotary ? "target_deg,deviation_arcsec" : "target_mm,deviation_um");
  }
  text += c.timed ? ",time_s" : "";
  return text + (c.temperature ? ",material_c\n" : "\n");
}

std::string table_of(const Method& method, const Readings& readings) {
  std::string text;
  std::vector<std::pair<const Method::Column*, const std::vector<double>*>> columns;
  for (const Method::Column& c : method.columns)
    if (const auto* values = readings.column(c.name)) columns.emplace_back(&c, values);
  for (const auto& [column, values] : columns)
    text += (text.empty() ? "" : ",") + name_in_file(*column);
  for (std::size_t i = 0; i < readings.size(); ++i) {
    std::string row;
    for (const auto& [column, values] : columns) {
      const double value = (*values)[i];
      if (!row.empty() || column != columns.front().first) row += ',';
      if (column->role == Method::Column::Role::direction)
        row += value > 0.0 ? "+" : value < 0.0 ? "-" : "";
      else if (std::isfinite(value))
        row += shortest(printed(value, column->quantity));
    }
    text += "\n" + row;
  }
  return text + "\n";
}

std::string row_of(const CycleSpec& c, const Observations& o, std::size_t i,
                   const std::vector<double>& e) {
  std::string text;
  if (c.is("step-diagonal")) {
    text = step_row(c, o, i, e[0]);
  } else if (c.is("circle")) {
    text = circle_row(o, i, e[0]);
  } else if (of_ball(c)) {
    text = ball_row(c, o, i, e);
  } else {
    const double at = c.is("diagonal") ? along(c, o, i) : o.axes[0].position[i];
    const bool up =
        c.is("diagonal")
            ? o.axes[0].approach[i] * o.lines[0].sense[coordinate_of(o.axes[0].axis)] > 0.0
            : o.axes[0].approach[i] > 0;
    text = std::to_string(o.run[i]) + (up ? ",+," : ",-,") +
           shortest(printed(at, position_of(o.angular))) + "," +
           fixed_text(printed(e[0], deviation_of(o.angular)), 3);
  }
  if (c.timed) text += "," + fixed_text(o.time[i], c.is("circle") ? 3 : 1);
  if (c.temperature) text += "," + fixed_text(o.material[i], 2);
  return text + "\n";
}

}  // namespace nonio::simulation
