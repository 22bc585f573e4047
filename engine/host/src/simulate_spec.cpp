// SPDX-License-Identifier: Apache-2.0
#include "simulate_spec.h"

#include <algorithm>
#include <cmath>

#include "nonio/host/files.h"
#include "nonio/host/nearest.h"
#include "toml_reader.h"

namespace nonio::host {

Quantity quantity_on(const Effect::Parameter& parameter, bool rotary) {
  return rotary ? parameter.rotary : parameter.quantity;
}

std::string key_of(const Effect::Parameter& parameter, bool rotary) {
  return parameter.name + std::string(unit_of(quantity_on(parameter, rotary)).suffix);
}

namespace {

using Headers = std::map<std::uint64_t, std::string>;  // line -> its topmost table

void collect_headers(const toml::node& node, const std::string& top, Headers& headers) {
  if (const toml::table* table = node.as_table()) {
    if (table->is_inline()) return;
    headers.emplace(table->source().begin.line, top);
    for (const auto& [key, child] : *table) collect_headers(child, top, headers);
  } else if (const toml::array* list = node.as_array()) {
    for (const toml::node& child : *list) collect_headers(child, top, headers);
  }
}

/// The manifest in the specification: its own lines, with empty ones where the simulation's stood,
/// and for comments, which may tell what is hidden.
std::string manifest_of(std::string_view text, const toml::table& root) {
  Headers headers;
  for (const auto& [key, node] : root) collect_headers(node, std::string(key.str()), headers);
  std::string out;
  bool keep = true;
  std::uint64_t line = 1;
  for (std::size_t at = 0; at < text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
    if (const auto header = headers.find(line); header != headers.end())
      keep =
          header->second != "simulation" && header->second != "cycle" && header->second != "effect";
    const std::string_view words = text.substr(at, end - at);
    const std::size_t begin = std::min(words.find_first_not_of(" \t"), words.size() - 1);
    out += keep && words[begin] != '#' ? words : "\n";
    at = end;
  }
  return out;
}

class SpecificationReader {
 public:
  SpecificationReader(const std::string& file, const std::vector<Effect>& effects)
      : file_(file), effects_(effects) {}

  Checked<Specification> read(std::string_view text) {
    auto root = parse_toml(text, file_);
    if (!root) return tl::unexpected(std::vector<Error>{root.error()});
    Specification s;
    s.manifest = manifest_of(text, *root);
    auto manifest = parse_manifest(s.manifest, file_);
    if (!manifest) return tl::unexpected(manifest.error());
    s.campaign = std::move(manifest->campaign);
    TableReader top(*root, "", file_, errors_);
    read_seed(top, s);
    read_cycles(top, s);
    read_effects(top, s);
    if (!errors_.empty()) return tl::unexpected(std::move(errors_));
    return s;
  }

 private:
  void complain(std::uint64_t line, std::string message) {
    errors_.push_back(Error{std::move(message), file_, line});
  }

  void read_seed(TableReader& top, Specification& s) {
    const toml::table* table = top.table("simulation");
    if (table == nullptr) {
      top.error("simulation", "is missing: [simulation] with a seed");
      return;
    }
    TableReader reader(*table, "simulation", file_, errors_);
    const auto seed = reader.whole("seed");
    if (!seed) reader.error("seed", "wanted a whole number: the same seed gives the same readings");
    s.seed = static_cast<std::uint64_t>(seed.value_or(1));
    reader.finish();
  }

  std::optional<double> number(TableReader& reader, const char* key, double least, double scale) {
    const auto value = reader.number(key);
    if (!value) return {};
    if (*value >= least) return *value * scale;
    reader.error(key, "wanted a number from " + std::to_string(static_cast<int>(least)));
    return {};
  }

