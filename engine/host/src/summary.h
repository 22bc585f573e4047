// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "nonio/host/run.h"

namespace nonio::host {

struct Summary {
  std::string text;  ///< summary.txt
  std::string json;  ///< summary.json, schema nonio-summary/1
};

/// Of a complete night. The findings come from the campaigns' records in `out`, one at a time.
Summary summary(const Night& night, const std::filesystem::path& out, const std::string& version);

}  // namespace nonio::host
