// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace nonio::process {

/// What a plugin must leave as it is, since all that follows in the process depends on it: rounding
/// mode and the like of the processor, locale, signal mask, umask, working directory.

/// Notes it as it is now, as the one that has to hold. Before plugins are loaded.
void keep_process_state();
/// What is other than it was kept, in words, and put right again; empty: nothing. Before the first
/// `keep_process_state` always empty.
std::string restore_process_state();

}  // namespace nonio::process
