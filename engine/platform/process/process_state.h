// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace nonio::process {

/// State of the process that a plugin must not change, because all later work depends on it:
/// floating-point modes, locale, signal mask, umask, working folder.

/// Stores the present state as the required one. Call it before plugins are loaded.
void keep_process_state();
/// Restores the stored state and returns the names of what had changed. Without
/// `keep_process_state` it does nothing and returns an empty text.
std::string restore_process_state();

}  // namespace nonio::process
