// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <memory>

#include "campaign/loader/plugins.h"
#include "nonio/sdk/method.h"
#include "platform/storage/json_values.h"
#include "platform/storage/nearest.h"
#include "text_layout.h"
#include "verbs.h"

namespace nonio::app {
using storage::Json;

namespace {

Json option_json(const Option& o) {
  Json json = {{"name", o.name}};
  std::visit([&](const auto& v) { json["default"] = v; }, o.default_value);
  if (!o.unit.empty()) json["unit"] = o.unit;
  if (!o.choices.empty()) json["choices"] = o.choices;
  if (o.required) json["required"] = true;
  json["help"] = o.help;
  return json;
}

struct Listed {
  const char* kind;
  const Info* info;
  const Method* method = nullptr;
};

struct ListWish {
  std::vector<std::string> names;
  bool all = false;
};

std::vector<Listed> all_of(const loader::Plugins& plugins) {
  std::vector<Listed> all;
  for (const auto& p : plugins.methods()) all.push_back({"method", &p.info, &p});
  for (const auto& p : plugins.readers()) all.push_back({"reader", &p.info});
  for (const auto& p : plugins.effects()) all.push_back({"effect", &p.info});
  for (const auto& p : plugins.analyses()) all.push_back({"analysis", &p.info});
  for (const auto& p : plugins.outputs()) all.push_back({"output", &p.info});
  for (const auto& p : plugins.controllers()) all.push_back({"controller", &p.info});
  return all;
}

void print_plugins_json(const loader::Plugins& plugins, const std::vector<Listed>& listed) {
  Json files = Json::array(), all = Json::array();
  for (const loader::PluginFile& f : plugins.files()) {
    Json file = {{"path", f.path.string()}, {"plugins", f.brought}};
    if (!f.refused.empty()) file["refused"] = f.refused;
    files.push_back(std::move(file));
  }
  for (const Listed& p : listed) {
    Json options = Json::array();
    for (const Option& o : p.info->options) options.push_back(option_json(o));
    all.push_back({{"kind", p.kind},
                   {"name", p.info->name},
                   {"version", p.info->version},
                   {"summary", p.info->summary},
                   {"on_request", p.info->opt_in},
                   {"options", std::move(options)}});
    if (p.method == nullptr) continue;
    Json columns = Json::array();
    for (const Method::Column& c : p.method->columns)
      columns.push_back({{"name", name_in_file(c)}, {"required", c.required}, {"help", c.help}});
    all.back()["columns"] = std::move(columns);
  }
  print_json(
      Json{{"abi", NONIO_ABI_TAG}, {"files", std::move(files)}, {"plugins", std::move(all)}});
}

void print_options(const Listed& p, std::size_t width) {
  std::cout << "    version " << p.info->version << "\n";
  for (const Option& o : p.info->options)
    std::cout << "    "
              << (p.method != nullptr ? "[[measurement]]" : "[options." + p.info->name + "]") << " "
              << o.name << (o.required ? " (required)" : " = " + option_json(o)["default"].dump())
              << (o.unit.empty() ? "" : " " + o.unit) << "\n"
              << wrapped(o.help, 8, width);
  if (p.method == nullptr) return;
  for (const Method::Column& c : p.method->columns)
    std::cout << "    column " << name_in_file(c) << (c.required ? "" : " (optional)") << "\n"
              << wrapped(c.help, 8, width);
}

void print_files(const std::vector<loader::PluginFile>& files, bool all) {
  std::size_t loaded = 0;
  for (const loader::PluginFile& f : files) {
    if (f.refused.empty()) ++loaded;
    if (f.refused.empty() && !all) continue;
    std::cout << f.path.string() << "\n";
    if (!f.refused.empty()) std::cout << "  rejected: " << f.refused << "\n";
    for (const std::string& plugin : f.brought) std::cout << "  " << plugin << "\n";
  }
  std::cout << loaded << " of " << files.size() << " plugin files loaded (ABI " << NONIO_ABI_TAG
            << ")\n";
}

void print_plugins(const std::vector<Listed>& listed, bool with_options) {
  const std::size_t width = line_width(STDOUT_FILENO);
  std::size_t longest = 0;
  for (const Listed& p : listed) longest = std::max(longest, p.info->name.size());
  for (const Listed& p : listed) {
    const std::size_t column = 12 + longest + 2;
    const std::string name = padded(p.kind, 12) + padded(p.info->name, longest + 2);
    std::cout << name
              << wrapped(p.info->summary + (p.info->opt_in ? " (on request)" : ""), column, width)
                     .substr(column);
    if (with_options) print_options(p, width);
  }
}

int list_plugins(const ListWish& wish, const Common& common) {
  loader::Plugins plugins;
  plugins.load(common.plugin_folders());
  std::vector<Listed> listed = all_of(plugins);
  for (const std::string& name : wish.names)
    if (std::none_of(listed.begin(), listed.end(),
                     [&](const Listed& p) { return p.info->name == name; })) {
      std::vector<std::string> known;
      for (const Listed& p : listed) known.push_back(p.info->name);
      return complain("there is no plugin " + name + storage::suggestion(name, known));
    }
  if (!wish.names.empty())
    std::erase_if(listed, [&](const Listed& p) {
      return std::find(wish.names.begin(), wish.names.end(), p.info->name) == wish.names.end();
    });
  if (common.json) {
    print_plugins_json(plugins, listed);
  } else {
    print_plugins(listed, wish.all || !wish.names.empty());
    if (wish.names.empty()) print_files(plugins.files(), wish.all);
  }
  for (const std::string& conflict : plugins.conflicts()) complain(conflict);
  if (!plugins.conflicts().empty()) return exit_usage;
  const auto refused = [](const loader::PluginFile& f) { return !f.refused.empty(); };
  return std::any_of(plugins.files().begin(), plugins.files().end(), refused) ? exit_failed
                                                                              : exit_done;
}

}  // namespace

Verb plugin_list_verb(Common& common) {
  auto wish = std::make_shared<ListWish>();
  return {
      .name = "list",
      .summary = "Lists the loaded plugins, and rejected files with the reason",
      .arguments = joined({{"NAME", &wish->names, "Only plugins of this name, with their options"},
                           {"--all", &wish->all, "Options of every plugin, and the files"}},
                          common_arguments(common)),
      .examples = {"nonio plugin list", "nonio plugin list csv"},
      .run = [wish, &common] { return list_plugins(*wish, common); }};
}

}  // namespace nonio::app
