// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "campaign/evaluation/evaluate.h"
#include "campaign/evaluation/record.h"
#include "nonio/sdk/json_writer.h"
#include "platform/storage/json_values.h"

namespace nonio::evaluation {

/// Returns results.json (schema nonio-results/1).
std::string results_json(const Evaluated& evaluated, const reading::Context& context,
                         const std::vector<RecordedFile>& files);
/// For output files that were not stored.
std::string results_json(const Evaluated& evaluated, const reading::Context& context);

const char* to_text(Decision decision);

void put_certificate(JsonWriter& json, const Certificate& certificate);
Certificate certificate_of(const storage::Json& json);

}  // namespace nonio::evaluation
