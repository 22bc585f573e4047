// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace nonio::process {

/// For a program that does one thing and ends: when it first loads plugins, all that is still to do
/// goes on in a child, which can start no program and connect to no process, and the process that
/// was started only waits for it and ends with its exit status. What plugins print goes to the
/// standard error. `own_plugins`: the folder of the program, whose plugins were tested with it.
void keep_plugins_apart(std::filesystem::path own_plugins);

}  // namespace nonio::process
