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

/// What the verbs share.
namespace nonio::app {

struct Common {
  std::vector<std::string> plugin_paths, template_paths;
  bool json = false, quiet = false;

  /// Given on the command line, then from the environment, then in the folder of the program.
  std::vector<std::filesystem::path> plugin_folders() const;
  std::vector<std::filesystem::path> template_folders() const;
  static std::filesystem::path own_plugins();
};

/// --plugin-path, --json, --quiet.
std::vector<Argument> common_arguments(Common& common);
/// --templates.
Argument templates_argument(Common& common);
/// --set NAME=VALUE; `help` states about what.
Argument settings_argument(std::vector<std::string>& settings, std::string help);
/// {"NAME", "VALUE"} of each --set.
Expected<std::map<std::string, std::string>> settings_of(const std::vector<std::string>& given);

/// On stdout with a line feed; bytes that are not UTF-8 are replaced. `indent` -1: on one line.
void print_json(const nlohmann::ordered_json& json, int indent = 1);

/// YYYY-MM-DD, of the local clock.
std::string today();
/// YYYY-MM-DD, a day that is in the calendar.
bool is_day(const std::string& text);

using reading::text_of;
/// "nonio run: ..." on stderr, with the words of the command as they were typed; returns the
/// exit status.
int complain(const std::string& message, int status = exit_usage);

}  // namespace nonio::app
