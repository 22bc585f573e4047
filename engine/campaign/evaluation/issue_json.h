// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "campaign/evaluation/evaluate.h"
#include "nonio/sdk/json_writer.h"
#include "platform/storage/json_values.h"

namespace nonio::evaluation {

/// The key `certificate` of results.json: all that a certificate prints in addition to the results.
void put_certificate(JsonWriter& json, const Certificate& certificate);
/// Its content; what is missing stays empty.
Certificate certificate_of(const storage::Json& json);

}  // namespace nonio::evaluation
