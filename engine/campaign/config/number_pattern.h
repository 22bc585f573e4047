// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "nonio/sdk/error.h"

namespace nonio::config {

/// Returns the key of a counter: `pattern` with the year filled in and without the number of
/// digits.
std::string sequence_of(const std::string& pattern, const std::string& year);

/// Returns a certificate number. An error unless `pattern` contains {number} once, no placeholder
/// except {year}, and only characters allowed in file names.
Expected<std::string> number_text(const std::string& pattern, const std::string& year,
                                  std::uint64_t number);

}  // namespace nonio::config
