// SPDX-License-Identifier: Apache-2.0
#include "simulation/simulate_spec.h"

#include <algorithm>

#include "campaign/config/formula.h"
#include "campaign/config/formula_reader.h"
#include "campaign/config/toml_reader.h"
#include "platform/storage/nearest.h"

namespace nonio::simulation {

Quantity quantity_on(const Effect::Parameter& parameter, bool rotary) {
  return rotary ? parameter.rotary : parameter.quantity;
}

std::string key_of(const Effect::Parameter& parameter, bool rotary) {
  return parameter.name + std::string(unit_of(quantity_on(parameter, rotary)).suffix);
}

namespace {

using Headers = std::map<std::uint64_t, std::string>;  // line number -> name of its top-level table

void collect_headers(const toml::node& node, const std::string& top, Headers& headers) {
  if (const toml::table* table = node.as_table()) {
    if (table->is_inline()) return;
    headers.emplace(table->source().begin.line, top);
    for (const auto& [key, child] : *table) collect_headers(child, top, headers);
  } else if (const toml::array* list = node.as_array()) {
    for (const toml::node& child : *list) collect_headers(child, top, headers);
  }
}

/// Returns the manifest in the specification: its own lines, with empty lines in place of the
/// simulation's tables and of comments, which may reveal hidden effects.
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

/// Declaration of the keys of an [[effect]]: its name, and a number for each parameter.
class ParameterKeys {
 public:
  ParameterKeys(const Effect& effect, bool rotary) {
    for (const Effect::Parameter& p : effect.linear) names_.push_back(key_of(p, rotary));
    for (const Effect::Shape& s : effect.shapes) names_.push_back(key_of(s.parameter, rotary));
    keys_.push_back({"name", config::Key::Holds::text, {}});
    for (const std::string& name : names_) keys_.push_back({name, config::Key::Holds::number, {}});
    table_.keys = keys_;
  }
  const config::Key& table() const { return table_; }

 private:
  std::vector<std::string> names_;
  std::vector<config::Key> keys_;
  config::Key table_{"effect", config::Key::Holds::table, {}};
};

/// Reads the [[effect]] tables.
class EffectReader {
 public:
  EffectReader(Specification& s, const std::string& file, std::vector<Error>& errors)
      : s_(s), file_(file), errors_(errors) {}

  void read(config::TableReader& top) {
    for (config::TableReader& reader : top.tables("effect")) read_effect(reader);
  }

 private:
  void complain(std::uint64_t line, std::string message) {
    errors_.push_back(Error{std::move(message), file_, line});
  }

  /// Returns the effect whose kind `name` contains, and sets `axis` to its axis, except for an
  /// effect in space; null after an error is reported.
  const Effect* find_effect(config::TableReader& reader, const std::string& name, Axis& axis) {
    const std::size_t colon = name.find(':');
    const std::string kind = name.substr(0, colon),
                      on = colon == std::string::npos ? "" : name.substr(colon + 1);
    std::vector<std::string> kinds, axes;
    const Machine& machine = s_.campaign.machine;
    for (const Axis& a : machine.axes) axes.push_back(a.name);
    const Effect* found = nullptr;
    for (const Effect& e : s_.catalogue) {
      kinds.push_back(e.info.name);
      if (e.info.name == kind) found = &e;
    }
    if (colon == std::string::npos)
      reader.error("name", "expected kind:axis, \"backlash:X\"; found \"" + name + "\"");
    else if (found == nullptr)
      reader.error("name",
                   "no effect is called \"" + kind + "\"" + storage::suggestion(kind, kinds));
    else if (found->instances)
      return found;  // an effect in space: straightness:EYX
    else if (machine.axis(on) == nullptr)
      reader.error("name",
                   "the machine has no axis \"" + on + "\"" + storage::suggestion(on, axes));
    else
      axis = *machine.axis(on);
    return axis.name.empty() ? nullptr : found;
  }

