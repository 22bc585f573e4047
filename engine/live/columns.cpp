// SPDX-License-Identifier: Apache-2.0
#include "live/columns.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace nonio::live {
using modelling::PartModel;
using storage::Json;

namespace {

struct Column {
  std::vector<double> own;
  std::span<const double> si;
  Quantity quantity = Quantity::number;
  double from = 0.0;
  double per_si = 1.0;

  double shown(std::size_t i) const { return (si[i] - from) * per_si; }
};

double first_of(const std::vector<double>& values) {
  double first = std::numeric_limits<double>::infinity();
  for (const double v : values)
    if (std::isfinite(v)) first = std::min(first, v);
  return std::isfinite(first) ? first : 0.0;
}

double period_of(const PartModel& part, const Json& request) {
  if (part.part.kind != model::Part::Kind::axis) return 0.0;
  const Axis& axis = part.part.axes.front();
  const Json periods = request.value("period_mm", Json::object());
  if (periods.contains(axis.name)) return periods[axis.name].get<double>() * 1e-3;
  if (axis.rotary && axis.teeth) return 2.0 * M_PI / static_cast<double>(*axis.teeth);
  return axis.screw_pitch.value_or(0.0);
}

Column column_in(const std::vector<double>& values, std::size_t n, Quantity q, double from = 0.0) {
  Column c{{}, values, q, from, unit_of(q).per_si};
  if (values.size() < n) {
    c.own = values;
    c.own.resize(n, std::nan(""));
    c.si = c.own;
  }
  return c;
}

Column made(std::vector<double> values, Quantity q) {
  Column c{std::move(values), {}, q, 0.0, unit_of(q).per_si};
  c.si = c.own;
  return c;
}

Expected<Column> column_of(const std::string& name, const PartModel& part, const Json& request,
                           std::span<const double> residual) {
  const Observations& o = part.part.table;
  const std::size_t n = o.size();
  if (name == "target") return column_in(part.part.along, n, part.position());
  if (name == "time") return column_in(o.time, n, Quantity::time, first_of(o.time));
  if (name == "temperature") return column_in(o.material, n, Quantity::temperature);
  if (name == "deviation") return column_in(o.deviation, n, part.deviation());
  if (name == "residual")
    return Column{{}, residual, part.deviation(), 0.0, unit_of(part.deviation()).per_si};
  std::vector<double> values(n);
  if (name == "run") {
    for (std::size_t i = 0; i < n; ++i) values[i] = o.run_of(i);
    return made(std::move(values), Quantity::count);
  }
  if (name == "order") {
    std::iota(values.begin(), values.end(), 0.0);
    return made(std::move(values), Quantity::count);
  }
  if (name == "model") {
    for (std::size_t i = 0; i < n; ++i) values[i] = o.deviation[i] - residual[i];
    return made(std::move(values), part.deviation());
  }
  if (name == "phase") {
    const double period = period_of(part, request);
    if (!(period > 0.0)) return fail("the period of this part is not known");
    for (std::size_t i = 0; i < n; ++i) {
      const double phase = std::fmod(part.part.along[i], period);
      values[i] = phase < 0.0 ? phase + period : phase;
    }
    return made(std::move(values), part.position());
  }
  return fail("\"" + name.substr(0, 40) +
              "\": expected target, time, temperature, run, phase, order, deviation, model or "
              "residual");
}

struct Range {
  double from, to;
};

Range range_of(const Column& x, const Column& y, const Json& request) {
  Range range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  const bool is_asked = request.contains("x0") && request.contains("x1");
  for (std::size_t i = 0; i < x.si.size() && !is_asked; ++i) {
    const double value = x.shown(i);
    if (!std::isfinite(value) || !std::isfinite(y.si[i])) continue;
    range.from = std::min(range.from, value);
    range.to = std::max(range.to, value);
  }
  if (request.contains("x0")) range.from = request["x0"].get<double>();
  if (request.contains("x1")) range.to = request["x1"].get<double>();
  return range;
}

struct Extremes {
  std::size_t least = 0, most = 0, count = 0;
};

struct Binned {
  std::vector<Extremes> columns;
  std::vector<std::size_t> rows;
  std::size_t count = 0;
};

Binned binned(const Column& x, const Column& y, const Range& range, std::size_t px,
              std::size_t few) {
  Binned out;
  out.columns.resize(px);
  const double width = (range.to - range.from) / static_cast<double>(px);
  for (std::size_t i = 0; i < x.si.size(); ++i) {
    const double value = x.shown(i), up = y.si[i];
    if (!(value >= range.from && value <= range.to) || !std::isfinite(up)) continue;
    if (out.count++ <= few) out.rows.push_back(i);
    const double at = width > 0.0 ? (value - range.from) / width : 0.0;
    Extremes& c = out.columns[std::min(px - 1, static_cast<std::size_t>(at))];
    if (c.count == 0 || up < y.si[c.least]) c.least = i;
    if (c.count == 0 || up > y.si[c.most]) c.most = i;
    ++c.count;
  }
  return out;
}

Json number(double value, Quantity q) {
  const double out = printed(value / unit_of(q).per_si, q);
  return std::isfinite(out) ? Json(out) : Json(nullptr);
}

void put_points(Json& out, const std::vector<std::size_t>& rows, const Column& x, const Column& y) {
  for (const std::size_t i : rows) {
    out["x"].push_back(number(x.shown(i), x.quantity));
    for (const char* name : {"min", "max"}) out[name].push_back(number(y.shown(i), y.quantity));
    for (const char* name : {"min_row", "max_row"}) out[name].push_back(i);
  }
}

void put_columns(Json& out, const std::vector<Extremes>& columns, const Column& x, const Column& y,
                 const Range& range) {
  const double width = (range.to - range.from) / static_cast<double>(columns.size());
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const Extremes& c = columns[k];
    if (c.count == 0) continue;
    out["x"].push_back(number(range.from + (static_cast<double>(k) + 0.5) * width, x.quantity));
    out["min"].push_back(number(y.shown(c.least), y.quantity));
    out["max"].push_back(number(y.shown(c.most), y.quantity));
    out["min_row"].push_back(c.least);
    out["max_row"].push_back(c.most);
  }
}

