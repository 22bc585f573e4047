// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>

#include "platform/storage/json_values.h"
#include "plugin_check/template_check.h"
#include "verbs.h"

namespace nonio::app {
using storage::Json;
namespace fs = std::filesystem;

int check_templates(const std::string& site, const Common& common) {
  std::vector<fs::path> folders = common.template_folders();
  if (!site.empty() && fs::is_directory(fs::path(site) / "templates"))
    folders.push_back(fs::path(site) / "templates");
  const auto found = plugin_check::check_templates(folders, common.plugin_folders());
  if (!found) return complain(text_of(found.error()));
  if (common.json) {
    Json errors = Json::array();
    for (const Error& e : found->errors)
      errors.push_back({{"file", e.file}, {"message", e.message}});
    print_json(Json{{"schema", "nonio-template-check/1"},
                    {"outputs", found->outputs},
                    {"errors", std::move(errors)}});
  } else {
    for (const Error& e : found->errors)
      std::cout << e.file << (e.file.empty() ? "" : ": ") << e.message << "\n";
    std::string outputs;
    for (const std::string& name : found->outputs) outputs += (outputs.empty() ? "" : ", ") + name;
    if (!common.quiet)
      std::cout << found->errors.size() << (found->errors.size() == 1 ? " error" : " errors")
                << " in the templates of " << outputs << "\n";
  }
  return found->errors.empty() ? exit_done : exit_failed;
}

}  // namespace nonio::app
