// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "campaign/evaluation/evaluate.h"
#include "nonio/sdk/json_writer.h"
#include "platform/storage/json_values.h"

namespace nonio::evaluation {

void put_certificate(JsonWriter& json, const Certificate& certificate);
Certificate certificate_of(const storage::Json& json);

}  // namespace nonio::evaluation
