// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "campaign/reading/error_text.h"
#include "command_line.h"
#include "nonio/sdk/error.h"

/// Options that all commands have.
namespace nonio::app {

struct Common {
  std::vector<std::string> plugin_paths, template_paths;
  bool json = false, quiet = false;

  /// Returns the folders of --plugin-path, then those of NONIO_PLUGIN_PATH, then the folder of the
  /// program.
  std::vector<std::filesystem::path> plugin_folders() const;
  std::vector<std::filesystem::path> template_folders() const;
  static std::filesystem::path own_plugins();
};

/// Returns the arguments --plugin-path, --json and --quiet.
std::vector<Argument> common_arguments(Common& common);
Argument templates_argument(Common& common);
/// Returns the argument --set NAME=VALUE; `help`: its description.
Argument settings_argument(std::vector<std::string>& settings, std::string help);
/// Parses the values of --set into pairs of NAME and VALUE.
Expected<std::map<std::string, std::string>> settings_of(const std::vector<std::string>& given);

/// Prints the JSON on stdout with a line feed; bytes that are not UTF-8 are replaced. `indent` -1:
/// on one line.
void print_json(const nlohmann::ordered_json& json, int indent = 1);

/// Returns the date of the local clock, YYYY-MM-DD.
std::string today();
/// Whether the text is an existing date, YYYY-MM-DD.
bool is_day(const std::string& text);

using reading::text_of;
/// Prints "nonio run: ..." on stderr, with the words of the command as typed. Returns `status`.
int complain(const std::string& message, int status = exit_usage);

}  // namespace nonio::app
