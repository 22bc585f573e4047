// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

/// `nonio plugin check` tests in child processes, with limits of time and memory, whether a plugin
/// has the properties that the host requires.
namespace nonio::plugin_check {

struct PluginCheck {
  enum class State { passed, failed, crashed, skipped };
  std::string file;
  /// Kind and name of the plugin: "effect bow"; empty for a check of the file itself.
  std::string plugin;
  std::string name;
  State state = State::passed;
  std::string says;  ///< what was found and expected, or why the check was skipped
  std::uint64_t seed = 1;
};
const char* to_text(PluginCheck::State state);

struct PluginCheckRequest {
  std::filesystem::path subject;  ///< a plugin, or a folder with plugins below it
  /// Folders below which campaigns are used as additional samples.
  std::vector<std::filesystem::path> cases;
  std::string only;    ///< name of the only check to run; all checks run if empty
  std::string plugin;  ///< name of the only plugin to check; all plugins if empty
  std::uint64_t seed = 1;
  std::uint64_t seeds = 3;  ///< number of seeds, which are consecutive
  /// Limit of the processor time of a check, s; the elapsed time may be 10 times as long.
  double seconds = 20.0;
  double memory_MB = 2000.0;
  std::filesystem::path own_plugins;
  std::vector<std::filesystem::path> template_folders;
  std::string version;
};

/// Returns the names of the checks, each with a sentence about the property that it tests.
std::vector<std::pair<std::string, std::string>> plugin_check_names();

/// Calls `tell` after each check. An error if the requested plugin or check does not exist.
Expected<void> check_plugins(const PluginCheckRequest& request,
                             const std::function<void(const PluginCheck&)>& tell);

}  // namespace nonio::plugin_check
