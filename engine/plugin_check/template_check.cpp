// SPDX-License-Identifier: Apache-2.0
#include "plugin_check/template_check.h"

#include "campaign/config/site_files.h"
#include "campaign/config/template_files.h"
#include "campaign/loader/plugins.h"
#include "platform/process/guarded.h"

namespace nonio::plugin_check {
namespace fs = std::filesystem;

Expected<TemplateCheck> check_templates(const std::vector<fs::path>& template_folders,
                                        const std::vector<fs::path>& plugin_folders) {
  NONIO_TRY(const auto templates, config::read_templates(template_folders));
  loader::Plugins plugins;
  plugins.load(plugin_folders);
  if (!plugins.conflicts().empty()) return fail(plugins.conflicts().front());
  TemplateCheck check;
  for (const Output& output : plugins.outputs()) {
    if (output.check_templates == nullptr) continue;
    check.outputs.push_back(output.info.name);
    const auto errors = process::guarded(
        "output " + output.info.name,
        [&]() -> Expected<std::vector<Error>> { return output.check_templates(templates); });
    if (!errors)
      check.errors.push_back(errors.error());
    else
      check.errors.insert(check.errors.end(), errors->begin(), errors->end());
  }
  return check;
}

}  // namespace nonio::plugin_check
