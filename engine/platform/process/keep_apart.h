// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace nonio::process {

/// Call it in a program that runs one command. When plugins are first loaded, the command continues
/// in a confined child, which can start no program and connect to no process; the first process
/// waits for the child and ends with its exit status. Output of plugins goes to standard error.
/// `own_plugins` is the folder of the plugins that were tested with the program.
void keep_plugins_apart(std::filesystem::path own_plugins);

}  // namespace nonio::process
