// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "programs.h"

namespace nonio::programs {

/// What the options ask for, made into paths. A finding where the diagonals are asked for and the
/// campaign has no plan.
Expected<std::vector<Program>> requested(const OutputInput& in, OutputResult& result);

/// Printable ASCII on one line, without what ends a comment.
std::string plain(std::string_view text);

}  // namespace nonio::programs
