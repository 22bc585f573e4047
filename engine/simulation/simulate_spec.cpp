// SPDX-License-Identifier: Apache-2.0
#include "simulation/simulate_spec.h"

#include <algorithm>

#include "campaign/config/formula.h"
#include "campaign/config/formula_reader.h"
#include "platform/storage/nearest.h"

namespace nonio::simulation {

Quantity quantity_on(const Effect::Parameter& parameter, bool rotary) {
  return rotary ? parameter.rotary : parameter.quantity;
}

std::string key_of(const Effect::Parameter& parameter, bool rotary) {
  return parameter.name + std::string(unit_of(quantity_on(parameter, rotary)).suffix);
}

namespace {

using Headers = std::map<std::uint64_t, std::string>;

void collect_headers(const toml::node& node, const std::string& top, Headers& headers) {
  if (const toml::table* table = node.as_table()) {
    if (table->is_inline()) return;
    headers.emplace(table->source().begin.line, top);
    for (const auto& [key, child] : *table) collect_headers(child, top, headers);
  } else if (const toml::array* list = node.as_array()) {
    for (const toml::node& child : *list) collect_headers(child, top, headers);
  }
}

/// Returns the specification with empty lines in place of the simulation's tables and of comments,
/// which may reveal hidden effects.
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

/// Sets the axis of the effect, except for an effect in space; returns null after an error is
/// reported.
const Effect* find_effect(config::TableReader& reader, EffectSpec& e, const Specification& s) {
  const std::size_t colon = e.name.find(':');
  const std::string kind = e.name.substr(0, colon),
                    on = colon == std::string::npos ? "" : e.name.substr(colon + 1);
  std::vector<std::string> kinds, axes;
  const Machine& machine = s.campaign.machine;
  for (const Axis& a : machine.axes) axes.push_back(a.name);
  const Effect* found = nullptr;
  for (const Effect& one : s.catalogue) {
    kinds.push_back(one.info.name);
    if (one.info.name == kind) found = &one;
  }
  if (colon == std::string::npos)
    reader.error("name", "expected kind:axis, \"backlash:X\"; found \"" + e.name + "\"");
  else if (found == nullptr)
    reader.error("name", "no effect is called \"" + kind + "\"" + storage::suggestion(kind, kinds));
  else if (found->instances)
    return found;
  else if (machine.axis(on) == nullptr)
    reader.error("name", "the machine has no axis \"" + on + "\"" + storage::suggestion(on, axes));
  else
    e.axis = *machine.axis(on);
  return e.axis.name.empty() ? nullptr : found;
}

void add_formulas(const std::vector<Formula>& formulas, Specification& s,
                  config::TableReader& reader) {
  for (const Formula& f : formulas) {
    if (std::any_of(s.catalogue.begin(), s.catalogue.end(),
                    [&](const Effect& e) { return e.info.name == f.name; }))
      reader.error(Error{"formula \"" + f.name + "\": there is an effect of this name",
                         reader.file(), f.line});
    const Axis* axis = s.campaign.machine.axis(f.axis);
    if (axis == nullptr) continue;
    if (auto effect = config::formula_effect(f, *axis)) s.catalogue.push_back(std::move(*effect));
  }
}

}  // namespace

void read_effects(config::TableReader& top, const config::Key& key, std::vector<EffectSpec>& all,
                  Specification& s) {
  for (config::TableReader& named : top.tables(key)) {
    EffectSpec e;
    e.line = named.line();
    named.fill(e);
    const Effect* const found = e.name.empty() ? nullptr : find_effect(named, e, s);
    if (found == nullptr) continue;
    e.effect = *found;
    const ParameterKeys keys(e.effect, e.axis.rotary);
    config::TableReader reader = named.declared(keys.table());
    const config::Key* declared = keys.table().keys.data();
    config::value_of<std::string>(reader, *declared);
    const auto value = [&](const Effect::Parameter& parameter) {
      auto written = config::value_of<double>(reader, *++declared);
      if (written) *written /= unit_of(quantity_on(parameter, e.axis.rotary)).per_si;
      return written;
    };
    for (const Effect::Parameter& parameter : e.effect.linear) {
      const auto given = value(parameter);
      const std::string name(declared->name);
      if (!given && !reader.contains(name))
        reader.error(Error{"effect." + name + " is missing: " + parameter.help + " of " + e.name,
                           reader.file(), e.line});
      e.linear.push_back(given.value_or(0.0));
    }
    for (const Effect::Shape& shape : e.effect.shapes) e.shape.push_back(value(shape.parameter));
    reader.finish();
    all.push_back(std::move(e));
  }
}

void check_hidden(config::TableReader& reader, Formula&, Specification& s) {
  config::check_formula(reader, s.hidden, s.campaign.machine);
}

void check_simulation(config::TableReader& reader, Specification& s) {
  add_formulas(s.hidden, s, reader);
}

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
  config::TableReader top(*root, specification_file(), file, errors);
  s.catalogue = effects;
  s.methods = &methods;
  add_formulas(s.campaign.formulas, s, top);
  top.fill(s);
  if (!errors.empty()) return tl::unexpected(std::move(errors));
  return s;
}

}  // namespace nonio::simulation
