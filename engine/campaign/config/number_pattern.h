// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "nonio/sdk/error.h"

namespace nonio::config {

/// Returns the key of the counter that a number uses: the pattern with the year in place of {year}
/// and with {number} in place of {number:4}, so that the number of digits makes no difference.
std::string sequence_of(const std::string& pattern, const std::string& year);

/// Returns the certificate number for the pattern `[certificate] numbering`. An error if the
/// pattern does not contain the number once, contains another placeholder than {year}, or results
/// in a text that cannot be part of a file name.
Expected<std::string> number_text(const std::string& pattern, const std::string& year,
                                  std::uint64_t number);

}  // namespace nonio::config
