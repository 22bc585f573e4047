// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <iostream>

#include "campaign/loader/plugins.h"
#include "nonio/sdk/method.h"
#include "platform/storage/json_values.h"
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

void print_plugins_json(const loader::Plugins& plugins) {
  Json files = Json::array(), all = Json::array();
  for (const loader::PluginFile& f : plugins.files()) {
    Json file = {{"path", f.path.string()}, {"plugins", f.brought}};
    if (!f.refused.empty()) file["refused"] = f.refused;
    files.push_back(std::move(file));
  }
  for (const Listed& p : all_of(plugins)) {
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

void print_plugins(const loader::Plugins& plugins, bool with_options) {
  const std::size_t width = line_width(STDOUT_FILENO);
  for (const Listed& p : all_of(plugins)) {
    std::cout << p.kind << " " << p.info->name << " " << p.info->version
              << (p.info->opt_in ? " (on request)" : "") << "\n"
              << wrapped(p.info->summary, 4, width);
    if (with_options)
      for (const Option& o : p.info->options)
        std::cout << "    "
                  << (p.method != nullptr ? "[[measurement]]" : "[options." + p.info->name + "]")
                  << " " << o.name
                  << (o.required ? " (required)" : " = " + option_json(o)["default"].dump())
                  << (o.unit.empty() ? "" : " " + o.unit) << "\n"
                  << wrapped(o.help, 8, width);
    if (!with_options || p.method == nullptr) continue;
    for (const Method::Column& c : p.method->columns)
      std::cout << "    column " << name_in_file(c) << (c.required ? "" : " (optional)") << "\n"
                << wrapped(c.help, 8, width);
  }
  std::cout << "\nfiles (ABI " << NONIO_ABI_TAG << ")\n";
  for (const loader::PluginFile& f : plugins.files()) {
    std::cout << "  " << f.path.string() << (f.refused.empty() ? "" : "\n    refused: " + f.refused)
              << "\n";
    for (const std::string& plugin : f.brought) std::cout << "    " << plugin << "\n";
  }
}

int list_plugins(const Common& common) {
  loader::Plugins plugins;
  plugins.load(common.plugin_folders());
  if (common.json)
    print_plugins_json(plugins);
  else
    print_plugins(plugins, !common.quiet);
  for (const std::string& conflict : plugins.conflicts()) complain(conflict);
  if (!plugins.conflicts().empty()) return exit_usage;
  const auto refused = [](const loader::PluginFile& f) { return !f.refused.empty(); };
  return std::any_of(plugins.files().begin(), plugins.files().end(), refused) ? exit_failed
                                                                              : exit_done;
}

}  // namespace

Verb plugin_list_verb(Common& common) {
  return {.name = "list",
          .summary = "Lists loaded plugins with their options, and rejected ones with the reason",
          .arguments = common_arguments(common),
          .examples = {"nonio plugin list --quiet"},
          .run = [&common] { return list_plugins(common); }};
}

}  // namespace nonio::app
