// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "nonio/sdk/error.h"

namespace nonio::app {

/// A password from the terminal, which does not show it, or a line of standard input. `whose`: of
/// the question.
Expected<std::string> read_password(const std::string& whose);

}  // namespace nonio::app
