// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace nonio::host {

/// Numbers of one sequence have one counter, however many digits they are printed with: the pattern
/// with its year.
std::string sequence_of(const std::string& pattern, const std::string& year);

}  // namespace nonio::host
