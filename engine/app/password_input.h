// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "nonio/sdk/error.h"

namespace nonio::app {

/// Reads a password from the terminal without echo, or a line from standard input. `whose`: the
/// person named in the prompt.
Expected<std::string> read_password(const std::string& whose);

}  // namespace nonio::app
