// SPDX-License-Identifier: Apache-2.0
#include "nonio/workbench/data.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numeric>

#include "nonio/reports/number.h"
#include "nonio/sdk/format.h"
#include "nonio/sdk/splitmix64.h"

namespace nonio::workbench {

using namespace reports;

namespace {

void append_number(std::string& out, double value) {
  if (!std::isfinite(value)) {
    out += "null";
    return;
  }
  char buffer[32];
  const auto end =
      std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, 8);
  out.append(buffer, end.ptr);
}

/// An object, member by member.
class Object {
 public:
  void raw(std::string_view name, std::string_view value) {
    out_ += out_.size() > 1 ? ",\n" : "";
    out_ += json(name) + ":";
    out_ += value;
  }
  void text(std::string_view name, std::string_view value) { raw(name, json(value)); }
  void number(std::string_view name, double value) {
    std::string text;
    append_number(text, value);
    raw(name, text);
  }
  std::string done() { return out_ + "}"; }

 private:
  std::string out_ = "{";
};

template <class Items, class Each>
std::string list(const Items& items, const Each& each) {
  std::string out = "[";
  for (const auto& item : items) {
    if (out.size() > 1) out += ',';
    each(out, item);
  }
  return out + "]";
}

/// A column of the readings that are kept; null if the files did not have it.
template <class T>
std::string column(const std::vector<T>& values, const std::vector<std::size_t>& rows,
                   double factor = 1.0, double from = 0.0) {
  if (values.empty()) return "null";
  return list(rows, [&](std::string& out, std::size_t row) {
    append_number(out, row < values.size() ? (static_cast<double>(values[row]) - from) * factor
                                           : std::nan(""));
  });
}

/// A sample by this order falls in step with nothing that a test cycle repeats.
std::uint64_t scrambled(std::size_t row) { return SplitMix64::mixed(row); }

std::string words_of(const Drawn& source) {
  Object out;
  for (const char* name :
       {"rms_now", "without", "without_cv", "not_refitted", "reading", "deviation", "model",
        "residual", "time", "temperature", "line", "suspect", "reversal", "polar_title",
        "polar_says", "rest_title", "rest_says"})
    out.text(name, source.words.get(std::string("page.") + name));
  out.text("no_readings", source.words.get("picture.no_readings"));
  out.text("one_direction", source.words.get("picture.reversal.none"));
  return out.done();
}

std::string pictures_of(const Drawn& source, bool titles) {
  return list(source.pictures, [titles](std::string& out, const PictureWords& p) {
    Object picture;
    if (titles) picture.text("title", p.title);
    if (titles) picture.text("says", p.says);
    picture.text("x", p.x);
    picture.text("y", p.y);
    picture.text("none", p.none);
    picture.raw("degrees", p.degrees ? "true" : "false");
    out += picture.done();
  });
}

std::string files_of(const Drawn& source) {
  return list(source.fit.measurements, [&](std::string& out, const std::string& id) {
    std::string file;
    for (const Measurement& m : source.campaign.measurements)
      if (m.id == id) file = m.file;
    out += json(file);
  });
}

/// The model fitted again without one effect: RMS of all readings, residuals of those on the page.
std::string without_of(const ModelFit& fit, const std::string& effect,
                       const std::vector<std::size_t>& rows, double per_si) {
  const auto it = std::find_if(fit.without.begin(), fit.without.end(),
                               [&](const auto& w) { return w.effect == effect; });
  if (it == fit.without.end() || it->residual.size() != fit.size()) return "null";
  Object out;
  out.number("rms", it->rms * per_si);
  out.number("cv_rms", it->cv_rms ? *it->cv_rms * per_si : std::nan(""));
  out.raw("residual", column(it->residual, rows, per_si));
  return out.done();
}

/// First and second axis of a circle's plane, and its radius, m; 0: no circle.
struct CircleOf {
  std::string axes;
  double radius = 0.0;
};
CircleOf circle_of(const Campaign& campaign, const std::string& id) {
  CircleOf out;
  for (const Measurement& m : campaign.measurements) {
    if (m.id != id || m.kind != "circle") continue;
    for (const auto& [axis, from] : m.from)
      if (const auto to = m.to.find(axis); to != m.to.end() && to->second != from)
        out = {axis + out.axes, to->second - from};
      else
        out.axes += axis;
  }
  return out;
}

/// Of each measurement its radius in mm and its plane, 0 and "" where it is no circle.
void put_circles(Object& out, const Drawn& source) {
  if (!has_circles(source.campaign, source.fit)) return;
  const auto& all = source.fit.measurements;
  out.raw("circles", list(all, [&](std::string& text, const std::string& id) {
            append_number(text,
                          circle_of(source.campaign, id).radius * unit_of(Quantity::length).per_si);
          }));
  out.raw("circle_axes", list(all, [&](std::string& text, const std::string& id) {
            const CircleOf circle = circle_of(source.campaign, id);
            text += json(circle.radius > 0.0 ? circle.axes : std::string());
          }));
}

std::vector<std::size_t> all_rows(std::size_t n) {
  std::vector<std::size_t> rows(n);
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  return rows;
}

/// Names of the lines that stand side by side; null where all readings have one axis.
std::string lanes_text(const ModelFit& fit) {
  const Lanes lanes = lanes_of(fit);
  if (lanes.names.empty()) return "null";
  return list(lanes.names, [](std::string& out, const std::string& name) { out += json(name); });
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
  const Quantity along = position_of(fit.rotary), up = deviation_of(fit.angular);
  const double across = unit_of(along).per_si, per_si = unit_of(up).per_si;
  double first = INFINITY;
  for (const double t : fit.time)
    if (std::isfinite(t)) first = std::min(first, t);
  std::vector<double> weight(fit.size(), 1.0);
  for (std::size_t i = 0; i < fit.weight.size() && i < weight.size(); ++i)
    weight[i] = fit.weight[i];
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (kept.counted[k] == 0) weight[rows[k]] = 0.0;
  const auto known = [](const auto& values, std::size_t n) {
    auto out = values;
    out.resize(n);
    return out;
  };
  Object out;
  out.text("language", source.words.language());
  out.raw("comma", localised(".", source.words.language()) == "," ? "true" : "false");
  out.text("axis", fit.axis);
  out.text("unit", unit_text(up));
  out.text("position_unit", unit_text(along));
  out.text("time_unit", source.pictures[static_cast<std::size_t>(ResidualPlot::time)].time_unit);
  out.raw("lanes", lanes_text(fit));
  out.number("measurements", static_cast<double>(fit.measurements.size()));
  put_circles(out, source);
  out.number("period", period_of(fit) * across);
  out.number("floor", fit.floor ? *fit.floor * per_si : std::nan(""));
  out.raw("words", words_of(source));
  out.raw("pictures", pictures_of(source, titles));
  out.raw("files", files_of(source));
  if (!kept.row_in_files.empty())
    out.raw("row", column(kept.row_in_files, rows));
  else if (rows.size() < fit.size())
    out.raw("row", column(all_rows(fit.size()), rows));
  out.raw("measurement", column(known(fit.measurement, fit.size()), rows));
  out.raw("line", column(known(fit.source_line, fit.size()), rows));
  out.raw("run", column(known(fit.run, fit.size()), rows));
  out.raw("direction", column(known(fit.direction, fit.size()), rows));
  out.raw("target", column(fit.target, rows, across));
  out.raw("time",
          column(fit.time, rows,
                 source.pictures[static_cast<std::size_t>(ResidualPlot::time)].x_per_si, first));
  out.raw("temperature", column(fit.temperature, rows));
  out.raw("deviation", column(fit.deviation, rows, per_si));
  out.raw("residual", column(fit.residual, rows, per_si));
  out.raw("left_out", column(fit.cv_residual, rows, per_si));
  out.raw("weight", column(weight, rows));
  out.raw("effects", list(fit.effects, [&](std::string& text, const ModelFit::Effect& e) {
            Object effect;
            effect.text("name", e.name);
            effect.raw("says", column(known(e.contribution, fit.size()), rows, per_si));
            effect.raw("without", without_of(fit, e.name, rows, per_si));
            text += effect.done();
          }));
  std::map<std::size_t, std::size_t> place;
  for (std::size_t k = 0; k < rows.size(); ++k) place[rows[k]] = k;
  std::vector<std::pair<std::size_t, double>> suspects;
  for (const ModelFit::Suspect& s : fit.suspects)
    if (const auto it = place.find(s.row); it != place.end())
      suspects.emplace_back(it->second, s.minimal_detectable * per_si);
  out.raw("suspects", list(suspects, [](std::string& text, const auto& s) {
            text += "[" + std::to_string(s.first) + ",";
            append_number(text, s.second);
            text += "]";
          }));
  return out.done();
}

std::string json(std::string_view text) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string out = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x20 || c == '"' || c == '\\' || c == '<' || c == '>' || c == '&')
      out += {'\\', 'u', '0', '0', digits[code >> 4], digits[code & 15]};
    else
      out += c;
  }
  return out + '"';
}

std::string json(const std::vector<double>& values) {
  return list(values, [](std::string& out, double value) { append_number(out, value); });
}

}  // namespace nonio::workbench
