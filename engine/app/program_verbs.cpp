// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <memory>

#include "nonio/sdk/plugin.h"
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

}  // namespace nonio::app
