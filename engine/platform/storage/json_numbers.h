// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/results.h"
#include "platform/storage/json_values.h"

namespace nonio::storage {

/// Converts to SI; the suffix of the key states the unit.
Number number_of(const std::string& key, const Json& value);
/// Returns the value that `put` wrote under this name with any unit suffix; std::nullopt without
/// such a key.
std::optional<Number> get(const Json& json, const std::string& name);

}  // namespace nonio::storage
