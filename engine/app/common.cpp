// SPDX-License-Identifier: Apache-2.0
#include "common.h"

#include <cstdlib>

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
  if (const char* path = std::getenv("NONIO_PLUGIN_PATH"))
    for (const std::string& p : CLI::detail::split(path, ':'))
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

void add_common(CLI::App& verb, Common& common) {
  verb.add_option(
          "--plugin-path", common.plugin_paths,
          "A folder with more plugins; may be given several times. NONIO_PLUGIN_PATH holds\n"
          "such folders too, with ':' between them.")
      ->check(CLI::ExistingDirectory)
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
  verb.add_flag("--json", common.json, "Machine-readable output on stdout");
  verb.add_flag("--quiet", common.quiet, "No progress; only what went wrong");
}

void add_templates(CLI::App& verb, Common& common) {
  verb.add_option(
          "--templates", common.template_paths,
          "A folder laid over the installed templates; SITE/templates is, without being named")
      ->check(CLI::ExistingDirectory)
      ->take_all()
      ->expected(1)
      ->allow_extra_args(false);
}

}  // namespace nonio::app
