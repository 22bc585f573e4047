// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <iostream>
#include <memory>

#include "campaign/config/keys.h"
#include "campaign/loader/plugins.h"
#include "campaign/schema/schema.h"
#include "certificates/users.h"
#include "nonio/sdk/plugin.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"
#include "verbs.h"

namespace nonio::app {
using storage::Json;
namespace fs = std::filesystem;

namespace {

struct HelpWish {
  std::vector<std::string> words;
  bool man = false, json = false;
};

int help(const HelpWish& wish, const Program& program) {
  if (wish.man) {
    write_man_page(program, std::cout);
    return exit_done;
  }
  if (wish.json) {
    write_table(program, std::cout);
    return exit_done;
  }
  return show_help(program, wish.words);
}

std::vector<std::string> names_of(const Program& program) {
  std::vector<std::string> names;
  for (const Verb& verb : program.verbs) names.push_back(verb.name);
  return names;
}

std::vector<std::string> texts_of(const std::vector<fs::path>& folders) {
  std::vector<std::string> texts;
  for (const fs::path& folder : folders) texts.push_back(folder.string());
  return texts;
}

int version(const Common& common) {
  const auto plugins = texts_of(common.plugin_folders()),
             templates = texts_of(common.template_folders());
  if (common.json) {
    print_json(Json{{"schema", "nonio-version/1"},
                    {"version", NONIO_VERSION},
                    {"abi", NONIO_ABI_TAG},
                    {"plugins", plugins},
                    {"templates", templates}});
    return exit_done;
  }
  std::cout << "nonio " NONIO_VERSION "\nABI        " NONIO_ABI_TAG "\n";
  for (const auto& [name, folders] :
       {std::pair{"plugins    ", &plugins}, {"templates  ", &templates}})
    for (const std::string& folder : *folders) std::cout << name << folder << "\n";
  return exit_done;
}

}  // namespace

Verb help_verb(const Program& program) {
  auto wish = std::make_shared<HelpWish>();
  return {.name = "help",
          .summary = "Describes a command; --man prints the manual page",
          .arguments = {offering(names_of(program),
                                 {"COMMAND", &wish->words, "A command, such as plan triples"}),
                        {"--man", &wish->man, "All commands as a manual page for man(1)"},
                        {"--json", &wish->json, "The table of all commands"}},
          .examples = {"nonio help plan triples", "nonio help --man | man -l -"},
          .run = [wish, &program] { return help(*wish, program); }};
}

Verb version_verb(Common& common) {
  return {
      .name = "version",
      .summary = "Prints the version, the ABI tag, and the search paths of plugins and templates",
      .arguments = joined({templates_argument(common)}, common_arguments(common)),
      .examples = {"nonio version --json"},
      .run = [&common] { return version(common); }};
}

Verb completion_verb(const Program& program) {
  auto shell = std::make_shared<std::string>();
  return {.name = "completion",
          .summary = "Prints the shell script that completes commands, options and files",
          .arguments = {required(one_of({"bash", "zsh"}, {"SHELL", shell.get(), "bash or zsh"}))},
          .examples = {"nonio completion bash > ~/.local/share/bash-completion/completions/nonio",
                       "nonio completion zsh > ~/.zfunc/_nonio"},
          .run = [shell, &program] {
            write_completion(program, *shell, std::cout);
            return exit_done;
          }};
}

namespace fs = std::filesystem;

namespace {

using File = const config::Key& (*)();

/// A null `file` selects campaign.toml, whose schema depends on the plugins.
int write_schema(File file, const std::string& out, const Common& common) {
  loader::Plugins plugins;
  plugins.load(common.plugin_folders());
  if (!plugins.conflicts().empty()) return complain(plugins.conflicts().front());
  for (const std::string& note : plugins.refusal_notes())
    complain("its names and options are not in the schema: " + note);
  const std::string text =
      file == nullptr ? schema::campaign_schema(plugins) : schema::file_schema(file(), plugins);
  if (out.empty()) {
    std::cout << text;
    return exit_done;
  }
  const fs::path path = fs::absolute(out);
  if (!path.has_filename() || fs::is_directory(path))
    return complain(out + " is a folder; expected a file");
  const auto written = storage::publish(path.parent_path(), {{path.filename().string(), text}});
  return written ? exit_done : complain(text_of(written.error()), exit_failed);
}

Verb schema_of(const std::string& file, File declaration, Common& common) {
  auto out = std::make_shared<std::string>();
  return {
      .name = file,
      .summary = "JSON schema of " + file + ".toml",
      .arguments = joined({takes(Argument::Takes::file,
                                 {"--out", out.get(), "File for the schema (default: stdout)"})},
                          common_arguments(common)),
      .footer = "An editor finds the schema by the first line of " + file +
                ".toml, with the path from there:\n\n    #:schema ../" + file + ".schema.json",
      .examples = {"nonio schema " + file + " --out site/" + file + ".schema.json"},
      .run = [=, &common] { return write_schema(declaration, *out, common); }};
}

}  // namespace

Verb schema_verb(Common& common) {
  return {.name = "schema",
          .summary = "Writes JSON schemas, so that editors complete and check the files of a site",
          .verbs = {schema_of("campaign", nullptr, common),
                    schema_of("site", config::site_file, common),
                    schema_of("machine", config::machine_file, common),
                    schema_of("events", config::events_file, common),
                    schema_of("acknowledged", config::acknowledged_file, common),
                    schema_of("forgotten", config::forgotten_file, common),
                    schema_of("users", certificates::users_file, common)}};
}

}  // namespace nonio::app
