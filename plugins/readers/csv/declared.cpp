// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/method.h"
#include "rows.h"
#include "spatial.h"
#include "table.h"

namespace nonio::csv {
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

Expected<Observations> read_declared(const ReadInput& input) {
  const Method& method = *input.method;
  std::vector<ColumnSpec> columns;
  for (const Method::Column& c : method.columns)
    columns.push_back({name_in_file(c), kind_of(c), c.required});
  auto table = in_file(read_table(input.bytes, columns), input);
  if (!table) return fail(table.error());
  Readings readings;
  readings.source_line = std::move(table->line);
  for (const Method::Column& c : method.columns) {
    const auto* column = table->column(name_in_file(c));
    if (column == nullptr) continue;
    auto& values = readings.columns[c.name] = *column;
    for (double& value : values) value /= unit_of(c.quantity).per_si;
  }
  auto o = in_file(observe(method, {input.campaign, input.measurement, readings}), input);
  if (o && table->empty_rows > 0)
    o->notes.push_back({"csv.empty-rows", {count("rows", table->empty_rows)}});
  return o;
}

}  // namespace nonio::csv
