// SPDX-License-Identifier: Apache-2.0
#include "campaign/reading/names.h"

#include <algorithm>

namespace nonio::reading {

namespace {

const std::string& name_of(const Info& info) { return info.name; }
template <class Plugin>
const std::string& name_of(const Plugin& plugin) {
  return plugin.info.name;
}

template <class Plugin>
bool has(const std::vector<Plugin>& all, const std::string& name) {
  return std::any_of(all.begin(), all.end(), [&](const Plugin& p) { return name_of(p) == name; });
}

template <class Plugin>
void check_names(const std::vector<Plugin>& all, const char* kind, const std::string& key,
                 const std::optional<std::vector<std::string>>& names, const Context& context,
                 std::vector<Error>& errors) {
  if (!names) return;
  for (const std::string& name : *names) {
    if (has(all, name) || name == model_fit_name) continue;
    Error error{key + ": " + context.plugins->absence(kind, name)};
    error.key = key;
    locate(error, {}, context.site.lines);
    errors.push_back(std::move(error));
  }
}

}  // namespace

std::vector<Error> ownerless_options(const config::RawOptions& options,
                                     const loader::Plugins& plugins) {
  std::vector<Error> errors;
  for (const auto& [name, values] : options) {
    if (values.empty() || has(plugins.readers(), name) || has(plugins.analyses(), name) ||
        has(plugins.outputs(), name) || has(plugins.controllers(), name))
      continue;
    const config::RawOption& first = values.begin()->second;
    errors.push_back(
        Error{"options." + name + ": " + plugins.absence("plugin", name), first.file, first.line});
  }
  return errors;
}

void locate(Error& error, const config::KeyLines& manifest, const config::KeyLines& site,
            const std::string& plugin) {
  if (error.key.empty() || !error.file.empty()) return;
  error.file = config::manifest_name;
  const std::string of_plugin = "options." + plugin + ".";
  std::vector<std::string> keys{of_plugin + error.key};
  while (keys.back().rfind('.') >= of_plugin.size())
    keys.push_back(keys.back().substr(0, keys.back().rfind('.')));
  keys.push_back(error.key);
  for (const std::string& key : keys)
    for (const auto& [lines, file] :
         {std::pair(&manifest, config::manifest_name), {&site, config::site_name}})
      if (const auto found = lines->find(key); found != lines->end()) {
        error.file = file;
        error.line = found->second;
        return;
      }
}

void give_line(Error& error, const config::KeyLines& manifest,
               const std::vector<std::string>& others) {
  if (error.line != 0 || error.file.empty()) return;
  error.line = 1;
  if (error.file != config::manifest_name) return;
  const auto take = [&](std::string_view key) {
    const auto found = manifest.find(key);
    if (found != manifest.end()) error.line = found->second;
    return found != manifest.end();
  };
  std::string_view key = error.key;
  while (!key.empty() && !take(key)) {
    const std::size_t dot = key.rfind('.');
    key = key.substr(0, dot == key.npos ? 0 : dot);
  }
  if (!key.empty()) return;
  for (const std::string& other : others)
    if (take(other)) return;
}

std::vector<Error> site_mistakes(const Context& context) {
  const loader::Plugins& plugins = *context.plugins;
  std::vector<Error> errors;
  check_names(plugins.analyses(), "analysis", "run.analyses", context.site.run.analyses, context,
              errors);
  std::vector<Info> outputs;
  for (const Output& o : plugins.outputs()) outputs.push_back(o.info);
  for (const Controller& c : plugins.controllers()) outputs.push_back(c.info);
  check_names(outputs, "output", "run.outputs", context.site.run.outputs, context, errors);
  for (Error& e : ownerless_options(context.site.options, plugins)) errors.push_back(std::move(e));
  const auto check_options = [&](const auto& all) {
    for (const auto& plugin : all)
      if (auto settled = config::settle_options(plugin.info, context.site.options, {},
                                                plugins.options_of_namesakes(plugin.info));
          !settled)
        for (Error& e : settled.error()) errors.push_back(std::move(e));
  };
  check_options(plugins.readers());
  check_options(plugins.analyses());
  check_options(plugins.outputs());
  check_options(plugins.controllers());
  return errors;
}

}  // namespace nonio::reading
