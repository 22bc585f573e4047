// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "nonio/sdk/error.h"

namespace nonio::app {

/// Reads a password from the terminal without echo, or one line of standard input. The prompt names
/// the person `whose`.
Expected<std::string> read_password(const std::string& whose);

}  // namespace nonio::app
