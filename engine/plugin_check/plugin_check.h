// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"

/// `nonio plugin check`: the laws that a plugin must obey, each tried in a child process with
/// limits of time and memory.
namespace nonio::plugin_check {

struct PluginCheck {
  enum class State { passed, failed, crashed, skipped };
  std::string file;    ///< of the plugin
  std::string plugin;  ///< "effect bow"; empty of the file itself
  std::string name;    ///< of the check: "rows"
  State state = State::passed;
  std::string says;        ///< what was found and wanted; why it was skipped
  std::uint64_t seed = 1;  ///< of the samples
};
const char* to_text(PluginCheck::State state);

struct PluginCheckRequest {
  std::filesystem::path subject;             ///< a plugin, or a folder with plugins below it
  std::vector<std::filesystem::path> cases;  ///< folders with campaigns below: more samples
  std::string only;                          ///< the one check to do; empty: all
  std::string plugin;                        ///< the one plugin to check, by name; empty: all
  std::uint64_t seed = 1;                    ///< the first one
  std::uint64_t seeds = 3;                   ///< so many, each one more than the last
  double seconds = 20.0;                     ///< of the processor, for one check
  double memory_MB = 2000.0;
  std::filesystem::path own_plugins;  ///< of the program: samples are read and evaluated by them
  std::vector<std::filesystem::path> template_folders;
  std::string version;
};

/// The names of all checks, with what each holds a plugin against.
std::vector<std::pair<std::string, std::string>> plugin_check_names();

/// Reports each check as it ends. An error if the request is wrong: no such plugin, no such check.
Expected<void> check_plugins(const PluginCheckRequest& request,
                             const std::function<void(const PluginCheck&)>& tell);

}  // namespace nonio::plugin_check
