// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "nonio/host/run.h"

namespace nonio::host {

/// summary.json (schema nonio-summary/1) and summary.txt of a complete night.
std::string summary_json(const Night& night, const std::string& version);
std::string summary_text(const Night& night, const std::string& version);

}  // namespace nonio::host
