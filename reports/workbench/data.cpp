// SPDX-License-Identifier: Apache-2.0
#include "nonio/workbench/data.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numeric>

#include "nonio/reports/drawing.h"
#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/json_writer.h"
#include "nonio/sdk/splitmix64.h"

namespace nonio::workbench {

using namespace reports;

namespace {

/// Eight significant digits keep large pages small; null if not finite.
void put_number(JsonWriter& json, double value) {
  if (!std::isfinite(value)) return json.null();
  char buffer[32];
  const auto end =
      std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, 8);
  json.raw({buffer, static_cast<std::size_t>(end.ptr - buffer)});
}

void put_number(JsonWriter& json, std::string_view name, double value) {
  json.key(name);
  put_number(json, value);
}

template <class T>
void put_column(JsonWriter& json, std::string_view name, const std::vector<T>& values,
                const std::vector<std::size_t>& rows, double factor = 1.0, double from = 0.0) {
  if (values.empty()) {
    json.key(name);
    return json.null();
  }
  json.list(name, rows, [&](std::size_t row) {
    put_number(json, row < values.size() ? (static_cast<double>(values[row]) - from) * factor
                                         : std::nan(""));
  });
}

/// A pseudo-random order, so that a sample is not in phase with test cycles.
std::uint64_t scrambled(std::size_t row) { return SplitMix64::mixed(row); }

void put_words(JsonWriter& json, const Drawn& source) {
  json.key("words");
  json.begin_object();
  for (const char* name :
       {"rms_now", "without", "without_cv", "not_refitted", "of_whole", "reading", "deviation",
        "model", "residual", "time", "temperature", "line", "suspect", "reversal", "polar_title",
        "polar_says", "rest_title", "rest_says"})
    json.member(name, source.words.get(std::string("page.") + name));
  for (const char* name : chart_words) json.member(name, source.words.get(name));
  json.member("largest", source.words.get("model.largest"));
  json.member("no_readings", source.words.get("picture.no_readings"));
  json.member("one_direction", source.words.get("picture.reversal.none"));
  json.end_object();
}

void put_pictures(JsonWriter& json, const Drawn& source, bool titles) {
  const auto put = [&](const PictureWords& p) {
    json.begin_object();
    if (titles) json.member("title", p.title);
    if (titles) json.member("says", p.says);
    json.member("x", p.x);
    json.member("y", p.y);
    json.member("none", p.none);
    json.member("degrees", p.degrees);
    json.end_object();
  };
  json.key("fit");
  put(fit_words(source.fit, source.words));
  json.list("pictures", source.pictures, put);
}

/// Writes what a fit leaves: its numbers are of all readings, its columns of the page's rows.
template <class Fit>
void put_residuals(JsonWriter& json, const Fit& fit, const Kept& kept, double per_si) {
  const auto known = [&](std::optional<double> si) { return si ? *si * per_si : std::nan(""); };
  put_number(json, "rms", fit.rms * per_si);
  put_number(json, "cv_rms", known(fit.cv_rms));
  put_number(json, "largest", fit.largest * per_si);
  put_number(json, "floor", known(fit.floor));
  put_column(json, "residual", fit.residual, kept.rows, per_si);
  put_column(json, "left_out", fit.cv_residual, kept.rows, per_si);
  std::vector<double> weight = fit.weight;
  weight.resize(fit.residual.size(), 1.0);
  std::map<std::size_t, std::size_t> place;
  for (std::size_t k = 0; k < kept.rows.size(); ++k) {
    place[kept.rows[k]] = k;
    if (kept.counted[k] == 0) weight[kept.rows[k]] = 0.0;
  }
  put_column(json, "weight", weight, kept.rows);
  json.list("suspects", fit.suspects, [&](const ModelFit::Suspect& s) {
    const auto it = place.find(s.row);
    if (it == place.end()) return;
    json.begin_array();
    json.value(static_cast<std::uint64_t>(it->second));
    put_number(json, s.minimal_detectable * per_si);
    json.end_array();
  });
}

/// Writes the fit without one effect.
void put_without(JsonWriter& json, const ModelFit& fit, const std::string& effect, const Kept& kept,
                 double per_si) {
  json.key("without");
  const auto it = std::find_if(fit.without.begin(), fit.without.end(),
                               [&](const auto& w) { return w.effect == effect; });
  if (it == fit.without.end() || it->residual.size() != fit.size()) return json.null();
  json.begin_object();
  put_residuals(json, *it, kept, per_si);
  json.end_object();
}

struct CircleOf {
  std::string axes;
  double radius = 0.0;
};
CircleOf circle_of(const Campaign& campaign, const std::string& id) {
  CircleOf out;
  for (const Measurement& m : campaign.measurements) {
    if (m.id != id || m.motion != Measurement::Motion::path) continue;
    for (const auto& [axis, from] : m.from)
      if (const auto to = m.to.find(axis); to != m.to.end() && to->second != from)
        out = {axis + out.axes, to->second - from};
      else
        out.axes += axis;
  }
  return out;
}

void put_circles(JsonWriter& json, const Drawn& source) {
  if (!has_circles(source.campaign, source.fit)) return;
  const auto& all = source.fit.measurements;
  json.list("circles", all, [&](const std::string& id) {
    put_number(json, circle_of(source.campaign, id).radius * unit_of(Quantity::length).per_si);
  });
  json.list("circle_axes", all, [&](const std::string& id) {
    const CircleOf circle = circle_of(source.campaign, id);
    json.value(circle.radius > 0.0 ? circle.axes : std::string());
  });
}

std::vector<std::size_t> all_rows(std::size_t n) {
  std::vector<std::size_t> rows(n);
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  return rows;
}

}  // namespace

