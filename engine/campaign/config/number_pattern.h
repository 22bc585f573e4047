// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "nonio/sdk/error.h"

namespace nonio::config {

/// Numbers of one sequence have one counter, however many digits they are printed with: the pattern
/// with its year.
std::string sequence_of(const std::string& pattern, const std::string& year);

/// `[certificate] numbering` with its places filled. An error if the result cannot be a number,
/// which is part of file names and is printed.
Expected<std::string> number_text(const std::string& pattern, const std::string& year,
                                  std::uint64_t number);

}  // namespace nonio::config
