// SPDX-License-Identifier: Apache-2.0
// readings.json: what was read, in printed units, for other programs.
#include "nonio/sdk/plugin.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "nonio/sdk/format.h"
#include "nonio/sdk/json.h"

namespace nonio::json_output {
namespace {

void append_count(std::string& out, std::uint64_t value) {
  std::array<char, 24> buffer{};
  out.append(buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr);
}

/// An object whose members stand each on a line of its own; a column of readings is one member.
/// Written directly: a tree of one node a number takes about three times as long.
class Object {
 public:
  Object(std::string& out, std::string indent) : out_(out), indent_(std::move(indent)) {
    out_ += '{';
  }
  void close() { out_ += "\n" + indent_ + "}"; }

  std::string& member(std::string_view name) {
    out_ += first_ ? "\n" : ",\n";
    first_ = false;
    out_ += indent_ + " " + json_text(name) + ": ";
    return out_;
  }
  void text(std::string_view name, std::string_view value) { member(name) += json_text(value); }

  /// `[a, b, c]`, each entry appended by write(out, i).
  template <class Write>
  void list(std::string_view name, std::size_t size, Write write) {
    member(name) += '[';
    for (std::size_t i = 0; i < size; ++i) {
      if (i > 0) out_ += ", ";
      write(out_, i);
    }
    out_ += ']';
  }
  /// null where a value is not known.
  void numbers(const std::string& name, const std::vector<double>& si, Quantity quantity) {
    if (si.empty()) return;
    list(name, si.size(), [&](std::string& out, std::size_t i) {
      if (std::isfinite(si[i]))
        append_shortest(out, printed(si[i], quantity));
      else
        out += "null";
    });
  }
  void counts(const std::string& name, const std::vector<std::uint32_t>& values) {
    if (values.empty()) return;
    list(name, values.size(),
         [&](std::string& out, std::size_t i) { append_count(out, values[i]); });
  }

 private:
  std::string& out_;
  std::string indent_;
  bool first_ = true;
};

std::string with_unit(const std::string& name, Quantity quantity) {
  return name + std::string(unit_of(quantity).suffix);
}

void directions(Object& to, const std::string& name, const std::vector<std::int8_t>& approach) {
  if (approach.empty()) return;
  to.list(name, approach.size(), [&](std::string& out, std::size_t i) {
    out += approach[i] > 0 ? "\"+\"" : approach[i] < 0 ? "\"-\"" : "\"\"";
  });
}

/// `target` and `direction` of a measurement of one axis; otherwise a column for each axis, and
/// the direction of sensing of each reading (the general form).
void places(Object& to, const Observations& obs) {
  if (obs.axes.size() == 1 && obs.lines.size() <= 1) {
    directions(to, "direction", obs.axes[0].approach);
    const Quantity quantity = position_of(obs.axes[0].rotary);
    to.numbers(with_unit("target", quantity), obs.axes[0].position, quantity);
    return;
  }
  for (const Observations::AxisColumn& axis : obs.axes) {
    const Quantity quantity = position_of(axis.rotary);
    to.numbers(with_unit(axis.axis, quantity), axis.position, quantity);
    directions(to, axis.axis + "_dir", axis.approach);
  }
  const auto line_of = [&](std::size_t i) -> std::size_t {
    return obs.line.empty() ? 0 : obs.line[i];
  };
  for (std::size_t k = 0; k < 3; ++k)
    to.list(std::string("n") + "xyz"[k], obs.size(), [&](std::string& out, std::size_t i) {
      append_shortest(out, line_of(i) < obs.lines.size() ? obs.lines[line_of(i)].sense[k] : 0.0);
    });
  to.list("line", obs.size(), [&](std::string& out, std::size_t i) {
    out += json_text(line_of(i) < obs.lines.size() ? obs.lines[line_of(i)].name : "");
  });
}

void readings(Object& to, const Observations& obs) {
  if (obs.size() == 0) return;
  const Quantity deviation = obs.angular ? Quantity::angular_deviation : Quantity::deviation;
  to.counts("run", obs.run);
  places(to, obs);
  to.numbers(with_unit("deviation", deviation), obs.deviation, deviation);
  to.numbers(with_unit("u", deviation), obs.u, deviation);
  to.numbers("time_s", obs.time, Quantity::time);
  to.numbers("material_c", obs.material, Quantity::temperature);
  to.numbers("air_c", obs.air, Quantity::temperature);
  to.numbers("pressure_hpa", obs.pressure, Quantity::number);
  to.numbers("humidity_pct", obs.humidity, Quantity::number);
  to.counts("source_line", obs.source_line);
}

void measurement(std::string& out, const Measurement& m, const Observations& obs,
                 const Templates& templates) {
  Object object(out, "  ");
  object.text("id", m.id);
  object.text("kind", m.kind);
  if (!m.axis.empty()) object.text("axis", m.axis);
  if (!m.lateral.empty())
    object.text(m.kind.starts_with("artefact") ? "artefact" : "lateral", m.lateral);
  object.text("file", m.file);
  if (obs.size() > 0) {
    const bool rotary = !obs.axes.empty() && obs.axes[0].rotary;
    Object units(object.member("units"), "   ");
    units.text("target", unit_of(position_of(rotary)).symbol);
    units.text("deviation", unit_of(deviation_of(obs.angular)).symbol);
    units.close();
  }
  append_count(object.member("missing"), obs.missing);
  if (!obs.notes.empty())
    object.list("notes", obs.notes.size(), [&](std::string& to, std::size_t i) {
      to += json_text(remark_text(templates, "en", obs.notes[i]));
    });
  Object columns(object.member("readings"), "   ");
  readings(columns, obs);
  columns.close();
  object.close();
}

Expected<OutputResult> write(const OutputInput& input) {
  const std::vector<Measurement>& measurements = input.campaign.measurements;
  if (input.observations.size() != measurements.size())
    return fail("expected observations of each of the " + std::to_string(measurements.size()) +
                " measurements, found " + std::to_string(input.observations.size()));
  std::string out;
  Object file(out, "");
  file.text("schema", "nonio-readings/1");
  file.text("campaign", input.campaign.id);
  file.member("measurements") += '[';
  for (std::size_t i = 0; i < measurements.size(); ++i) {
    out += i == 0 ? "\n  " : ",\n  ";
    measurement(out, measurements[i], input.observations[i], input.templates);
  }
  out += "\n ]";
  file.close();
  out += '\n';
  OutputResult result;
  result.artifacts.push_back({"readings.json", std::move(out)});
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
