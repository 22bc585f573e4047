// SPDX-License-Identifier: Apache-2.0
#include "common.h"

#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <sstream>

#include "platform/storage/json_values.h"
#include "text_layout.h"

namespace nonio::app {
namespace fs = std::filesystem;

namespace {

fs::path program_folder() {
  std::error_code error;
  const fs::path self = fs::read_symlink("/proc/self/exe", error);
  return error ? fs::current_path() : self.parent_path();
}

}  // namespace

std::vector<fs::path> Common::plugin_folders() const {
  std::vector<fs::path> folders;
  for (const std::string& p : plugin_paths) folders.push_back(fs::absolute(p));
  const char* const path = std::getenv("NONIO_PLUGIN_PATH");
  std::istringstream more(path == nullptr ? "" : path);
  for (std::string p; std::getline(more, p, ':');)
    if (!p.empty()) folders.push_back(fs::absolute(p));
  folders.push_back(own_plugins());
  return folders;
}

fs::path Common::own_plugins() {
  return (program_folder() / NONIO_PLUGINS_FROM_PROGRAM).lexically_normal();
}

std::vector<fs::path> Common::template_folders() const {
  std::vector<fs::path> folders{
      (program_folder() / NONIO_TEMPLATES_FROM_PROGRAM).lexically_normal()};
  for (const std::string& p : template_paths) folders.push_back(fs::absolute(p));
  return folders;
}

std::vector<Argument> common_arguments(Common& common) {
  using Takes = Argument::Takes;
  return {existing(Takes::folder, {"--plugin-path", &common.plugin_paths,
                                   "A folder with more plugins; may be given several times. "
                                   "NONIO_PLUGIN_PATH lists such folders too, separated by ':'."}),
          {"--json", &common.json, "Machine-readable output on stdout"},
          {"--quiet", &common.quiet, "No progress; only errors"}};
}

Argument templates_argument(Common& common) {
  return existing(
      Argument::Takes::folder,
      {"--templates", &common.template_paths,
       "A folder whose files replace installed templates; SITE/templates is used automatically"});
}

Argument settings_argument(std::vector<std::string>& settings, std::string help) {
  return {"--set", &settings, std::move(help)};
}

Expected<std::map<std::string, std::string>> settings_of(const std::vector<std::string>& given) {
  std::map<std::string, std::string> out;
  for (const std::string& one : given) {
    const std::size_t equals = one.find('=');
    if (equals == std::string::npos || equals == 0)
      return fail("--set: expected NAME=VALUE, found \"" + one + "\"");
    out[one.substr(0, equals)] = one.substr(equals + 1);
  }
  return out;
}

void print_json(const storage::Json& json, int indent) {
  std::cout << json.dump(indent, ' ', false, storage::Json::error_handler_t::replace) << "\n";
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char text[11];
  std::strftime(text, sizeof text, "%Y-%m-%d", &local);
  return text;
}

bool is_day(const std::string& text) {
  int year = 0, month = 0, day = 0, end = 0;
  if (std::sscanf(text.c_str(), "%4d-%2d-%2d%n", &year, &month, &day, &end) != 3 || end != 10 ||
      text.size() != 10)
    return false;
  return std::chrono::year_month_day{std::chrono::year(year),
                                     std::chrono::month(static_cast<unsigned>(month)),
                                     std::chrono::day(static_cast<unsigned>(day))}
      .ok();
}

int complain(const std::string& message, int status) {
  std::cerr << wrapped(command_words() + ": " + message, 0, sentence_width(STDERR_FILENO), 2);
  return status;
}

}  // namespace nonio::app
