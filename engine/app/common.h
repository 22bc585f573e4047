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

namespace nonio::app {

struct Common {
  std::vector<std::string> plugin_paths, template_paths;
  bool json = false, quiet = false;

  /// Returns the folders of --plugin-path, then of NONIO_PLUGIN_PATH, then of the installation.
  std::vector<std::filesystem::path> plugin_folders() const;
  std::vector<std::filesystem::path> template_folders() const;
  static std::filesystem::path own_plugins();
};

/// Returns the arguments --plugin-path, --json and --quiet.
std::vector<Argument> common_arguments(Common& common);
Argument templates_argument(Common& common);
/// Returns the argument --set NAME=VALUE, which may be given several times.
Argument settings_argument(std::vector<std::string>& settings, std::string help);
/// Maps NAME to VALUE; a later value of the same name replaces an earlier one.
Expected<std::map<std::string, std::string>> settings_of(const std::vector<std::string>& given);

/// Prints the JSON on stdout with a line feed. Bytes that are not UTF-8 are replaced. An `indent`
/// of -1 prints one line.
void print_json(const nlohmann::ordered_json& json, int indent = 1);

/// Returns the date in local time, YYYY-MM-DD.
std::string today();
/// Whether the text is an existing date, YYYY-MM-DD.
bool is_day(const std::string& text);

using reading::text_of;
/// Prints the message on stderr after the command as typed, such as "nonio run: ". Returns
/// `status`.
int complain(const std::string& message, int status = exit_usage);

}  // namespace nonio::app
