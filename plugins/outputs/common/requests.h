// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "programs.h"

namespace nonio::programs {

/// What the options ask for, made into paths.
Expected<std::vector<Program>> requested(const OutputInput& in);

/// Printable ASCII on one line, without what ends a comment.
std::string plain(std::string_view text);

}  // namespace nonio::programs
