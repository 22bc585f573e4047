// SPDX-License-Identifier: Apache-2.0
#include "host/plugin_check/template_check.h"

#include "host/config/site_files.h"
#include "host/config/template_files.h"
#include "host/loader/plugins.h"
#include "host/process/guarded.h"

namespace nonio::host::plugin_check {
namespace fs = std::filesystem;

Expected<TemplateCheck> check_templates(const std::vector<fs::path>& template_folders,
                                        const std::vector<fs::path>& plugin_folders) {
  std::string digest;
  const auto templates = config::read_templates(template_folders, digest);
  if (!templates) return fail(templates.error());
  loader::Plugins plugins;
  plugins.load(plugin_folders);
  if (!plugins.conflicts().empty()) return fail(plugins.conflicts().front());
  TemplateCheck check;
  for (const Output& output : plugins.outputs()) {
    if (output.check_templates == nullptr) continue;
    check.outputs.push_back(output.info.name);
    const auto errors = process::guarded(
        "output " + output.info.name,
        [&]() -> Expected<std::vector<Error>> { return output.check_templates(*templates); });
    if (!errors)
      check.errors.push_back(errors.error());
    else
      check.errors.insert(check.errors.end(), errors->begin(), errors->end());
  }
  return check;
}

}  // namespace nonio::host::plugin_check
