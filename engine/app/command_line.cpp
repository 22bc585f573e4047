// SPDX-License-Identifier: Apache-2.0
#include "command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>

#include "nonio/host/nearest.h"

namespace nonio::app {

namespace {

bool is_positional(const Argument& a) { return !a.name.starts_with('-'); }

CLI::Option* bind(CLI::App& app, const Argument& a) {
  if (auto* const* flag = std::get_if<bool*>(&a.target))
    return app.add_flag(a.name, **flag, a.help);
  if (auto* const* list = std::get_if<std::vector<std::string>*>(&a.target)) {
    CLI::Option* option = app.add_option(a.name, **list, a.help);
    // One value each time, so that what follows it is never taken for a second one.
    if (!is_positional(a)) option->take_all()->expected(1)->allow_extra_args(false);
    return option;
  }
  if (!a.bare.empty())  // CLI11 knows such a value only for flags
    return app.add_flag(a.name + "{" + a.bare + "}", *std::get<std::string*>(a.target), a.help);
  return std::visit(
      [&](auto* target) -> CLI::Option* { return app.add_option(a.name, *target, a.help); },
      a.target);
}

void check(CLI::Option& option, const Argument& a) {
  if (a.required) option.required();
  if (a.exists)
    option.check(a.takes == Argument::Takes::folder ? CLI::Validator(CLI::ExistingDirectory)
                 : a.takes == Argument::Takes::file ? CLI::Validator(CLI::ExistingFile)
                                                    : CLI::Validator(CLI::ExistingPath));
  if (!a.choices.empty()) option.check(CLI::IsMember(a.choices));
  if (a.range) option.check(CLI::Range(a.range->first, a.range->second));
  if (a.shows_default) option.capture_default_str();
}

void bind(CLI::App& app, const Verb& verb, std::function<int()>& chosen) {
  for (const Argument& a : verb.arguments) check(*bind(app, a), a);
  app.footer(verb.footer);
  for (const Verb& inner : verb.verbs)
    bind(*app.add_subcommand(inner.name, inner.summary), inner, chosen);
  if (verb.verbs.empty())
    app.callback([&chosen, &verb] { chosen = verb.run; });
  else
    app.require_subcommand(1);
}

std::vector<std::string> names_of(const std::vector<Verb>& verbs) {
  std::vector<std::string> names;
  for (const Verb& v : verbs) names.push_back(v.name);
  return names;
}

const Verb* find(const std::vector<Verb>& verbs, const std::string& name) {
  const auto it =
      std::find_if(verbs.begin(), verbs.end(), [&](const Verb& v) { return v.name == name; });
  return it == verbs.end() ? nullptr : &*it;
}

std::string listed(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

/// The verb that the words lead to, as far as they are verbs, and what comes before it: "nonio
/// plan".
struct Found {
  const Verb* verb = nullptr;  ///< none: the program itself
  std::string path;
  std::string wrong;  ///< the complaint about a word where a verb is wanted; empty if there is none
};

Found find(const Program& program, const std::vector<std::string>& words) {
  Found found{nullptr, program.name, {}};
  const std::vector<Verb>* verbs = &program.verbs;
  for (const std::string& word : words) {
    if (verbs->empty() || word.starts_with('-')) break;
    const Verb* next = find(*verbs, word);
    if (next == nullptr) {
      const auto names = names_of(*verbs);
      found.wrong = found.path + ": wanted a verb, found \"" + word + "\"" +
                    host::suggestion(word, names) + "; the verbs are " + listed(names);
      break;
    }
    found.verb = next;
    found.path += " " + word;
    verbs = &next->verbs;
  }
  return found;
}

/// Behind CLI11's complaint about `argument`: the option that may have been meant.
std::string meant(const Verb* verb, const std::vector<std::string>& words) {
  if (verb == nullptr) return {};
  std::vector<std::string> names{"--help"};
  for (const Argument& a : verb->arguments)
    if (!is_positional(a)) names.push_back(a.name);
  for (const std::string& word : words) {
    const std::string name = word.substr(0, word.find('='));
    if (name.starts_with("--") && std::find(names.begin(), names.end(), name) == names.end())
      return host::suggestion(name, names);
  }
  return {};
}

std::unique_ptr<CLI::App> cli_of(const Program& program, const Verb& top,
                                 std::function<int()>& chosen) {
  auto cli = std::make_unique<CLI::App>(program.summary);
  cli->name(program.name);
  cli->set_version_flag("--version", program.name + " " + program.version);
  bind(*cli, top, chosen);
  return cli;
}

Verb top_of(const Program& program) {
  return {program.name, program.summary, {}, program.footer, {}, program.verbs};
}

}  // namespace

std::optional<std::string> help_of(const Program& program, const std::vector<std::string>& words) {
  if (!find(program, words).wrong.empty()) return std::nullopt;
  std::function<int()> chosen;
  const Verb top = top_of(program);
  const auto cli = cli_of(program, top, chosen);
  std::vector<std::string> reversed{"--help"};
  reversed.insert(reversed.end(), words.rbegin(), words.rend());
  try {
    cli->parse(reversed);
  } catch (const CLI::CallForHelp&) {
    return cli->help();
  } catch (const CLI::ParseError&) {
  }
  return std::nullopt;
}

int run(const Program& program, int argc, const char* const* argv) {
  const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  const Found found = find(program, words);
  if (!found.wrong.empty()) {
    std::cerr << found.wrong << "\n`" << program.name << " help` says what each does.\n";
    return exit_usage;
  }
  if (words.empty()) {
    std::cerr << *help_of(program, {});
    return exit_usage;
  }
  std::function<int()> chosen;
  const Verb top = top_of(program);
  const auto cli = cli_of(program, top, chosen);
  try {
    cli->parse(argc, argv);
  } catch (const CLI::Success& e) {
    return cli->exit(e);
  } catch (const CLI::ParseError& e) {
    std::cerr << found.path << ": " << e.what() << meant(found.verb, words) << "\n`" << found.path
              << " --help` says what it takes.\n";
    return exit_usage;
  }
  return chosen();
}

}  // namespace nonio::app
