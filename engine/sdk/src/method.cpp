// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/method.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "nonio/sdk/check.h"

namespace nonio {
namespace {

using Column = Method::Column;
using Role = Column::Role;

bool is_angle(Quantity q) {
  return q == Quantity::angle || q == Quantity::angular_deviation || q == Quantity::small_angle;
}
bool is_length(Quantity q) { return q == Quantity::length || q == Quantity::deviation; }

bool matches(Role role, Quantity q) {
  switch (role) {
    case Role::none:
      return true;
    case Role::position:
      return q == Quantity::length || q == Quantity::angle;
    case Role::deviation:
      return is_length(q) || is_angle(q);
    case Role::time:
      return q == Quantity::time;
    case Role::material:
    case Role::air:
      return q == Quantity::temperature;
    case Role::run:
    case Role::direction:
    case Role::pressure:
    case Role::humidity:
      return q == Quantity::number || q == Quantity::count;
  }
  return false;
}

const Column* with_role(const Method& method, Role role) {
  const auto found = std::find_if(method.columns.begin(), method.columns.end(),
                                  [&](const Column& c) { return c.role == role; });
  return found == method.columns.end() ? nullptr : &*found;
}

bool requires_axis(const Method& method) {
  return std::any_of(method.info.options.begin(), method.info.options.end(),
                     [](const Option& o) { return o.name == "axis" && o.required; });
}

Expected<void> check_roles(const Method& method) {
  if (with_role(method, Role::deviation) == nullptr)
    return fail("no column has the role deviation; expected one, or a function `observe`");
  if (with_role(method, Role::position) != nullptr && !requires_axis(method))
    return fail("a column has the role position; expected a required key `axis`");
  for (const Column& c : method.columns)
    if (c.role == Role::none && c.required)
      return fail("the required column " + c.name + " has no role; expected a function `observe`");
  return {};
}

Expected<void> check_readings(const Method& method, const Readings& readings) {
  for (const auto& [name, values] : readings.columns)
    if (values.size() != readings.size())
      return fail("column " + name + " has " + std::to_string(values.size()) +
                  " values; expected " + std::to_string(readings.size()));
  for (const Column& c : method.columns) {
    const auto* values = readings.column(c.name);
    if (values == nullptr && c.required)
      return fail("missing column: expected \"" + name_in_file(c) + "\"");
    if (values == nullptr || !c.required || c.role == Role::deviation) continue;
    for (std::size_t i = 0; i < values->size(); ++i)
      if (!std::isfinite((*values)[i])) {
        Error error{"expected a number"};
        error.line = readings.source_line[i];
        error.column = name_in_file(c);
        return fail(std::move(error));
      }
  }
  return {};
}

using Measured = std::vector<double> Observations::*;

Measured measured(Role role) {
  switch (role) {
    case Role::time:
      return &Observations::time;
    case Role::material:
      return &Observations::material;
    case Role::air:
      return &Observations::air;
    case Role::pressure:
      return &Observations::pressure;
    case Role::humidity:
      return &Observations::humidity;
    default:
      return nullptr;
  }
}

Expected<std::uint32_t> run_number(const Column& column, double value, std::uint32_t line) {
  constexpr double most = std::numeric_limits<std::uint32_t>::max();
  if (value >= 1.0 && value <= most && value == std::floor(value))
    return static_cast<std::uint32_t>(value);
  Error error{"expected a whole number from 1"};
  error.line = line;
  error.column = name_in_file(column);
  return fail(std::move(error));
}

Observations::AxisColumn axis_of(const Measurement& m, const Column& position) {
  return {m.axis, position.quantity == Quantity::angle, {}, {}};
}

std::array<double, 3> sense_of(const Measurement& m) {
  std::array<double, 3> sense{};
  const std::size_t k = coordinate_of(m.lateral.empty() ? m.axis : m.lateral);
  if (k < sense.size()) sense[k] = 1.0;
  return sense;
}

Expected<void> add_column(const Column& column, const std::vector<double>& values,
                          const std::vector<std::size_t>& rows, const Readings& readings,
                          Observations& o) {
  if (const Measured kept = measured(column.role))
    for (const std::size_t i : rows) (o.*kept).push_back(values[i]);
  if (column.role == Role::position)
    for (const std::size_t i : rows) o.axes[0].position.push_back(values[i]);
  if (column.role == Role::direction && !o.axes.empty())
    for (const std::size_t i : rows)
      o.axes[0].approach.push_back(
          static_cast<std::int8_t>((values[i] > 0.0 ? 1 : 0) - (values[i] < 0.0 ? 1 : 0)));
  if (column.role == Role::run)
    for (const std::size_t i : rows) {
      NONIO_TRY(const auto run, run_number(column, values[i], readings.source_line[i]));
      o.run.push_back(run);
    }
  return {};
}

Expected<Observations> observe_by_roles(const Method& method, const MethodInput& input) {
  const Readings& readings = input.readings;
  const Column& deviation = *with_role(method, Role::deviation);
  Observations o;
  o.measurement = input.measurement.id;
  o.angular = is_angle(deviation.quantity);
  if (const Column* position = with_role(method, Role::position))
    o.axes.push_back(axis_of(input.measurement, *position));
  o.lines.push_back(
      {o.measurement, o.angular ? std::array<double, 3>{} : sense_of(input.measurement)});
  const std::vector<double>& values = *readings.column(deviation.name);
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::isfinite(values[i]))
      rows.push_back(i);
    else
      ++o.missing;
  for (const std::size_t i : rows) {
    o.deviation.push_back(values[i]);
    o.source_line.push_back(readings.source_line[i]);
  }
  for (const Column& c : method.columns)
    if (const auto* column = readings.column(c.name))
      if (auto added = add_column(c, *column, rows, readings, o); !added)
        return fail(added.error());
  return o;
}

std::vector<double> values_of(Role role, const Observations& o) {
  std::vector<double> values;
  if (const Measured kept = measured(role)) return o.*kept;
  if (role == Role::deviation) return o.deviation;
  if (role == Role::position && !o.axes.empty()) return o.axes[0].position;
  if (role == Role::direction && !o.axes.empty())
    values.assign(o.axes[0].approach.begin(), o.axes[0].approach.end());
  if (role == Role::run)
    for (std::size_t i = 0; i < o.size(); ++i) values.push_back(o.run_of(i));
  return values;
}

Expected<Readings> simulate_by_roles(const Method& method, const Observations& o) {
  Readings readings;
  for (std::size_t i = 0; i < o.size(); ++i) readings.source_line.push_back(o.source_line_of(i));
  for (const Column& c : method.columns) {
    std::vector<double> values = values_of(c.role, o);
    if (!values.empty())
      readings.columns.emplace(c.name, std::move(values));
    else if (c.required && o.size() > 0)
      return fail("the observations do not determine the required column " + name_in_file(c));
  }
  return readings;
}

}  // namespace