  void read_effect(config::TableReader& named) {
    EffectSpec e;
    e.line = named.line();
    e.name = named.text("name");
    if (e.name.empty()) return;
    const Effect* found = find_effect(named, e.name, e.axis);
    if (found == nullptr) return;
    e.effect = *found;
    const ParameterKeys keys(e.effect, e.axis.rotary);
    config::TableReader reader = named.declared(keys.table());
    reader.text("name");
    const auto value = [&](const Effect::Parameter& parameter) {
      const auto written = reader.number(key_of(parameter, e.axis.rotary));
      if (!written) return written;
      return std::optional(*written / unit_of(quantity_on(parameter, e.axis.rotary)).per_si);
    };
    for (const Effect::Parameter& parameter : e.effect.linear) {
      const auto given = value(parameter);
      const std::string key = key_of(parameter, e.axis.rotary);
      if (!given && !reader.raw().contains(key))
        complain(e.line, "effect." + key + " is missing: " + parameter.help + " of " + e.name);
      e.linear.push_back(given.value_or(0.0));
    }
    for (const Effect::Shape& shape : e.effect.shapes) e.shape.push_back(value(shape.parameter));
    reader.finish();
    s_.effects.push_back(std::move(e));
  }

  Specification& s_;
  const std::string& file_;
  std::vector<Error>& errors_;
};

/// Reads [simulation]: the seed, rotary axes and squares. Returns its formulas, which campaign.toml
/// must not contain.
std::vector<Formula> read_simulation(config::TableReader& top, Specification& s) {
  auto reader = top.table("simulation");
  if (!reader) return {};
  const auto seed = reader->integer("seed");
  if (!seed)
    reader->error("seed", "expected a whole number: the same seed gives the same readings");
  s.seed = static_cast<std::uint64_t>(seed.value_or(1));
  std::vector<Formula> hidden;
  for (config::TableReader& formula : reader->tables("formula")) {
    formula.fill(hidden.emplace_back());
    config::check_formula(formula, hidden, s.campaign.machine);
    formula.finish();
  }
  read_things(*reader, s);
  reader->finish();
  return hidden;
}

/// Adds formulas as effects; errors of invalid formulas were reported before.
void add_formulas(const std::vector<Formula>& formulas, Specification& s, const std::string& file,
                  std::vector<Error>& errors) {
  for (const Formula& f : formulas) {
    if (std::any_of(s.catalogue.begin(), s.catalogue.end(),
                    [&](const Effect& e) { return e.info.name == f.name; }))
      errors.push_back(
          Error{"formula \"" + f.name + "\": there is an effect of this name", file, f.line});
    const Axis* axis = s.campaign.machine.axis(f.axis);
    if (axis == nullptr) continue;
    if (auto effect = config::formula_effect(f, *axis)) s.catalogue.push_back(std::move(*effect));
  }
}

}  // namespace

config::Checked<Specification> read_specification(std::string_view text, const std::string& file,
                                                  const std::vector<Effect>& effects,
                                                  const std::vector<Method>& methods) {
  auto root = config::parse_toml(text, file);
  if (!root) return tl::unexpected(std::vector<Error>{root.error()});
  Specification s;
  s.manifest = manifest_of(text, *root);
  auto manifest = config::parse_manifest(s.manifest, file, methods);
  if (!manifest) return tl::unexpected(manifest.error());
  s.campaign = std::move(manifest->campaign);
  std::vector<Error> errors;
  config::TableReader top(*root, config::specification_file(), file, errors);
  const std::vector<Formula> hidden = read_simulation(top, s);
  s.catalogue = effects;
  add_formulas(s.campaign.formulas, s, file, errors);
  add_formulas(hidden, s, file, errors);
  s.cycles = read_cycles(top, s.campaign, methods, errors);
  EffectReader(s, file, errors).read(top);
  if (!errors.empty()) return tl::unexpected(std::move(errors));
  return s;
}

}  // namespace nonio::simulation
