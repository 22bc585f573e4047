// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "platform/storage/json_values.h"

/// What campaigns must have alike to be compared (`conditions` of results.json).
namespace nonio::assessment {

/// Why two numbers cannot be points of one series; empty: they can. A table that is switched on or
/// off is a step that is known, and no other quantity. common_stretch: other ends do not matter.
std::string difference(const storage::Json& a, const storage::Json& b, bool common_stretch);

/// No object: an empty one.
storage::Json parsed(const std::string& conditions);

/// on, off, or empty where it is not stated.
std::string compensation(const storage::Json& conditions);
bool stepped_by_table(const std::string& before, const std::string& after);

}  // namespace nonio::assessment
