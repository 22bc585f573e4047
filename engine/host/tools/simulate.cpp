// SPDX-License-Identifier: Apache-2.0
#include "host/tools/simulate.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "host/storage/random.h"
#include "host/tools/simulate_spec.h"
#include "nonio/sdk/format.h"

namespace nonio::host::tools {
namespace {

using Json = nlohmann::ordered_json;

/// What is drawn for one measurement, each from a stream of its own.
enum Stream : std::uint64_t { offsets, noise, misreadings, streams };

storage::Random stream_of(const Specification& s, std::size_t cycle, Stream stream) {
  return {s.seed, 1000000 + cycle * streams + stream};
}

std::vector<double> shifted_targets(const CycleSpec& c, storage::Random random) {
  std::vector<double> targets = c.targets;
  if (c.offset == 0.0) return targets;
  const double resolution = c.axis.rotary ? 1e-4 / deg_per_rad : 1e-6;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    double by = random.uniform(-c.offset, c.offset);
    if (i == 0) by = std::fabs(by);  // the ends stay within the range
    if (i + 1 == targets.size()) by = -std::fabs(by);
    targets[i] = std::round((targets[i] + by) / resolution) * resolution;
  }
  return targets;
}

double material(const CycleSpec::Course& c, double t) {
  const double swing = c.swing * std::sin(2.0 * std::numbers::pi * t / c.period);
  return std::round((c.start + c.drift * t + swing) * 100.0) / 100.0;
}

/// Rows of one measurement; what its file will not tell, the effects do not know either. Appended
/// to the table of its axis.
void take_readings(const CycleSpec& c, const std::vector<double>& targets, Observations& o) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  const auto line = static_cast<std::uint32_t>(o.lines.size());
  o.lines.push_back({c.measurement.id, {c.axis.rotary ? 0.0 : 1.0, 0.0, 0.0}});
  double t = 0.0;
  bool first = true;
  double last = 0.0;
  const auto sweep = [&](std::uint32_t run, double direction) {
    for (std::size_t k = 0; k < targets.size(); ++k) {
      const double at = targets[direction > 0.0 ? k : targets.size() - 1 - k];
      if (!first) t += std::fabs(at - last) / c.feed + c.dwell;
      first = false;
      last = at;
      o.axes[0].position.push_back(at);
      o.axes[0].approach.push_back(direction > 0.0 ? std::int8_t{1} : std::int8_t{-1});
      o.run.push_back(run);
      o.line.push_back(line);
      o.time.push_back(c.timed ? std::round(t * 10.0) / 10.0 : unknown);
      o.material.push_back(c.temperature ? material(*c.temperature, t) : unknown);
      o.deviation.push_back(0.0);
    }
  };
  for (std::uint32_t run = 1; run <= c.runs; ++run) {
    if (run > 1) t += c.pause;
    sweep(run, c.direction);
    if (c.pendulum) sweep(run, -c.direction);
  }
}

/// The measurements of one axis: together, because effects see the whole measured stretch.
struct AxisTable {
  Axis axis;
  std::vector<std::size_t> cycles;  ///< of the specification
  Observations table;
};

std::vector<AxisTable> tables_of(const Specification& s) {
  std::vector<AxisTable> all;
  for (std::size_t k = 0; k < s.cycles.size(); ++k) {
    const CycleSpec& c = s.cycles[k];
    auto at = std::find_if(all.begin(), all.end(),
                           [&](const AxisTable& a) { return a.axis.name == c.axis.name; });
    if (at == all.end()) {
      at = all.insert(all.end(), AxisTable{c.axis, {}, {}});
      at->table.angular = c.axis.rotary;
      at->table.axes.push_back({c.axis.name, c.axis.rotary, {}, {}});
    }
    at->cycles.push_back(k);
    take_readings(c, shifted_targets(c, stream_of(s, k, offsets)), at->table);
  }
  return all;
}

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// The columns as one: those of a curve are mixed at random and brought to their RMS.
std::vector<double> deviation_of_columns(const EffectSpec& e, const Effect::Columns& columns,
                                         storage::Random random) {
  std::vector<double> sum(columns.empty() ? 0 : columns[0].size(), 0.0);
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const double factor = e.effect.curve ? random.normal() : e.linear[k];
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += factor * columns[k][i];
  }
  if (e.effect.curve) {
    const double size = rms(sum);
    for (double& v : sum) v *= size > 0.0 ? e.linear[0] / size : 0.0;
  }
  return sum;
}

/// The shape as written, or the one that the readings and the manifest leave.
Expected<std::vector<double>> shape_of(const EffectSpec& e, const Observations& o) {
  std::vector<double> shape;
  for (std::size_t k = 0; k < e.shape.size(); ++k) {
    if (e.shape[k]) {
      shape.push_back(*e.shape[k]);
      continue;
    }
    const Effect::Shape& searched = e.effect.shapes[k];
    const std::vector<double> grid = searched.grid(o, e.axis);
    if (grid.size() != 1 && searched.usual) {
      shape.push_back(*searched.usual);
      continue;
    }
    if (grid.size() != 1)
      return fail("effect." + key_of(searched.parameter, e.axis.rotary) +
                  " is missing: " + searched.parameter.help + " of " + e.name);
    shape.push_back(grid[0]);
  }
  return shape;
}

Json parameter_json(const EffectSpec& e, const Effect::Parameter& parameter, double value) {
  const Quantity quantity = quantity_on(parameter, e.axis.rotary);
  Json json = {{"name", parameter.name}, {"value", printed(value, quantity)}};
  if (const auto symbol = unit_of(quantity).symbol; !symbol.empty()) json["unit"] = symbol;
  return json;
}