bool has_circles(const Campaign& campaign, const ModelFit& fit) {
  return std::any_of(fit.measurements.begin(), fit.measurements.end(),
                     [&](const std::string& id) { return circle_of(campaign, id).radius > 0.0; });
}

Kept kept_readings(const std::vector<double>& values, std::size_t most) {
  Kept kept;
  kept.rows = all_rows(values.size());
  kept.counted.assign(values.size(), 1);
  if (values.size() <= most) return kept;
  const std::size_t largest = most / 100;
  std::vector<std::size_t> order = kept.rows;
  const auto first = [&](std::size_t n, const auto& key) {
    std::nth_element(
        order.begin(), order.begin() + static_cast<std::ptrdiff_t>(n), order.end(),
        [&](std::size_t a, std::size_t b) { return std::pair(key(a), a) < std::pair(key(b), b); });
    return std::vector(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(n));
  };
  std::map<std::size_t, char> rows;
  for (const std::size_t i :
       first(largest, [&](std::size_t row) { return -std::fabs(values[row]); }))
    rows[i] = 0;
  for (const std::size_t i : first(most - largest, scrambled)) rows[i] = 1;
  kept = {};
  for (const auto& [row, counted] : rows) kept.rows.push_back(row), kept.counted.push_back(counted);
  return kept;
}

std::string data_of(const Drawn& source, const Kept& kept, bool titles) {
  const ModelFit& fit = source.fit;
  const std::vector<std::size_t>& rows = kept.rows;
  const Quantity up = deviation_of(fit.angular);
  const PlaceScale across = place_scale(fit);
  const double per_si = unit_of(up).per_si;
  double first = INFINITY;
  for (const double t : fit.time)
    if (std::isfinite(t)) first = std::min(first, t);
  const auto known = [](const auto& values, std::size_t n) {
    auto out = values;
    out.resize(n);
    return out;
  };
  const PictureWords& over_time = source.pictures[static_cast<std::size_t>(ResidualPlot::time)];
  JsonWriter json(JsonWriter::Layout::in_script);
  json.begin_object();
  json.member("language", source.words.language());
  json.member("comma", localised(".", source.words.language()) == ",");
  json.member("axis", fit.axis);
  json.member("unit", unit_text(up));
  json.member("position_unit", across.unit);
  json.member("time_unit", over_time.time_unit);
  if (const Lanes lanes = lanes_of(fit); !lanes.names.empty()) {
    json.member("lanes", lanes.names);
  } else {
    json.key("lanes");
    json.null();
  }
  put_number(json, "measurements", static_cast<double>(fit.measurements.size()));
  put_circles(json, source);
  put_number(json, "period", period_of(fit) * across.per_si);
  put_number(json, "readings", static_cast<double>(fit.size()));
  put_residuals(json, fit, kept, per_si);
  put_words(json, source);
  put_pictures(json, source, titles);
  std::vector<std::string> files;
  for (const std::string& id : fit.measurements) {
    files.emplace_back();
    for (const Measurement& m : source.campaign.measurements)
      if (m.id == id) files.back() = m.file;
  }
  json.member("files", files);
  if (!kept.row_in_files.empty())
    put_column(json, "row", kept.row_in_files, rows);
  else if (rows.size() < fit.size())
    put_column(json, "row", all_rows(fit.size()), rows);
  put_column(json, "measurement", known(fit.measurement, fit.size()), rows);
  put_column(json, "line", known(fit.source_line, fit.size()), rows);
  put_column(json, "run", known(fit.run, fit.size()), rows);
  put_column(json, "direction", known(fit.direction, fit.size()), rows);
  put_column(json, "target", fit.target, rows, across.per_si, across.from);
  put_column(json, "time", fit.time, rows, over_time.x_per_si, first);
  put_column(json, "temperature", fit.temperature, rows);
  put_column(json, "deviation", fit.deviation, rows, per_si);
  json.list("effects", fit.effects, [&](const ModelFit::Effect& e) {
    json.begin_object();
    json.member("name", e.name);
    put_column(json, "says", known(e.contribution, fit.size()), rows, per_si);
    put_without(json, fit, e.name, kept, per_si);
    json.end_object();
  });
  json.list("channels", fit.channels, [&](const ModelFit::Channel& c) {
    json.begin_object();
    json.member("name", c.name);
    json.member("unit", c.unit == "degC" ? "°C" : c.unit);
    json.member("used", c.used);
    put_column(json, "values", c.values, rows);
    json.end_object();
  });
  json.end_object();
  return json.take();
}

}  // namespace nonio::workbench