std::string name_in_file(const Column& column) {
  return column.name + std::string(unit_of(column.quantity).suffix);
}

Expected<void> check(const Method& method) {
  std::set<std::string> names, in_file;
  std::set<Role> roles;
  for (const Column& c : method.columns) {
    const bool letters = std::all_of(c.name.begin(), c.name.end(), [](char letter) {
      return (letter >= 'a' && letter <= 'z') || (letter >= '0' && letter <= '9') || letter == '_';
    });
    if (c.name.empty() || !letters)
      return fail("a column with the name \"" + c.name + "\"; expected a-z 0-9 _");
    if (!names.insert(c.name).second || !in_file.insert(name_in_file(c)).second)
      return fail("two columns with the name " + name_in_file(c));
    if (c.help.empty()) return fail("column " + c.name + " without help");
    if (c.role != Role::none && !roles.insert(c.role).second)
      return fail("column " + c.name + " has the role of another column");
    if (!matches(c.role, c.quantity))
      return fail("column " + c.name + " has a quantity that does not match its role");
  }
  if (!method.columns.empty() && !method.observe) return check_roles(method);
  return {};
}

Expected<Observations> observe(const Method& method, const MethodInput& input) {
  if (auto sound = check(method); !sound)
    return fail("method " + method.info.name + ": " + sound.error().message);
  if (method.columns.empty()) return fail("method " + method.info.name + " declares no columns");
  if (auto sound = check_readings(method, input.readings); !sound) return fail(sound.error());
  auto o = method.observe ? method.observe(input) : observe_by_roles(method, input);
  if (!o) return o;
  if (auto sound = check(*o); !sound)
    return fail("method " + method.info.name + " gave " + sound.error().message);
  return o;
}

Expected<Readings> simulate(const Method& method, const SimulationInput& input) {
  if (auto sound = check(method); !sound)
    return fail("method " + method.info.name + ": " + sound.error().message);
  auto readings =
      method.simulate ? method.simulate(input) : simulate_by_roles(method, input.observations);
  if (!readings) return readings;
  if (auto sound = check_readings(method, *readings); !sound)
    return fail("method " + method.info.name + " gave " + sound.error().message);
  return readings;
}

}  // namespace nonio
