// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "nonio/sdk/error.h"

namespace nonio::config {

/// Returns the key of the counter that a number uses: the pattern with its year, without digits.
/// Numbers of the same sequence share a counter, whatever their number of digits.
std::string sequence_of(const std::string& pattern, const std::string& year);

/// Returns the certificate number for the pattern `[certificate] numbering`. An error if the result
/// is not allowed as a number, which is printed and is part of file names.
Expected<std::string> number_text(const std::string& pattern, const std::string& year,
                                  std::uint64_t number);

}  // namespace nonio::config
