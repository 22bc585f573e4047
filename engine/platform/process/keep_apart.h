// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace nonio::process {

/// For a program that runs one command: when plugins are first loaded, the rest of the command
/// continues in a confined child, which can start no program and connect to no process. The first
/// process only waits for the child and ends with its exit status. What plugins print goes to
/// standard error. `own_plugins`: folder of the plugins that were tested with the program.
void keep_plugins_apart(std::filesystem::path own_plugins);

}  // namespace nonio::process
