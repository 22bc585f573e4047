// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <simdjson.h>

#include "laboratory/store/entry.h"

namespace nonio::store {

/// Makes an entry like `entry_of` from results.json inside another document, without its checks.
/// Throws simdjson_error and std::runtime_error.
Entry read_entry(simdjson::dom::object results, const reading::Inputs& inputs);

}  // namespace nonio::store
