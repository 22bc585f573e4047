// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "nonio/host/evaluate.h"

namespace nonio::host {

/// results.json (schema nonio-results/1).
std::string results_json(const Evaluated& evaluated, const Context& context);

/// The same for a campaign whose worker did not come back.
std::string failed_results_json(const std::string& id, const std::vector<Error>& errors);

const char* to_text(Decision decision);

}  // namespace nonio::host
