// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>

#include "campaign/config/checks.h"
#include "campaign/config/plain_texts.h"
#include "campaign/config/toml_reader.h"
#include "nonio/sdk/format.h"
#include "platform/storage/nearest.h"

namespace nonio::config {

namespace {

const char* kind_of(const Setting& setting) {
  static constexpr const char* kinds[] = {
      "true or false",     "a whole number",  "a number",          "a text",
      "a list of numbers", "a list of texts", "tables of numbers", "a table of numbers"};
  return kinds[setting.index()];
}

Expected<void> take_entry(const std::string& entry, NumberTables& out) {
  std::istringstream words(entry);
  std::string name, word;
  if (!(words >> name)) return fail("an empty entry");
  NumberTable& table = out[name];
  while (words >> word) {
    const std::size_t equals = std::min(word.find('='), word.size());
    const std::string key = word.substr(0, equals);
    const char* const end = word.data() + word.size();
    const char* from = word.data() + std::min(equals + 1, word.size());
    if (from != end && *from == '+') ++from;
    double value = 0.0;
    const auto read = std::from_chars(from, end, value);
    if (from == end || read.ec != std::errc() || read.ptr != end || !std::isfinite(value))
      return fail("\"" + entry + "\": expected " + key + "=NUMBER, found " + word);
    const auto [first, fresh] = table.emplace(key, value);
    if (!fresh && first->second != value) {
      std::string said;
      append_shortest(said, first->second);
      return fail("axis " + name + " has " + key + "=" + said + " and " + word +
                  ": which of them?");
    }
  }
  return {};
}

}  // namespace

Expected<NumberTables> number_tables_of(const std::vector<std::string>& entries) {
  NumberTables tables;
  for (const std::string& entry : entries)
    if (auto taken = take_entry(entry, tables); !taken) return fail(taken.error());
  return tables;
}

namespace {

/// Converts whole numbers, empty lists and texts such as "X number=1" to the declared kind. Any
/// other difference of kinds is an error.
Expected<Setting> as_declared(const Setting& found, const Setting& declared) {
  if (found.index() == declared.index()) return found;
  if (const auto* i = std::get_if<std::int64_t>(&found);
      i != nullptr && std::holds_alternative<double>(declared))
    return Setting(static_cast<double>(*i));
  const auto* list = std::get_if<std::vector<std::string>>(&found);
  if (list != nullptr && list->empty() && std::holds_alternative<std::vector<double>>(declared))
    return Setting(std::vector<double>{});
  if (list != nullptr && std::holds_alternative<NumberTables>(declared)) {
    auto tables = number_tables_of(*list);
    return tables ? Expected<Setting>(Setting(std::move(*tables))) : fail(tables.error());
  }
  return fail(std::string("expected ") + kind_of(declared) + ", found " + kind_of(found));
}

std::string range_complaint(const Option& option, const Setting& setting) {
  double value = 0.0;
  if (const auto* d = std::get_if<double>(&setting))
    value = *d;
  else if (const auto* i = std::get_if<std::int64_t>(&setting))
    value = static_cast<double>(*i);
  else
    return {};
  if ((!option.min || value >= *option.min) && (!option.max || value <= *option.max)) return {};
  std::string expected = "expected";
  if (option.min) expected += " at least " + short_text(*option.min, 6);
  if (option.max)
    expected += std::string(option.min ? " and" : "") + " at most " + short_text(*option.max, 6);
  return expected + ", found " + short_text(value, 6);
}

std::string choice_complaint(const Option& option, const Setting& setting) {
  if (option.choices.empty()) return {};
  std::string found;
  if (const auto* text = std::get_if<std::string>(&setting))
    found = *text;
  else if (const auto* i = std::get_if<std::int64_t>(&setting))
    found = std::to_string(*i);
  else
    return {};
  const auto& all = option.choices;
  if (std::find(all.begin(), all.end(), found) != all.end()) return {};
  return storage::not_one_of(all, found);
}

Error wrong_option(const std::string& place, const toml::node& value, const std::string& file) {
  if (const toml::table* tables = value.as_table())
    for (const auto& [name, node] : *tables) {
      const std::string at = place + "." + std::string(name.str());
      const toml::table* entries = node.as_table();
      if (entries == nullptr)
        return {at + ": expected a table of numbers, found " + type_name(node), file,
                node.source().begin.line};
      for (const auto& [key, item] : *entries)
        if (const auto number = item.is_number() ? item.value<double>() : std::nullopt;
            !number || !std::isfinite(*number))
          return {at + "." + std::string(key.str()) + ": expected a finite number, found " +
                      type_name(item),
                  file, item.source().begin.line};
    }
  return {place + ": expected a value, found " + type_name(value), file, value.source().begin.line};
}

}  // namespace

void read_options(TableReader& top, const Key& declaration, RawOptions& options) {
  const toml::table* table = top.anything(declaration);
  if (table == nullptr) return;
  const std::string& file = top.file();
  for (const auto& [plugin, node] : *table) {
    const std::string name(plugin.str());
    const toml::table* entries = node.as_table();
    if (entries == nullptr) {
      top.error(Error{"options." + name + ": expected a table, found " + type_name(node), file,
                      node.source().begin.line});
      continue;
    }
    auto& of_plugin = options[name];
    for (const auto& [key, value] : *entries) {
      const std::uint64_t line = value.source().begin.line;
      if (auto setting = to_setting(value))
        of_plugin[std::string(key.str())] = RawOption{std::move(*setting), file, line};
      else
        top.error(wrong_option("options." + name + "." + std::string(key.str()), value, file));
    }
  }
}

Checked<Settings> settle_options(const Info& plugin, const RawOptions& site,
                                 const RawOptions& campaign, const std::vector<Option>& others) {
  Settings settings;
  std::vector<Error> errors;
  std::vector<std::string> known;
  for (const Option& option : plugin.options) {
    settings.values[option.name] = option.default_value;
    known.push_back(option.name);
  }
  for (const RawOptions* source : {&site, &campaign}) {
    const auto of_plugin = source->find(plugin.name);
    if (of_plugin == source->end()) continue;
    for (const auto& [name, raw] : of_plugin->second) {
      const std::string place = "options." + plugin.name + "." + name;
      const auto has_name = [&n = name](const Option& o) { return o.name == n; };
      const auto option = std::find_if(plugin.options.begin(), plugin.options.end(), has_name);
      if (option == plugin.options.end()) {
        if (std::any_of(others.begin(), others.end(), has_name)) continue;
        errors.push_back(Error{"unknown option " + place + storage::suggestion(name, known),
                               raw.file, raw.line});
        continue;
      }
      const auto value = as_declared(raw.value, option->default_value);
      std::string complaint = value ? range_complaint(*option, *value) : value.error().message;
      if (complaint.empty()) complaint = choice_complaint(*option, *value);
      if (complaint.empty())
        settings.values[name] = *value;
      else
        errors.push_back(Error{place + ": " + complaint, raw.file, raw.line});
    }
  }
  if (!errors.empty()) return tl::unexpected(std::move(errors));
  return settings;
}

namespace {

Expected<void> flatten(const toml::table& table, const std::string& prefix, const std::string& file,
                       Settings& out) {
  for (const auto& [key, node] : table) {
    const std::string name = prefix + std::string(key.str());
    if (const toml::table* child = node.as_table()) {
      if (auto flat = flatten(*child, name + ".", file, out); !flat) return flat;
    } else if (auto setting = to_setting(node)) {
      out.values[name] = std::move(*setting);
    } else {
      return fail(Error{name + ": expected a value or a list of one kind, found " + type_name(node),
                        file, node.source().begin.line});
    }
  }
  return {};
}

}  // namespace

Expected<Settings> parse_settings(std::string_view text, const std::string& file) {
  if (auto plain = plain_texts(text)) return std::move(*plain);
  NONIO_TRY(auto root, parse_toml(text, file));
  Settings settings;
  if (auto flat = flatten(root, "", file, settings); !flat) return fail(flat.error());
  return settings;
}

namespace {

std::vector<std::string> parted(std::string_view text) {
  std::vector<std::string> list;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    list.emplace_back(text.substr(from, comma - from));
    from = comma + 1;
  }
  return list;
}

std::optional<double> finite_number(std::string_view text) {
  const char* const end = text.data() + text.size();
  double number = 0.0;
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stop != end || !std::isfinite(number)) return {};
  return number;
}

