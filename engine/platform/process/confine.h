// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace nonio::process {

/// Restricts what a process with plugin code can do. All functions only remove rights, permanently,
/// and the restrictions apply to all processes that this process creates.

/// Returns what this kernel cannot restrict, as sentences for the summary; empty if nothing.
std::vector<std::string> lacking_confinement();

/// Call before plugins are loaded. Removes all capabilities; allows reading only below `readable`;
/// forbids writing files, starting programs, and contacting or signalling processes. Returns why
/// the kernel refused; empty without an error. A kernel without Landlock or seccomp is not an
/// error.
std::string confine_loading(const std::vector<std::filesystem::path>& readable);

/// Call after plugins were loaded: forbids opening any file. Returns why the kernel refused, or an
/// empty text.
std::string confine_files();

/// Call in a process that evaluates: also forbids new processes and threads, and all other system
/// calls that computing does not need. Returns why the kernel refused, or an empty text.
std::string confine_computing();

/// Call for one command, which reads and writes files and creates processes: forbids new
/// privileges, starting programs and connecting to processes. Returns why the kernel refused, or an
/// empty text.
std::string confine_visit();

/// Call before a plugin function that should need only its arguments: forbids files, sockets,
/// processes, signals, and changing the folder or the umask. `told` is called with the name of a
/// forbidden system call, and must not return. Returns why the kernel refused, or an empty text.
std::string confine_pure(void (*told)(const char* call));

/// Makes these files unreadable, and also everything that is created later in the folders above
/// them; has no effect without Landlock. Returns why the kernel refused, or an empty text.
std::string hide_files(const std::vector<std::filesystem::path>& secrets);

/// Whether `confine_computing` is in effect, after which working folder and umask cannot change.
bool is_computing_confined();

/// Closes all descriptors except 0, 1, 2 and `kept` (in ascending order).
void close_others(const std::vector<int>& kept);

/// Overwrites all environment variables except those for locale, time zone, terminal, folders,
/// search paths, tests and sanitizers, because a variable may contain a password.
void forget_environment();

}  // namespace nonio::process
