// SPDX-License-Identifier: Apache-2.0
#include "campaign/reading/context.h"

namespace nonio::reading {

std::string input_name(const std::string& file) { return "file " + file; }
std::string shared_name(const std::string& file) { return "shared " + file; }

Inputs shared_inputs(const Context& context) {
  return {{"site.toml", context.site_sha256},
          {"plugins", context.plugins_sha256},
          {"templates", context.templates_sha256},
          {"version", context.version}};
}

}  // namespace nonio::reading