  void read_targets(TableReader& reader, CycleSpec& c, double unit) {
    const std::string suffix = c.axis.rotary ? "_deg" : "_mm";
    const std::string list = "targets" + suffix, from = "from" + suffix, to = "to" + suffix,
                      step = "step" + suffix;
    const auto given = reader.numbers(list.c_str());
    const auto first = reader.number(from.c_str()), last = reader.number(to.c_str()),
               distance = reader.number(step.c_str());
    const double share = number(reader, "random_offset_pct", 0.0, 0.01).value_or(0.0);
    if (share > 0.45) reader.error("random_offset_pct", "wanted at most 45, targets keep order");
    if (given) {
      if (first || last || distance) reader.error(list.c_str(), "stands beside a range");
      c.targets = *given;
    } else if (first && last && distance && *distance > 0.0 && *last > *first &&
               (*last - *first) / *distance < 1e5) {
      for (int i = 0; *first + i * *distance <= *last + 1e-9 * *distance; ++i)
        c.targets.push_back(*first + i * *distance);
    } else {
      complain(c.line, reader.place(list) + ": wanted a list of targets, or a range by " + from +
                           ", " + to + " (the larger one) and " + step);
      return;
    }
    const auto falls =
        std::adjacent_find(c.targets.begin(), c.targets.end(), std::greater_equal<>());
    if (c.targets.size() < 2 || c.targets.size() > 100000 || falls != c.targets.end()) {
      complain(c.line, reader.place(list) +
                           ": wanted 2 to 100000 targets, each larger than the "
                           "one before; found " +
                           std::to_string(c.targets.size()) + " targets");
      return;
    }
    double least = c.targets[1] - c.targets[0];
    for (std::size_t i = 1; i < c.targets.size(); ++i)
      least = std::min(least, c.targets[i] - c.targets[i - 1]);
    c.offset = share * least * unit;
    for (double& target : c.targets) target *= unit;
  }

  void read_temperature(TableReader& reader, CycleSpec& c) {
    const toml::table* table = reader.table("temperature");
    if (table == nullptr) return;
    TableReader t(*table, "cycle.temperature", file_, errors_);
    CycleSpec::Course course;
    course.start = t.number("start_c").value_or(course.start);
    course.drift = t.number("drift_K_per_h", 1.0 / 3600.0).value_or(0.0);
    course.swing = t.number("swing_K").value_or(0.0);
    course.period = t.number("period_s").value_or(course.period);
    if (!(course.period > 0.0)) t.error("period_s", "wanted a number above 0");
    t.finish();
    c.temperature = course;
  }

  void read_misreadings(TableReader& reader, CycleSpec& c) {
    const toml::table* table = reader.table("misreadings");
    if (table == nullptr) return;
    TableReader m(*table, "cycle.misreadings", file_, errors_);
    c.misread = number(m, "fraction", 0.0, 1.0).value_or(0.0);
    if (c.misread > 1.0) m.error("fraction", "wanted 0 to 1");
    if (const auto size = m.numbers("size")) {
      if (size->size() == 2 && (*size)[0] >= 0.0 && (*size)[0] <= (*size)[1])
        c.misread_size = {(*size)[0], (*size)[1]};
      else
        m.error("size", "wanted two numbers, times the noise, the smaller one first");
    }
    m.finish();
  }

  void read_order(TableReader& reader, CycleSpec& c) {
    c.pendulum = reader.choice("order", {"pendulum", "unidirectional"}) != "unidirectional";
    const std::string direction = reader.choice("direction", {"+", "-"});
    if (!direction.empty() && c.pendulum)
      reader.error("direction", "stands only beside order = \"unidirectional\"");
    c.direction = direction == "-" ? -1.0 : 1.0;
    if (const auto runs = reader.whole("runs")) {
      if (*runs < 1 || *runs > 100000) reader.error("runs", "wanted 1 to 100000");
      c.runs = static_cast<std::uint32_t>(*runs);
    }
  }

  void read_times(TableReader& reader, CycleSpec& c, double unit) {
    const char* feed = c.axis.rotary ? "feed_deg_per_min" : "feed_mm_per_min";
    c.feed = reader.number(feed, unit / 60.0).value_or(c.axis.rotary ? 0.1 : 0.05);
    if (!(c.feed > 0.0)) reader.error(feed, "wanted a number above 0");
    c.dwell = number(reader, "dwell_s", 0.0, 1.0).value_or(c.dwell);
    c.pause = number(reader, "pause_s", 0.0, 1.0).value_or(c.pause);
    c.timed = reader.flag("times").value_or(true);
  }

  CycleSpec read_cycle(const toml::table& table, const Specification& s) {
    CycleSpec c;
    c.line = table.source().begin.line;
    TableReader reader(table, "cycle", file_, errors_);
    const std::string id = reader.text("measurement", true);
    std::vector<std::string> ids;
    for (const Measurement& m : s.campaign.measurements) {
      ids.push_back(m.id);
      if (m.id == id) c.measurement = m;
    }
    if (c.measurement.id.empty()) {
      if (!id.empty())
        reader.error("measurement",
                     "no [[measurement]] has the id \"" + id + "\"" + suggestion(id, ids));
      return c;
    }
    if (c.measurement.kind != "axis")
      reader.error("measurement", "wanted a measurement of kind axis, found " + c.measurement.kind);
    if (!is_artifact_name(c.measurement.file))
      reader.error("measurement", "its file is not a plain name: " + c.measurement.file);
    if (const Axis* axis = s.campaign.machine.axis(c.measurement.axis)) c.axis = *axis;
    const double unit = c.axis.rotary ? 1.0 / deg_per_rad : 1e-3;
    read_targets(reader, c, unit);
    read_order(reader, c);
    read_times(reader, c, unit);
    c.noise = c.axis.rotary
                  ? number(reader, "noise_arcsec", 0.0, 1.0 / arcsec_per_rad).value_or(0.0)
                  : number(reader, "noise_um", 0.0, 1e-6).value_or(0.0);
    read_misreadings(reader, c);
    read_temperature(reader, c);
    reader.finish();
    return c;
  }

