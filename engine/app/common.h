// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// What the verbs share.
namespace nonio::app {

inline constexpr int exit_done = 0, exit_failed = 1, exit_usage = 2, exit_interrupted = 130;

struct Common {
  std::vector<std::string> plugin_paths, template_paths;
  bool json = false, quiet = false;

  /// Given on the command line, then from the environment, then beside the program.
  std::vector<std::filesystem::path> plugin_folders() const;
  std::vector<std::filesystem::path> template_folders() const;
  static std::filesystem::path own_plugins();
};

/// --plugin-path, --json, --quiet.
void add_common(CLI::App& verb, Common& common);
/// --templates.
void add_templates(CLI::App& verb, Common& common);

/// Exit status of the verb that was given, once it has run.
using Outcome = std::optional<int>;

void add_apply_verb(CLI::App& cli, Common& common, Outcome& outcome);
void add_certificates_verb(CLI::App& cli, Common& common, Outcome& outcome);
void add_compare_verb(CLI::App& cli, Common& common, Outcome& outcome);
void add_controllers_verb(CLI::App& cli, Common& common, Outcome& outcome);
void add_diff_verb(CLI::App& cli, Common& common, Outcome& outcome);
void add_explain_verb(CLI::App& cli, Common& common, Outcome& outcome);
void add_import_verb(CLI::App& cli, Common& common, Outcome& outcome);
void add_model_verb(CLI::App& cli, Common& common, Outcome& outcome);
void add_plan_verb(CLI::App& cli, Common& common, Outcome& outcome);
void add_plugin_verb(CLI::App& cli, Common& common, Outcome& outcome);
/// Below `plan`.
void add_sign_probe(CLI::App& plan_verb, Common& common, Outcome& outcome);
void add_template_verb(CLI::App& cli, Common& common, Outcome& outcome);
void add_verify_verb(CLI::App& cli, Common& common, Outcome& outcome);

}  // namespace nonio::app