Setting numbers_of(std::string_view text) {
  std::vector<double> numbers;
  for (const std::string& part : parted(text))
    if (const auto number = finite_number(part))
      numbers.push_back(*number);
    else
      return std::string(text);
  return numbers;
}

Setting setting_of(std::string_view text, const Option* declared) {
  if (declared != nullptr && std::holds_alternative<std::string>(declared->default_value))
    return std::string(text);
  if (declared != nullptr &&
      (std::holds_alternative<std::vector<std::string>>(declared->default_value) ||
       std::holds_alternative<NumberTables>(declared->default_value)))
    return parted(text);
  if (declared != nullptr && std::holds_alternative<std::vector<double>>(declared->default_value))
    return numbers_of(text);
  if (text == "true" || text == "false") return text == "true";
  const char* const end = text.data() + text.size();
  std::int64_t whole = 0;
  if (const auto [stop, error] = std::from_chars(text.data(), end, whole);
      error == std::errc() && stop == end)
    return whole;
  if (const auto number = finite_number(text)) return *number;
  return std::string(text);
}

}  // namespace

Checked<Settings> options_from(const Info& plugin,
                               const std::map<std::string, std::string>& texts) {
  RawOptions raw;
  for (const auto& [name, text] : texts) {
    const auto& known = plugin.options;
    const auto declared = std::find_if(known.begin(), known.end(),
                                       [&, &n = name](const Option& o) { return o.name == n; });
    raw[plugin.name][name].value = setting_of(text, declared == known.end() ? nullptr : &*declared);
  }
  return settle_options(plugin, {}, raw);
}

}  // namespace nonio::config
