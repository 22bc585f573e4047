// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "nonio/sdk/error.h"

namespace nonio::live {

/// 128 bits of the kernel's as 32 hexadecimal digits.
Expected<std::string> new_token();

/// The token in a file that only its owner can read; a new one if there is no such file. For an
/// address that stays when the server is started again.
Expected<std::string> token_in(const std::string& file);

}  // namespace nonio::live
