// SPDX-License-Identifier: Apache-2.0
// readings.json: the readings in printed units, for other programs.
#include "nonio/sdk/plugin.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>

#include "nonio/sdk/format.h"
#include "nonio/sdk/json.h"
#include "nonio/sdk/json_writer.h"

namespace nonio::json_output {
namespace {

template <class Write>
void list(JsonWriter& json, std::string_view name, std::size_t size, Write write) {
  std::string out = "[";
  for (std::size_t i = 0; i < size; ++i) {
    if (i > 0) out += ", ";
    write(out, i);
  }
  json.key(name);
  json.raw(out += ']');
}

void numbers(JsonWriter& json, const std::string& name, const std::vector<double>& si,
             Quantity quantity) {
  if (si.empty()) return;
  list(json, name, si.size(), [&](std::string& out, std::size_t i) {
    if (std::isfinite(si[i]))
      append_shortest(out, printed(si[i], quantity));
    else
      out += "null";
  });
}

void counts(JsonWriter& json, const std::string& name, const std::vector<std::uint32_t>& values) {
  if (values.empty()) return;
  list(json, name, values.size(), [&](std::string& out, std::size_t i) {
    std::array<char, 24> buffer{};
    out.append(buffer.data(),
               std::to_chars(buffer.data(), buffer.data() + buffer.size(), values[i]).ptr);
  });
}

std::string with_unit(const std::string& name, Quantity quantity) {
  return name + std::string(unit_of(quantity).suffix);
}

void directions(JsonWriter& json, const std::string& name,
                const std::vector<std::int8_t>& approach) {
  if (approach.empty()) return;
  list(json, name, approach.size(), [&](std::string& out, std::size_t i) {
    out += approach[i] > 0 ? "\"+\"" : approach[i] < 0 ? "\"-\"" : "\"\"";
  });
}

/// `target` and `direction` of a measurement of one axis; otherwise a column for each axis, and the
/// direction of sensing of each reading.
void places(JsonWriter& json, const Observations& obs) {
  if (obs.axes.size() == 1 && obs.lines.size() <= 1) {
    directions(json, "direction", obs.axes[0].approach);
    const Quantity quantity = position_of(obs.axes[0].rotary);
    numbers(json, with_unit("target", quantity), obs.axes[0].position, quantity);
    return;
  }
  for (const Observations::AxisColumn& axis : obs.axes) {
    const Quantity quantity = position_of(axis.rotary);
    numbers(json, with_unit(axis.axis, quantity), axis.position, quantity);
    directions(json, axis.axis + "_dir", axis.approach);
  }
  const auto line_of = [&](std::size_t i) -> std::size_t {
    return obs.line.empty() ? 0 : obs.line[i];
  };
  for (std::size_t k = 0; k < 3; ++k)
    list(json, std::string("n") + "xyz"[k], obs.size(), [&](std::string& out, std::size_t i) {
      append_shortest(out, line_of(i) < obs.lines.size() ? obs.lines[line_of(i)].sense[k] : 0.0);
    });
  list(json, "line", obs.size(), [&](std::string& out, std::size_t i) {
    out += json_text(line_of(i) < obs.lines.size() ? obs.lines[line_of(i)].name : "");
  });
}

void readings(JsonWriter& json, const Observations& obs) {
  if (obs.size() == 0) return;
  const Quantity deviation = obs.angular ? Quantity::angular_deviation : Quantity::deviation;
  counts(json, "run", obs.run);
  places(json, obs);
  numbers(json, with_unit("deviation", deviation), obs.deviation, deviation);
  numbers(json, with_unit("u", deviation), obs.u, deviation);
  numbers(json, "time_s", obs.time, Quantity::time);
  numbers(json, "material_c", obs.material, Quantity::temperature);
  numbers(json, "air_c", obs.air, Quantity::temperature);
  numbers(json, "pressure_hpa", obs.pressure, Quantity::number);
  numbers(json, "humidity_pct", obs.humidity, Quantity::number);
  counts(json, "source_line", obs.source_line);
}

void measurement(JsonWriter& json, const Measurement& m, const Observations& obs,
                 const Templates& templates) {
  json.begin_object();
  json.member("id", m.id);
  json.member("kind", method_name(m));
  if (!m.axis.empty()) json.member("axis", m.axis);
  if (!m.lateral.empty())
    json.member(m.kind.starts_with("artefact") ? "artefact" : "lateral", m.lateral);
  json.member("file", m.file);
  if (obs.size() > 0) {
    const bool rotary = !obs.axes.empty() && obs.axes[0].rotary;
    json.key("units");
    json.begin_object();
    json.member("target", unit_of(position_of(rotary)).symbol);
    json.member("deviation", unit_of(deviation_of(obs.angular)).symbol);
    json.end_object();
  }
  json.member("missing", static_cast<std::uint64_t>(obs.missing));
  if (!obs.notes.empty())
    list(json, "notes", obs.notes.size(), [&](std::string& to, std::size_t i) {
      to += json_text(remark_text(templates, "en", obs.notes[i]));
    });
  json.key("readings");
  json.begin_object();
  readings(json, obs);
  json.end_object();
  json.end_object();
}

Expected<OutputResult> write(const OutputInput& input) {
  const std::vector<Measurement>& measurements = input.campaign.measurements;
  if (input.observations.size() != measurements.size())
    return fail("expected observations of each of the " + std::to_string(measurements.size()) +
                " measurements, found " + std::to_string(input.observations.size()));
  JsonWriter json;
  json.begin_object();
  json.member("schema", "nonio-readings/1");
  json.member("campaign", input.campaign.id);
  json.key("measurements");
  json.begin_array();
  for (std::size_t i = 0; i < measurements.size(); ++i)
    measurement(json, measurements[i], input.observations[i], input.templates);
  json.end_array();
  json.end_object();
  OutputResult result;
  result.artifacts.push_back({"readings.json", json.take()});
  return result;
}

}  // namespace

NONIO_PLUGIN(registry) {
  Output output;
  output.info = {"json", "1.0", "The readings as columns in a JSON file, for other programs."};
  output.applies = [](const Campaign&) { return true; };
  output.write = write;
  registry.add(std::move(output));
}

}  // namespace nonio::json_output
