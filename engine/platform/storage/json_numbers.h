// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nonio/sdk/results.h"
#include "platform/storage/json_values.h"

namespace nonio::storage {

/// Returns a value of an object as a number in SI; the suffix of its key states its unit.
Number number_of(const std::string& key, const Json& value);
/// Returns the value that `put` wrote under this name, in whatever unit; none if it wrote none.
std::optional<Number> get(const Json& json, const std::string& name);

}  // namespace nonio::storage
