// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

/// `nonio plugin check`: tests in child processes, with limits of time and memory, whether a plugin
/// obeys each of the laws that apply to it.
namespace nonio::plugin_check {

struct PluginCheck {
  enum class State { passed, failed, crashed, skipped };
  std::string file;  ///< path of the plugin file
  /// Kind and name of the plugin: "effect bow"; empty for a check of the file itself.
  std::string plugin;
  std::string name;  ///< name of the check: "rows"
  State state = State::passed;
  std::string says;        ///< what was found and expected, or why the check was skipped
  std::uint64_t seed = 1;  ///< seed of the samples
};
const char* to_text(PluginCheck::State state);

struct PluginCheckRequest {
  std::filesystem::path subject;  ///< path of a plugin, or of a folder with plugins below it
  /// Folders below which campaigns serve as additional samples.
  std::vector<std::filesystem::path> cases;
  std::string only;         ///< name of the only check to run; empty: all
  std::string plugin;       ///< the one plugin to check, by name; empty: all
  std::uint64_t seed = 1;   ///< first seed of the samples
  std::uint64_t seeds = 3;  ///< number of seeds: seed, seed + 1, ...
  double seconds = 20.0;    ///< processor time limit of a check, s; time limit: 10 times this value
  double memory_MB = 2000.0;
  /// the program's plugins, which read and evaluate the samples
  std::filesystem::path own_plugins;
  std::vector<std::filesystem::path> template_folders;
  std::string version;
};

/// Returns the name of every check with the law that it tests.
std::vector<std::pair<std::string, std::string>> plugin_check_names();

/// Runs the requested checks and calls `tell` after each one. An error if the requested plugin or
/// check does not exist.
Expected<void> check_plugins(const PluginCheckRequest& request,
                             const std::function<void(const PluginCheck&)>& tell);

}  // namespace nonio::plugin_check
