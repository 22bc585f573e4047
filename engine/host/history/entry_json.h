// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <simdjson.h>

#include "host/history/entry.h"

namespace nonio::host::history {

/// As `entry_of`, of results.json that stands in another document. Throws simdjson_error and
/// std::runtime_error.
Entry read_entry(simdjson::dom::object results, const reading::Inputs& inputs);

}  // namespace nonio::host::history