  void read_cycles(TableReader& top, Specification& s) {
    std::vector<CycleSpec> found;
    if (const toml::array* list = top.tables("cycle"))
      for (const toml::node& node : *list) found.push_back(read_cycle(*node.as_table(), s));
    for (const Measurement& m : s.campaign.measurements) {
      const auto is_its = [&](const CycleSpec& c) { return c.measurement.id == m.id; };
      const auto of_it = std::find_if(found.begin(), found.end(), is_its);
      if (of_it == found.end()) {
        if (errors_.empty())
          complain(top.line_of("measurement"),
                   "measurement \"" + m.id + "\" has no [[cycle]] that says how it is taken");
        continue;
      }
      const auto again = std::find_if(of_it + 1, found.end(), is_its);
      if (again != found.end())
        complain(again->line, "measurement \"" + m.id + "\" has two cycles");
      s.cycles.push_back(*of_it);
    }
  }

  /// Kind and axis by name; null with a complaint.
  const Effect* find_effect(TableReader& reader, const std::string& name, const Machine& machine,
                            Axis& axis) {
    const std::size_t colon = name.find(':');
    const std::string kind = name.substr(0, colon),
                      on = colon == std::string::npos ? "" : name.substr(colon + 1);
    std::vector<std::string> kinds, axes;
    for (const Axis& a : machine.axes) axes.push_back(a.name);
    const Effect* found = nullptr;
    for (const Effect& e : effects_) {
      kinds.push_back(e.info.name);
      if (e.info.name == kind) found = &e;
    }
    if (colon == std::string::npos)
      reader.error("name", "wanted kind:axis, \"backlash:X\"; found \"" + name + "\"");
    else if (found == nullptr)
      reader.error("name", "no effect is called \"" + kind + "\"" + suggestion(kind, kinds));
    else if (machine.axis(on) == nullptr)
      reader.error("name", "the machine has no axis \"" + on + "\"" + suggestion(on, axes));
    else
      axis = *machine.axis(on);
    return axis.name.empty() ? nullptr : found;
  }

  void read_effect(const toml::table& table, Specification& s) {
    TableReader reader(table, "effect", file_, errors_);
    EffectSpec e;
    e.line = table.source().begin.line;
    e.name = reader.text("name", true);
    if (e.name.empty()) return;
    e.effect = find_effect(reader, e.name, s.campaign.machine, e.axis);
    if (e.effect == nullptr) return;
    const auto value = [&](const Effect::Parameter& parameter) {
      const std::string key = key_of(parameter, e.axis.rotary);
      const auto written = reader.number(key.c_str());
      if (!written) return written;
      return std::optional(*written / unit_of(quantity_on(parameter, e.axis.rotary)).per_si);
    };
    for (const Effect::Parameter& parameter : e.effect->linear) {
      const auto given = value(parameter);
      const std::string key = key_of(parameter, e.axis.rotary);
      if (!given && !reader.raw().contains(key))
        complain(e.line, "effect." + key + " is missing: " + parameter.help + " of " + e.name);
      e.linear.push_back(given.value_or(0.0));
    }
    for (const Effect::Shape& shape : e.effect->shapes) e.shape.push_back(value(shape.parameter));
    reader.finish();
    s.effects.push_back(std::move(e));
  }

  void read_effects(TableReader& top, Specification& s) {
    const toml::array* list = top.tables("effect");
    if (list == nullptr) return;
    for (const toml::node& node : *list) read_effect(*node.as_table(), s);
    for (const EffectSpec& e : s.effects) {
      const bool measured = std::any_of(s.cycles.begin(), s.cycles.end(), [&](const CycleSpec& c) {
        return c.axis.name == e.axis.name;
      });
      if (!measured) complain(e.line, e.name + ": no measurement moves axis " + e.axis.name);
    }
  }

  const std::string& file_;
  const std::vector<Effect>& effects_;
  std::vector<Error> errors_;
};

}  // namespace

Checked<Specification> read_specification(std::string_view text, const std::string& file,
                                          const std::vector<Effect>& effects) {
  return SpecificationReader(file, effects).read(text);
}

}  // namespace nonio::host
