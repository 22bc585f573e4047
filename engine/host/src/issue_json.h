// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "json_values.h"
#include "json_writer.h"
#include "nonio/host/evaluate.h"

namespace nonio::host {

/// The key `certificate` of results.json: all that a certificate prints beside the results.
void put_certificate(JsonWriter& json, const Certificate& certificate);
/// What it said; what is not there stays empty.
Certificate certificate_of(const Json& json);

}  // namespace nonio::host
