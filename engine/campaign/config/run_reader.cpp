// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "campaign/config/checks.h"
#include "campaign/config/toml_reader.h"

namespace nonio::config {

namespace {

/// What is not a valid setting in an option: of a table, its first key that is not a number.
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

}  // namespace nonio::config
