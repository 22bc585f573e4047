// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace nonio::process {

/// What a process with plugin code may still do. Everything here only removes rights, permanently,
/// and applies to all processes that the process makes.

/// What this kernel lacks of it, in words for the summary; empty: nothing.
std::vector<std::string> lacking_confinement();

/// Before plugins are loaded: no new rights, no capability; below `readable` files can be read and
/// nowhere else, nothing can be written; no program can be started, no process be contacted or
/// signalled. An error if the kernel supports this and refuses it.
std::string confine_loading(const std::vector<std::filesystem::path>& readable);

/// When plugins are loaded: no file can be opened at all. An error as above.
std::string confine_files();

/// In a process that evaluates: besides, no process and no thread; only what computing needs.
std::string confine_computing();

/// For the work of one command, which reads and writes files and makes processes: no new rights, no
/// program started, no connection to another process.
std::string confine_visit();

/// For one call of a plugin that should need nothing but its arguments: files, sockets, processes,
/// signals, another folder or mode mask are not to be had. `told` is called with the name of the
/// system call that was tried, and must not return. An error as above.
std::string confine_pure(void (*told)(const char* call));

/// These files can be read no more; nor what is made from now on in the folders above them.
std::string hide_files(const std::vector<std::filesystem::path>& secrets);

/// Whether `confine_computing` has taken away what would change working directory and mode mask.
bool is_computing_confined();

/// Closes every descriptor but these (ascending) and 0, 1, 2.
void close_others(const std::vector<int>& kept);

/// Overwrites the environment but for locale, time zone, terminal and folders: it may hold a
/// password.
void forget_environment();

}  // namespace nonio::process
