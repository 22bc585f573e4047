// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "nonio/host/evaluate.h"
#include "nonio/host/record.h"

namespace nonio::host {

/// results.json (schema nonio-results/1); `files` are the artifacts of all outputs in their order.
std::string results_json(const Evaluated& evaluated, const Context& context,
                         const std::vector<RecordedFile>& files);

const char* to_text(Decision decision);

}  // namespace nonio::host
