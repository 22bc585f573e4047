// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "nonio/sdk/error.h"

namespace nonio::reading {

/// Returns, for example, "campaign.toml:12 (target_mm): ...".
std::string text_of(const Error& error);

}  // namespace nonio::reading
