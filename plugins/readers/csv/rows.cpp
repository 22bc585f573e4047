// SPDX-License-Identifier: Apache-2.0
#include "rows.h"

#include <cmath>

#include "csv.h"
#include "header.h"
#include "nonio/sdk/method.h"
#include "spatial.h"

namespace nonio::csv {

std::vector<ColumnSpec> with_common(std::vector<ColumnSpec> columns) {
  for (const char* name : {"time_s", "material_c", "air_c", "pressure_hpa", "humidity_pct"})
    columns.push_back({name});
  columns.push_back({"run", Kind::whole});
  return columns;
}

void put_further_columns(Observations& obs, const Table& table, std::size_t row) {
  const auto put = [&](const char* name, std::vector<double>& to) {
    if (const auto* column = table.column(name)) to.push_back((*column)[row]);
  };
  put("time_s", obs.time);
  put("material_c", obs.material);
  put("air_c", obs.air);
  put("pressure_hpa", obs.pressure);
  put("humidity_pct", obs.humidity);
  obs.source_line.push_back(table.line[row]);
}

void put_common(Observations& obs, const Table& table, std::size_t row) {
  const auto* run = table.column("run");
  obs.run.push_back(run == nullptr ? 1 : static_cast<std::uint32_t>((*run)[row]));
  put_further_columns(obs, table, row);
}

std::vector<ColumnSpec> with_channels(std::vector<ColumnSpec> columns) {
  for (const ChannelEnding& e : channel_endings) columns.push_back({"*" + std::string(e.end)});
  return columns;
}

Expected<void> put_channels(Observations& obs, const Table& table) {
  const auto* time = table.column("time_s");
  for (const auto& [name, values] : table.numbers)
    for (const ChannelEnding& e : channel_endings) {
      if (!name.ends_with(e.end) || name == "material_c" || name == "air_c" ||
          name == "humidity_pct")
        continue;
      if (!is_channel(name)) return unknown_column(name, 1);
      if (time == nullptr)
        return fail(at_line(0, name,
                            "missing column: \"" + name +
                                "\" was recorded over the time; expected \"time_s\" "
                                "next to it"));
      std::map<double, double> samples;
      for (std::size_t row = 0; row < values.size(); ++row)
        if (std::isfinite(values[row]) && std::isfinite((*time)[row]))
          samples.emplace((*time)[row], values[row]);
      if (samples.empty()) continue;
      Observations::Channel c{
          name.substr(0, name.size() - e.end.size()), std::string(e.unit), {}, {}};
      for (const auto& [at, value] : samples) c.time.push_back(at), c.value.push_back(value);
      obs.channels.push_back(std::move(c));
    }
  return {};
}

Observations begin(const Measurement& m, const Table& table) {
  Observations obs;
  obs.measurement = m.id;
  if (table.empty_rows > 0)
    obs.notes.push_back({"csv.empty-rows", {count("rows", table.empty_rows)}});
  return obs;
}

Expected<Observations> complete(Observations obs) {
  if (obs.size() == 0)
    return fail("expected readings, found " + std::to_string(obs.missing) +
                " of which not one was taken");
  return obs;
}

Error at_line(std::uint64_t line, std::string column, std::string message) {
  Error error{std::move(message)};
  error.line = line;
  error.column = std::move(column);
  return error;
}

Expected<Table> table_of(const ReadInput& input, const std::vector<ColumnSpec>& columns) {
  auto table = read_table(input.bytes, columns);
  if (!table) table.error().file = input.measurement.file;
  return table;
}

namespace {

ColumnSpec::Kind kind_of(const Method::Column& column) {
  using Role = Method::Column::Role;
  switch (column.role) {
    case Role::run:
      return ColumnSpec::Kind::whole;
    case Role::direction:
      return column.required ? ColumnSpec::Kind::sign : ColumnSpec::Kind::motion;
    case Role::deviation:
      return ColumnSpec::Kind::number;
    default:
      return column.required ? ColumnSpec::Kind::place : ColumnSpec::Kind::number;
  }
}

}  // namespace

Expected<StatedColumns> stated_columns(const ReadInput& input) {
  std::vector<std::string> declared;
  if (input.method != nullptr)
    for (const Method::Column& c : input.method->columns) declared.push_back(name_in_file(c));
  return StatedColumns::of(input.options.texts(columns_option), {declared.begin(), declared.end()});
}

Expected<Observations> read_declared(const ReadInput& input) {
  const Method& method = *input.method;
  std::vector<ColumnSpec> columns;
  for (const Method::Column& c : method.columns)
    columns.push_back({name_in_file(c), kind_of(c), c.required});
  NONIO_TRY(const auto stated, stated_columns(input));
  NONIO_TRY(auto table, in_file(read_table(input.bytes, columns, &stated), input));
  Readings readings;
  readings.source_line = std::move(table.line);
  for (const Method::Column& c : method.columns) {
    const auto* column = table.column(name_in_file(c));
    if (column == nullptr) continue;
    auto& values = readings.columns[c.name] = *column;
    for (double& value : values) value /= unit_of(c.quantity).per_si;
  }
  auto o = in_file(observe(method, {input.campaign, input.measurement, readings}), input);
  if (o && table.empty_rows > 0)
    o->notes.push_back({"csv.empty-rows", {count("rows", table.empty_rows)}});
  return o;
}

}  // namespace nonio::csv
