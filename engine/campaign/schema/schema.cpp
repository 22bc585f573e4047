// SPDX-License-Identifier: Apache-2.0
#include "campaign/schema/schema.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <vector>

#include "campaign/config/keys.h"
#include "campaign/config/measurement_keys.h"
#include "campaign/loader/plugins.h"
#include "campaign/reading/names.h"
#include "nonio/sdk/json_writer.h"

namespace nonio::schema {

namespace {

using Holds = config::Key::Holds;
using Names = std::vector<std::string>;

std::string in_class(std::string_view letters) {
  std::string out;
  for (const char c : letters) {
    if (std::string_view("\\]^").find(c) != std::string_view::npos) out += '\\';
    if (c >= ' ') out += c;  // control characters never occur in one line of text
  }
  return out;
}

std::string quoted_pattern(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (std::string_view("\\^$.|?*+()[]{}").find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

const std::string control_letters = "\\x00-\\x1f\\x7f";

std::string pattern_of(const config::TextRule& rule) {
  const std::string letters = rule.letters.empty()
                                  ? "[^" + in_class(rule.not_letters) + control_letters + "]"
                                  : "[" + std::string(rule.letters) + "]";
  const std::string count = rule.longest == 0 ? "*"
                                              : "{" + std::to_string(rule.shortest) + "," +
                                                    std::to_string(rule.longest) + "}";
  const std::string first = rule.not_first.empty() ? "" : "(?![" + in_class(rule.not_first) + "])";
  if (rule.begins.empty()) return "^" + first + letters + count + "$";
  return "^(" + quoted_pattern(rule.begins) + letters + count + ")?$";
}

class Loaded {
 public:
  explicit Loaded(const loader::Plugins& plugins) {
    for (const Method& m : plugins.methods()) names_[config::Named::method].push_back(m.info.name);
    for (const Reader& r : plugins.readers()) add(config::Named::reader, r.info);
    for (const Analysis& a : plugins.analyses()) add(config::Named::analysis, a.info);
    for (const Output& o : plugins.outputs()) add(config::Named::output, o.info);
    for (const Controller& c : plugins.controllers()) {
      add(config::Named::output, c.info);
      names_[config::Named::control].push_back(c.info.name);
    }
    if (!names_[config::Named::analysis].empty())
      names_[config::Named::analysis].emplace_back(reading::model_fit_name);
    for (auto& [kind, names] : names_) std::sort(names.begin(), names.end());
    note_effects(plugins.effects());
  }

  const Names& names(config::Named kind) const {
    static const Names none;
    const auto found = names_.find(kind);
    return found == names_.end() ? none : found->second;
  }
  const std::map<std::string, std::vector<const Info*>>& owners() const { return owners_; }
  const std::string& effects() const { return effects_; }

 private:
  void add(config::Named kind, const Info& info) {
    names_[kind].push_back(info.name);
    owners_[info.name].push_back(&info);
  }

  void note_effects(const std::vector<Effect>& effects) {
    std::string of_axes, in_space;
    for (const Effect& e : effects) {
      std::string& list = e.instances ? in_space : of_axes;
      if (!e.is_nuisance) list += (list.empty() ? "" : "|") + quoted_pattern(e.info.name);
    }
    if (!of_axes.empty()) effects_ = "(" + of_axes + "):.+";
    if (!in_space.empty())
      effects_ += (effects_.empty() ? "(" : "|(") + in_space + "):[EXYZABC0-9]+";
    if (!effects_.empty()) effects_ = "^(" + effects_ + ")$";
  }

  std::map<config::Named, Names> names_;
  std::map<std::string, std::vector<const Info*>> owners_;
  std::string effects_;
};

class SchemaWriter {
 public:
  explicit SchemaWriter(const loader::Plugins& plugins) : loaded_(plugins) {}

  std::string write(const config::Key& file) {
    json_.begin_object();
    json_.member("$schema", "http://json-schema.org/draft-07/schema#");
    json_.member("title", std::string(file.name) + " of Nonio");
    describe(file);
    put_table(file, {});
    json_.end_object();
    return json_.take();
  }

 private:
  void describe(const config::Key& key) {
    json_.member("description", std::string(key.help) +
                                    (key.unit.empty() ? "" : " In " + std::string(key.unit) + "."));
  }

  void put_key(const config::Key& key, std::string_view assumed) {
    json_.key(key.name);
    json_.begin_object();
    describe(key);
    put_value(key, assumed);
    json_.end_object();
  }

  /// `assumed`: default that the name of the table implies for this key; empty if it implies none.
  void put_value(const config::Key& key, std::string_view assumed) {
    switch (key.holds) {
      case Holds::text:
        return put_text(key, assumed);
      case Holds::number:
        json_.member("type", "number");
        put_range(key);
        if (!key.otherwise.empty())
          json_.member("default", std::strtod(std::string(key.otherwise).c_str(), nullptr));
        return;
      case Holds::number_or_none:
        return put_number_or_none(key);
      case Holds::whole:
        return put_whole(key);
      case Holds::flag:
        return json_.member("type", "boolean");
      case Holds::date:
        json_.member("type", "string");
        return json_.member("format", "date");
      case Holds::translations:
        return put_translations(key);
      case Holds::table:
        return put_table(key, {});
      case Holds::named_tables:
        return put_named_tables(key);
      case Holds::number_table:
        json_.member("type", "object");
        json_.key("additionalProperties");
        return put_typed("number", key);
      case Holds::options:
        return put_options();
      case Holds::anything:
        return json_.member("type", "object");
      case Holds::by_kind:
        return;
      case Holds::texts:
      case Holds::numbers:
      case Holds::wholes:
      case Holds::span:
      case Holds::tables:
        return put_list(key);
    }
  }

  void put_text(const config::Key& key, std::string_view assumed) {
    json_.member("type", "string");
    Names names = loaded_.names(key.named), meanings;
    for (const config::Choice& choice : key.choices) {
      names.emplace_back(choice.name);
      if (!choice.meaning.empty()) meanings.emplace_back(choice.meaning);
    }
    if (names.empty()) {
      put_pattern(key.text);
    } else {
      if (!key.required) names.emplace_back();
      json_.member("enum", names);
    }
    if (key.required && names.empty()) json_.member("minLength", std::int64_t{1});
    if (!meanings.empty()) put_meanings(meanings);
    const std::string_view otherwise = assumed.empty() ? key.otherwise : assumed;
    if (!otherwise.empty()) json_.member("default", otherwise);
  }

  void put_meanings(const Names& meanings) {
    json_.key("x-taplo");
    json_.begin_object();
    json_.key("docs");
    json_.begin_object();
    json_.member("enumValues", meanings);
    json_.end_object();
    json_.end_object();
  }

  void put_pattern(const config::TextRule& rule) {
    json_.member("pattern", pattern_of(rule));
    if (rule.except.empty()) return;
    json_.key("not");
    json_.begin_object();
    json_.member("enum", Names(rule.except.begin(), rule.except.end()));
    json_.end_object();
  }

  void put_range(const config::Key& key) {
    if (key.least) json_.member(key.above ? "exclusiveMinimum" : "minimum", *key.least);
    if (key.most) json_.member("maximum", *key.most);
  }

  void put_number_or_none(const config::Key& key) {
    json_.key("type");
    json_.begin_array();
    json_.value("number");
    json_.value("string");
    json_.end_array();
    put_range(key);
    json_.member("pattern", "^none$");
  }

  void put_whole(const config::Key& key) {
    json_.member("type", "integer");
    json_.member("minimum", static_cast<std::int64_t>(key.least.value_or(0.0)));
    json_.member("maximum", static_cast<std::int64_t>(key.most.value_or(1e9)));
    if (!key.otherwise.empty())
      json_.member("default",
                   std::int64_t{std::strtoll(std::string(key.otherwise).c_str(), nullptr, 10)});
  }

  void put_typed(std::string_view type, const config::Key& key) {
    json_.begin_object();
    json_.member("type", type);
    put_range(key);
    json_.end_object();
  }

  void put_translations(const config::Key& key) {
    json_.key("type");
    json_.begin_array();
    json_.value("string");
    json_.value("object");
    json_.end_array();
    json_.member("pattern", pattern_of({}));
    json_.key("patternProperties");
    json_.begin_object();
    json_.key(pattern_of(key.text));
    put_typed("string", {{}, Holds::text, {}});
    json_.end_object();
    json_.member("additionalProperties", false);
  }

  void put_list(const config::Key& key) {
    json_.member("type", "array");
    if (key.holds == Holds::span) json_.member("minItems", std::int64_t{2});
    if (key.holds == Holds::tables && key.required) json_.member("minItems", std::int64_t{1});
    if (key.holds == Holds::span || key.longest_list != 0)
      json_.member("maxItems", key.holds == Holds::span
                                   ? std::int64_t{2}
                                   : static_cast<std::int64_t>(key.longest_list));
    if (key.distinct) json_.member("uniqueItems", true);
    json_.key("items");
    if (key.holds == Holds::wholes) return put_typed("integer", key);
    if (key.holds == Holds::numbers || key.holds == Holds::span) return put_typed("number", key);
    json_.begin_object();
    if (key.holds == Holds::tables)
      put_table(key, {});
    else
      put_item(key);
    json_.end_object();
  }

  void put_item(const config::Key& key) {
    json_.member("type", "string");
    if (key.named == config::Named::effect)
      json_.member("pattern", "^[^:]+:.+$");
    else if (const Names& names = loaded_.names(key.named); !names.empty())
      json_.member("enum", names);
    else if (!key.text.letters.empty())
      put_pattern(key.text);
  }

  void put_table(const config::Key& table, std::string_view assumed) {
    json_.member("type", "object");
    json_.key("properties");
    json_.begin_object();
    Names required;
    for (const config::Key& key : table.keys) {
      const bool differs = key.name == by_name_;
      put_key(key, differs ? assumed : std::string_view{});
      if (key.required && key.only.key.empty()) required.emplace_back(key.name);
    }
    json_.end_object();
    if (!required.empty()) json_.member("required", required);
    json_.member("additionalProperties", false);
    put_conditions(table, assumed);
  }

  /// taplo offers no keys next to an "allOf", so the conditions are in an unconditional "then".
  void put_conditions(const config::Key& table, std::string_view assumed) {
    const auto conditional = [&](const config::Key& key) {
      return !key.only.key.empty() || !key.needed.key.empty() ||
             (key.named == config::Named::effect && !loaded_.effects().empty());
    };
    if (std::none_of(table.keys.begin(), table.keys.end(), conditional)) return;
    json_.key("if");
    json_.begin_object();
    json_.end_object();
    json_.key("then");
    json_.begin_object();
    json_.list("allOf", table.keys, [&](const config::Key& key) {
      if (!key.needed.key.empty()) put_needed(key, assumed);
      if (!key.only.key.empty()) put_only(key, assumed);
      if (key.named == config::Named::effect && !loaded_.effects().empty()) put_effects(key);
    });
    json_.end_object();
  }

  void put_when(const config::When& when, std::string_view assumed) {
    json_.key("if");
    json_.begin_object();
    json_.key("properties");
    json_.begin_object();
    json_.key(when.key);
    json_.begin_object();
    Names values(when.values.begin(), when.values.end());
    const bool unless_said = std::find(values.begin(), values.end(), assumed) != values.end();
    if (unless_said) values.emplace_back();
    json_.member("enum", values);
    json_.end_object();
    json_.end_object();
    if (!unless_said) json_.member("required", Names{std::string(when.key)});
    json_.end_object();
  }

  void put_needed(const config::Key& key, std::string_view assumed) {
    json_.begin_object();
    put_when(key.needed, assumed);
    json_.key("then");
    json_.begin_object();
    json_.member("required", Names{std::string(key.name)});
    begin_rule_of(key);
    json_.member(key.holds == Holds::text ? "minLength" : "minProperties", std::int64_t{1});
    end_rule();
    json_.end_object();
    json_.end_object();
  }

  void put_only(const config::Key& key, std::string_view assumed) {
    json_.begin_object();
    put_when(key.only, assumed);
    if (key.required) {
      json_.key("then");
      json_.begin_object();
      json_.member("required", Names{std::string(key.name)});
      json_.end_object();
    }
    json_.key("else");
    json_.begin_object();
    begin_rule_of(key);
    // The only accepted text states why the key is not allowed.
    json_.member("enum", Names{"only where " + std::string(key.only.key) + " is " +
                               std::string(key.only.values.front())});
    end_rule();
    json_.end_object();
    json_.end_object();
  }

  void put_effects(const config::Key& key) {
    json_.begin_object();
    json_.key("if");
    json_.begin_object();
    json_.member("required", Names{"formula"});
    json_.end_object();
    json_.key("else");
    json_.begin_object();
    begin_rule_of(key);
    json_.key("items");
    json_.begin_object();
    json_.member("pattern", loaded_.effects());
    json_.end_object();
    end_rule();
    json_.end_object();
    json_.end_object();
  }

  void begin_rule_of(const config::Key& key) {
    json_.key("properties");
    json_.begin_object();
    json_.key(key.name);
    json_.begin_object();
  }
  void end_rule() {
    json_.end_object();
    json_.end_object();
  }

  void put_named_tables(const config::Key& key) {
    const config::Key& by_name = *config::find_key(key.keys, key.by_name);
    const auto other =
        std::find_if(by_name.choices.begin(), by_name.choices.end(),
                     [&](const config::Choice& c) { return c.name != key.named_so; });
    const std::string initials(key.initials);
    json_.member("type", "object");
    by_name_ = key.by_name;
    json_.key("patternProperties");
    json_.begin_object();
    put_named_table("^[" + initials + "]", key, key.named_so);
    put_named_table("^([^" + initials + "]|$)", key, other->name);
    json_.end_object();
    by_name_ = {};
    json_.member("additionalProperties", false);
  }

  void put_named_table(const std::string& pattern, const config::Key& key,
                       std::string_view assumed) {
    json_.key(pattern);
    json_.begin_object();
    describe(key);
    put_table(key, assumed);
    json_.end_object();
  }

  void put_options() {
    json_.member("type", "object");
    json_.key("properties");
    json_.begin_object();
    for (const auto& [name, infos] : loaded_.owners()) put_options_of(name, infos);
    json_.end_object();
    json_.member("additionalProperties", false);
  }

  void put_options_of(const std::string& name, const std::vector<const Info*>& infos) {
    json_.key(name);
    json_.begin_object();
    std::string summary;
    for (const Info* info : infos) summary += (summary.empty() ? "" : " ") + info->summary;
    json_.member("description", summary);
    json_.member("type", "object");
    json_.key("properties");
    json_.begin_object();
    Names seen;
    for (const Info* info : infos)
      for (const Option& option : info->options) {
        if (std::find(seen.begin(), seen.end(), option.name) != seen.end()) continue;
        seen.push_back(option.name);
        put_option(option);
      }
    json_.end_object();
    json_.member("additionalProperties", false);
    json_.end_object();
  }

  void put_option(const Option& option) {
    static constexpr std::string_view types[] = {"boolean", "integer", "number", "string",
                                                 "array",   "array",   "",       "object"};
    json_.key(option.name);
    json_.begin_object();
    json_.member("description",
                 option.help + (option.unit.empty() ? "" : " In " + option.unit + "."));
    const std::size_t kind = option.default_value.index();
    if (std::holds_alternative<NumberTables>(option.default_value))
      put_number_tables();
    else
      json_.member("type", types[kind]);
    if (kind == 4 || kind == 5) {
      json_.key("items");
      json_.begin_object();
      json_.member("type", kind == 4 ? "number" : "string");
      json_.end_object();
    } else if (kind < 4) {
      put_limits(option);
    }
    json_.key("default");
    std::visit([this](const auto& value) { put_setting(value); }, option.default_value);
    json_.end_object();
  }

  /// Texts are allowed too, because they are the former form.
  void put_number_tables() {
    json_.key("type");
    json_.begin_array();
    json_.value(std::string_view("object"));
    json_.value(std::string_view("array"));
    json_.end_array();
    json_.key("additionalProperties");
    json_.begin_object();
    json_.member("type", "object");
    json_.key("additionalProperties");
    json_.begin_object();
    json_.member("type", "number");
    json_.end_object();
    json_.end_object();
    json_.key("items");
    json_.begin_object();
    json_.member("type", "string");
    json_.end_object();
  }

  void put_limits(const Option& option) {
    const bool number = option.default_value.index() == 1 || option.default_value.index() == 2;
    if (number && option.min) json_.member("minimum", *option.min);
    if (number && option.max) json_.member("maximum", *option.max);
    if (option.choices.empty()) return;
    json_.list("enum", option.choices, [&](const std::string& choice) {
      if (option.default_value.index() == 1)
        json_.value(std::int64_t{std::strtoll(choice.c_str(), nullptr, 10)});
      else
        json_.value(std::string_view(choice));
    });
  }

  template <class T>
  void put_setting(const T& value) {
    json_.value(value);
  }
  void put_setting(const std::string& value) { json_.value(std::string_view(value)); }
  template <class T>
  void put_setting(const std::vector<T>& values) {
    json_.begin_array();
    for (const T& value : values) put_setting(value);
    json_.end_array();
  }

  void put_setting(const NumberTable& table) {
    json_.begin_object();
    for (const auto& [key, value] : table) json_.member(key, value);
    json_.end_object();
  }

  void put_setting(const NumberTables& tables) {
    json_.begin_object();
    for (const auto& [name, table] : tables) {
      json_.key(name);
      put_setting(table);
    }
    json_.end_object();
  }

  Loaded loaded_;
  JsonWriter json_;
  std::string_view by_name_;
};

}  // namespace

std::string campaign_schema(const loader::Plugins& plugins) {
  return SchemaWriter(plugins).write(config::CampaignKeys(plugins.methods()).file());
}

std::string file_schema(const config::Key& file, const loader::Plugins& plugins) {
  return SchemaWriter(plugins).write(file);
}

namespace {

std::string help_of(const config::Key& file, std::string_view path) {
  const config::Key* key = &file;
  while (key != nullptr && !path.empty()) {
    const std::size_t end = std::min(path.find('.'), path.size());
    key = config::find_key(key->keys, path.substr(0, end));
    path.remove_prefix(std::min(end + 1, path.size()));
  }
  if (key == nullptr) return {};
  const std::string help(key->help);
  return key->unit.empty() ? help : std::string(key->unit) + ": " + help;
}

}  // namespace

std::string campaign_key_help(std::string_view path) {
  return help_of(config::campaign_file(), path);
}
std::string site_key_help(std::string_view path) { return help_of(config::site_file(), path); }

}  // namespace nonio::schema