Json quantity_json(double value, bool rotary) {
  return {{"value", printed(value, deviation_of(rotary))},
          {"unit", unit_of(deviation_of(rotary)).symbol}};
}

Expected<Json> add_effect(const EffectSpec& e, Observations& o, storage::Random random) {
  if (!e.effect.applies(o, e.axis))
    return fail(e.name + " does not apply to these readings: " + e.effect.info.summary);
  const auto shape = shape_of(e, o);
  if (!shape) return fail(shape.error());
  const auto columns = e.effect.columns(o, e.axis, *shape);
  if (!columns) return fail(e.name + ": " + columns.error().message);
  if (!e.effect.curve && columns->size() != e.linear.size())
    return fail(e.name + ": its plugin gives " + std::to_string(columns->size()) + " columns for " +
                std::to_string(e.linear.size()) + " parameters");
  const std::vector<double> part = deviation_of_columns(e, *columns, random);
  for (std::size_t i = 0; i < part.size(); ++i) {
    if (!std::isfinite(part[i])) return fail(e.name + " gives no finite deviation");
    o.deviation[i] += part[i];
  }
  Json parameters = Json::array();
  for (std::size_t k = 0; k < e.linear.size(); ++k)
    parameters.push_back(parameter_json(e, e.effect.linear[k], e.linear[k]));
  for (std::size_t k = 0; k < shape->size(); ++k)
    parameters.push_back(parameter_json(e, e.effect.shapes[k].parameter, (*shape)[k]));
  return Json{{"effect", e.name},
              {"parameters", std::move(parameters)},
              {"rms", quantity_json(rms(part), e.axis.rotary)}};
}

std::string shortest(double value) {
  std::array<char, 64> buffer{};
  return {buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr};
}

/// The file of one measurement; tells in `truth` what was misread.
std::string readings(const Specification& s, std::size_t k, std::uint32_t line,
                     const Observations& o, Json& truth) {
  const CycleSpec& c = s.cycles[k];
  const bool rotary = c.axis.rotary;
  storage::Random noise_of = stream_of(s, k, noise), wrong = stream_of(s, k, misreadings);
  std::string text = std::string(simulated_mark) + "\nrun,direction," +
                     (rotary ? "target_deg,deviation_arcsec" : "target_mm,deviation_um");
  text += c.timed ? ",time_s" : "";
  text += c.temperature ? ",material_c\n" : "\n";
  std::size_t file_line = 2;
  Json misread = Json::array();
  for (std::size_t i = 0; i < o.deviation.size(); ++i) {
    if (o.line[i] != line) continue;
    ++file_line;
    double e = o.deviation[i] + c.noise * noise_of.normal();
    const bool off = wrong.uniform() < c.misread;
    const double by = (wrong.uniform() < 0.5 ? -1.0 : 1.0) * c.noise *
                      wrong.uniform(c.misread_size.first, c.misread_size.second);
    if (off) {
      e += by;
      misread.push_back({{"line", file_line}, {"by", quantity_json(by, rotary)}});
    }
    text += std::to_string(o.run[i]) + (o.axes[0].approach[i] > 0 ? ",+," : ",-,") +
            shortest(printed(o.axes[0].position[i], position_of(rotary))) + "," +
            fixed_text(printed(e, nonio::deviation_of(rotary)), 3);
    if (c.timed) text += "," + fixed_text(o.time[i], 1);
    if (c.temperature) text += "," + fixed_text(o.material[i], 2);
    text += "\n";
  }
  truth["measurements"].push_back({{"id", c.measurement.id},
                                   {"file", c.measurement.file},
                                   {"noise", quantity_json(c.noise, rotary)},
                                   {"misread", std::move(misread)}});
  return text;
}

/// The specification's own lines, with no more than one empty line in a row.
std::string manifest_text(const std::string& lines) {
  std::string text = std::string(simulated_mark) + "\n";
  for (const char c : lines)
    if (c != '\n' || !text.ends_with("\n\n")) text += c;
  while (text.ends_with("\n\n")) text.pop_back();
  return text;
}

}  // namespace

config::Checked<Simulated> simulate(std::string_view specification, const std::string& file,
                                    const std::vector<Effect>& effects) {
  const auto s = read_specification(specification, file, effects);
  if (!s) return tl::unexpected(s.error());
  std::vector<Error> errors;
  Json truth = {{"schema", "nonio-truth/1"},
                {"campaign", s->campaign.id},
                {"seed", s->seed},
                {"effects", Json::array()},
                {"measurements", Json::array()}};
  std::vector<AxisTable> tables = tables_of(*s);
  for (std::size_t k = 0; k < s->effects.size(); ++k) {
    const EffectSpec& e = s->effects[k];
    for (AxisTable& a : tables) {
      if (a.axis.name != e.axis.name) continue;
      auto said = add_effect(e, a.table, storage::Random(s->seed, k));
      if (said)
        truth["effects"].push_back(std::move(*said));
      else
        errors.push_back(Error{said.error().message, file, e.line});
    }
  }
  if (!errors.empty()) return tl::unexpected(std::move(errors));
  Simulated out;
  for (std::size_t k = 0; k < s->cycles.size(); ++k)
    for (const AxisTable& a : tables)
      for (std::size_t line = 0; line < a.cycles.size(); ++line)
        if (a.cycles[line] == k)
          out.campaign.push_back(
              {s->cycles[k].measurement.file,
               readings(*s, k, static_cast<std::uint32_t>(line), a.table, truth)});
  out.campaign.push_back({"campaign.toml", manifest_text(s->manifest)});
  out.truth = truth.dump(1) + "\n";
  return out;
}

}  // namespace nonio::host::tools