Json reading_json(const PartModel& part, const Campaign& campaign, std::size_t row,
                  std::span<const double> residual) {
  const modelling::ReadingPlace at = modelling::place_of(part, campaign, row);
  const Observations& o = part.part.table;
  Json json = {{"row", row},
               {"measurement", at.measurement},
               {"measurement_row", part.part.row[row]},
               {"file", at.file}};
  if (at.line != 0) json["line"] = at.line;
  if (at.run != 0) json["run"] = at.run;
  if (at.direction != 0) json["direction"] = at.direction > 0 ? "+" : "-";
  storage::put(json, "target", at.target, at.position);
  storage::put(json, "deviation", o.deviation[row], part.deviation());
  if (!residual.empty()) {
    storage::put(json, "residual", residual[row], part.deviation());
    storage::put(json, "model", o.deviation[row] - residual[row], part.deviation());
    json["excluded"] = std::isnan(residual[row]);
  }
  if (row < o.time.size())
    storage::put(json, "time", o.time[row] - first_of(o.time), Quantity::time);
  if (row < o.material.size())
    storage::put(json, "temperature", o.material[row], Quantity::temperature);
  return json;
}

}  // namespace

Expected<std::string> series(const PartModel& part, const Json& request,
                             std::span<const double> residual) {
  const auto x = column_of(request.value("x", "target"), part, request, residual);
  const auto y = column_of(request.value("y", "residual"), part, request, residual);
  if (!x) return fail(x.error());
  if (!y) return fail(y.error());
  const std::size_t px = request.value("px", std::size_t{800});
  const std::size_t few = 2 * px;
  const Range range = range_of(*x, *y, request);
  const Binned all = binned(*x, *y, range, px, few);
  Json out = {{"n", all.count},
              {"x_unit", unit_of(x->quantity).symbol},
              {"y_unit", unit_of(y->quantity).symbol},
              {"each", all.count <= few}};
  for (const char* name : {"x", "min", "max", "min_row", "max_row"}) out[name] = Json::array();
  if (all.count <= few)
    put_points(out, all.rows, *x, *y);
  else
    put_columns(out, all.columns, *x, *y, range);
  return storage::dump_line(out);
}

bool is_of_fit(const Json& series) {
  for (const std::string& name : {series.value("x", "target"), series.value("y", "residual")})
    if (name == "residual" || name == "model") return true;
  return false;
}

Expected<std::string> readings(const PartModel& part, const Campaign& campaign, const Json& request,
                               std::span<const double> residual) {
  const std::size_t n = part.part.table.size();
  std::vector<std::size_t> rows;
  if (request.contains("rows")) {
    rows = request["rows"].get<std::vector<std::size_t>>();
  } else {
    const auto from = request.value("from", std::size_t{0}),
               count = request.value("count", std::size_t{100});
    for (std::size_t i = from; i < n && i - from < count; ++i) rows.push_back(i);
  }
  Json list = Json::array();
  for (const std::size_t row : rows) {
    if (row >= n)
      return fail("there is no reading " + std::to_string(row) + "; the last one is " +
                  std::to_string(n - 1));
    list.push_back(reading_json(part, campaign, row, residual));
  }
  return storage::dump_line({{"n", n}, {"readings", std::move(list)}});
}

}  // namespace nonio::live
