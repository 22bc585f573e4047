// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <simdjson.h>

#include "laboratory/store/entry.h"

namespace nonio::store {

/// Like `entry_of`, for results.json inside another document and without its checks. Throws
/// simdjson_error and std::runtime_error.
Entry read_entry(simdjson::dom::object results, const reading::Inputs& inputs);

}  // namespace nonio::store
