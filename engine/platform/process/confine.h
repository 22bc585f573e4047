// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace nonio::process {

/// Restrictions for processes with plugin code. All functions remove rights permanently, also for
/// processes that this process creates later.

/// Returns sentences about the restrictions that this kernel does not support.
std::vector<std::string> lacking_confinement();

/// Call before plugins are loaded. Removes all capabilities; allows reading only below `readable`;
/// forbids writing files, starting programs, and contacting or signaling processes. Returns an
/// error message or an empty text. A kernel without Landlock or seccomp is not an error.
std::string confine_loading(const std::vector<std::filesystem::path>& readable);

/// Call after plugins were loaded: forbids opening any file. Returns an error message or an empty
/// text.
std::string confine_files();

/// Call in a process that evaluates: also forbids new processes and threads, and all other system
/// calls that a computation does not need. Returns an error message or an empty text.
std::string confine_computing();

/// Call in a process that runs one command, which may read and write files and create processes:
/// forbids new privileges, starting programs and connecting to processes. Returns an error message
/// or an empty text.
std::string confine_visit();

/// Call before a plugin function that should need only its arguments: forbids files, sockets,
/// processes, signals, and changing the folder or the umask. `told` is called with the name of a
/// forbidden system call, and must not return. Returns an error message or an empty text.
std::string confine_pure(void (*told)(const char* call));

/// Makes these files unreadable, and also everything that is created later in the folders above
/// them; has no effect without Landlock. Returns an error message or an empty text.
std::string hide_files(const std::vector<std::filesystem::path>& secrets);

/// Whether `confine_computing` is in effect, which prevents changes of working folder and umask.
bool is_computing_confined();

/// Closes all descriptors except 0, 1, 2 and `kept`, which must be in ascending order.
void close_others(const std::vector<int>& kept);

/// Overwrites all environment variables except those for locale, time zone, terminal, folders,
/// search paths, tests and sanitizers, because a variable may contain a password.
void forget_environment();

}  // namespace nonio::process
