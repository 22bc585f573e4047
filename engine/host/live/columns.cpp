// SPDX-License-Identifier: Apache-2.0
#include "host/live/columns.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace nonio::host::live {
using modelling::PartModel;
using storage::Json;

namespace {

/// One value of a reading, by its row.
struct Column {
  std::function<double(std::size_t)> at;
  Quantity quantity = Quantity::number;
  double from = 0.0;
};

double first_of(const std::vector<double>& values) {
  double first = std::numeric_limits<double>::infinity();
  for (const double v : values)
    if (std::isfinite(v)) first = std::min(first, v);
  return std::isfinite(first) ? first : 0.0;
}

template <class T>
std::function<double(std::size_t)> of(const std::vector<T>& values) {
  return [&values](std::size_t i) {
    return i < values.size() ? static_cast<double>(values[i]) : std::nan("");
  };
}

double period_of(const PartModel& part, const Json& request) {
  if (part.part.kind != model::Part::Kind::axis) return 0.0;
  const Axis& axis = part.part.axes.front();
  const Json periods = request.value("period_mm", Json::object());
  if (periods.contains(axis.name)) return periods[axis.name].get<double>() * 1e-3;
  if (axis.rotary && axis.teeth) return 2.0 * M_PI / static_cast<double>(*axis.teeth);
  return axis.screw_pitch.value_or(0.0);
}

Expected<Column> column_of(const std::string& name, const PartModel& part, const Json& request,
                           std::span<const double> residual) {
  const Observations& o = part.part.table;
  if (name == "target") return Column{of(part.part.along), part.position()};
  if (name == "time") return Column{of(o.time), Quantity::time, first_of(o.time)};
  if (name == "temperature") return Column{of(o.material), Quantity::temperature};
  if (name == "run") return Column{of(o.run), Quantity::count};
  if (name == "order")
    return Column{[](std::size_t i) { return static_cast<double>(i); }, Quantity::count};
  if (name == "deviation") return Column{of(o.deviation), part.deviation()};
  if (name == "residual")
    return Column{[residual](std::size_t i) { return residual[i]; }, part.deviation()};
  if (name == "model")
    return Column{[residual, &o](std::size_t i) { return o.deviation[i] - residual[i]; },
                  part.deviation()};
  if (name == "phase") {
    const double period = period_of(part, request);
    if (!(period > 0.0)) return fail("the period of this part is not known");
    return Column{[period, &part](std::size_t i) {
                    const double phase = std::fmod(part.part.along[i], period);
                    return phase < 0.0 ? phase + period : phase;
                  },
                  part.position()};
  }
  return fail("\"" + name.substr(0, 40) +
              "\": expected target, time, temperature, run, phase, order, deviation, model or "
              "residual");
}

struct Range {
  double from, to;
};

/// In printed units.
double shown(const Column& c, std::size_t i) {
  return (c.at(i) - c.from) * unit_of(c.quantity).per_si;
}

Range range_of(const Column& x, const Column& y, std::size_t n, const Json& request) {
  Range range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < n; ++i) {
    const double value = shown(x, i);
    if (!std::isfinite(value) || !std::isfinite(y.at(i))) continue;
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

Json number(double value, Quantity q) {
  const double out = printed(value / unit_of(q).per_si, q);
  return std::isfinite(out) ? Json(out) : Json(nullptr);
}

/// Each reading for itself.
void put_points(Json& out, const std::vector<std::size_t>& rows, const Column& x, const Column& y) {
  for (const std::size_t i : rows) {
    out["x"].push_back(number(shown(x, i), x.quantity));
    for (const char* name : {"min", "max"}) out[name].push_back(number(shown(y, i), y.quantity));
    for (const char* name : {"min_row", "max_row"}) out[name].push_back(i);
  }
}

void put_columns(Json& out, const std::vector<std::size_t>& rows, const Column& x, const Column& y,
                 const Range& range, std::size_t px) {
  std::vector<Extremes> columns(px);
  const double width = (range.to - range.from) / static_cast<double>(px);
  for (const std::size_t i : rows) {
    const double at = width > 0.0 ? (shown(x, i) - range.from) / width : 0.0;
    Extremes& c = columns[std::min(px - 1, static_cast<std::size_t>(std::max(0.0, at)))];
    if (c.count == 0 || y.at(i) < y.at(c.least)) c.least = i;
    if (c.count == 0 || y.at(i) > y.at(c.most)) c.most = i;
    ++c.count;
  }
  for (std::size_t k = 0; k < px; ++k) {
    const Extremes& c = columns[k];
    if (c.count == 0) continue;
    out["x"].push_back(number(range.from + (static_cast<double>(k) + 0.5) * width, x.quantity));
    out["min"].push_back(number(shown(y, c.least), y.quantity));
    out["max"].push_back(number(shown(y, c.most), y.quantity));
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
  storage::put(json, "residual", residual[row], part.deviation());
  storage::put(json, "model", o.deviation[row] - residual[row], part.deviation());
  json["excluded"] = std::isnan(residual[row]);
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
  const std::size_t n = part.part.table.size();
  const Range range = range_of(*x, *y, n, request);
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < n; ++i) {
    const double at = shown(*x, i);
    if (at >= range.from && at <= range.to && std::isfinite(y->at(i))) rows.push_back(i);
  }
  Json out = {{"n", rows.size()},
              {"x_unit", unit_of(x->quantity).symbol},
              {"y_unit", unit_of(y->quantity).symbol},
              {"each", rows.size() <= 2 * px}};
  for (const char* name : {"x", "min", "max", "min_row", "max_row"}) out[name] = Json::array();
  if (rows.size() <= 2 * px)
    put_points(out, rows, *x, *y);
  else
    put_columns(out, rows, *x, *y, range, px);
  return storage::dump_line(out);
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

}  // namespace nonio::host::live
