// SPDX-License-Identifier: Apache-2.0
#include "command_line.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>
#include <sstream>

#include "colour.h"
#include "platform/storage/nearest.h"

namespace nonio::app {

namespace {

CLI::Option* bind(CLI::App& app, const Argument& a) {
  if (auto* const* flag = std::get_if<bool*>(&a.target))
    return app.add_flag(a.name, **flag, a.help);
  if (auto* const* list = std::get_if<std::vector<std::string>*>(&a.target)) {
    CLI::Option* option = app.add_option(a.name, **list, a.help);
    // One value each time, so that what follows it is never taken for a second
    // one.
    if (!a.is_positional()) option->take_all()->expected(1)->allow_extra_args(false);
    return option;
  }
  if (!a.bare.empty())  // CLI11 knows such a value only for flags
    return app.add_flag(a.name + "{" + a.bare + "}", *std::get<std::string*>(a.target), a.help);
  return std::visit(
      [&](auto* target) -> CLI::Option* { return app.add_option(a.name, *target, a.help); },
      a.target);
}

CLI::Validator member_of(const std::vector<std::string>& choices) {
  return {[choices](const std::string& found) {
            if (std::find(choices.begin(), choices.end(), found) != choices.end())
              return std::string();
            return "expected one of " + storage::listed(choices) + "; found \"" + found + "\"" +
                   storage::suggestion(found, choices);
          },
          "{" + storage::listed(choices) + "}"};
}

void check(CLI::Option& option, const Argument& a) {
  if (a.required) option.required();
  if (a.exists)
    option.check(a.takes == Argument::Takes::folder ? CLI::Validator(CLI::ExistingDirectory)
                 : a.takes == Argument::Takes::file ? CLI::Validator(CLI::ExistingFile)
                                                    : CLI::Validator(CLI::ExistingPath));
  if (!a.choices.empty()) option.check(member_of(a.choices));
  if (a.range) option.check(CLI::Range(a.range->first, a.range->second));
  if (a.shows_default) option.capture_default_str();
}

void bind(CLI::App& app, const Verb& verb, std::function<int()>& chosen) {
  for (const Argument& a : verb.arguments) check(*bind(app, a), a);
  app.footer(verb.footer);
  for (const Verb& inner : verb.verbs)
    bind(*app.add_subcommand(inner.name, inner.summary)
              ->group(inner.group.empty() ? "Verbs" : inner.group),
         inner, chosen);
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

/// The verb that the words lead to, as far as they are verbs.
struct Found {
  const Verb* verb = nullptr;
  std::string path;       ///< "nonio plan"
  std::size_t words = 0;  ///< of the path, without the program
  std::string wrong{};    ///< what is wrong with the word where a verb is wanted;
                          ///< empty: nothing
};

Found find(const Verb& top, const std::vector<std::string>& words) {
  Found found{&top, top.name};
  for (const std::string& word : words) {
    const std::vector<Verb>& verbs = found.verb->verbs;
    if (verbs.empty() || word.starts_with('-')) break;
    const Verb* next = find(verbs, word);
    if (next == nullptr) {
      const auto names = names_of(verbs);
      const std::string nearest = storage::suggestion(word, names);
      found.wrong = found.path + ": there is no verb \"" + word + "\"" +
                    (nearest.empty() ? "; there are " + storage::listed(names) : nearest);
      break;
    }
    found.verb = next;
    found.path += " " + word;
    ++found.words;
  }
  return found;
}

bool is_option(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && word.find_first_of("0123456789.") != 1;
}

/// What is wrong with the first option that the verb does not have, with the
/// nearest one that it has; empty if it has them all.
std::string unknown_option(const Verb& verb, std::vector<std::string> own,
                           const std::vector<std::string>& words) {
  for (const Argument& a : verb.arguments)
    if (!a.is_positional()) own.push_back(a.name);
  for (std::size_t i = 0; i < words.size() && words[i] != "--"; ++i) {
    if (!is_option(words[i])) continue;
    const std::string name = words[i].substr(0, words[i].find('='));
    if (std::find(own.begin(), own.end(), name) == own.end())
      return "there is no option " + name + storage::suggestion(name, own);
    for (const Argument& a : verb.arguments)
      if (a.name == name && name == words[i] && a.needs_value()) ++i;
  }
  return {};
}

/// What CLI11 does not say as well; empty: nothing.
std::string complaint_about(const Found& found, const std::vector<std::string>& words) {
  if (!found.wrong.empty()) return found.wrong;
  const bool at_top = found.words == 0;
  std::vector<std::string> own{"--help", "-h"};
  if (at_top) own.emplace_back("--version");
  const std::vector<std::string> rest(words.begin() + found.words, words.end());
  if (const std::string wrong = unknown_option(*found.verb, own, rest); !wrong.empty())
    return found.path + ": " + wrong;
  if (!at_top && rest.empty() && !found.verb->verbs.empty())
    return found.path + ": expected a verb: " + storage::listed(names_of(found.verb->verbs));
  return {};
}

std::unique_ptr<CLI::App> cli_of(const Program& program, const Verb& top,
                                 std::function<int()>& chosen) {
  auto cli = std::make_unique<CLI::App>(program.summary);
  cli->name(program.name);
  cli->get_formatter()->label("SUBCOMMAND", "VERB");
  cli->set_version_flag("--version", program.name + " " + program.version);
  bind(*cli, top, chosen);
  return cli;
}

Verb top_of(const Program& program) {
  return {.name = program.name,
          .summary = program.summary,
          .footer = program.footer,
          .verbs = program.verbs};
}

/// With headings in bold.
void print_help(const std::string& text, std::ostream& out) {
  const bool is_out = &out == &std::cout;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const bool heading = line.ends_with(':') && line.size() < 30 && line[0] != ' ';
    out << (heading ? coloured(line, Colour::bold, is_out ? STDOUT_FILENO : STDERR_FILENO) : line)
        << "\n";
  }
}

/// The program with no words, as far as it has been bound.
struct Bound {
  explicit Bound(const Program& program)
      : top(top_of(program)), cli(cli_of(program, top, chosen)) {}
  Bound(const Bound&) = delete;
  Bound& operator=(const Bound&) = delete;

  std::function<int()> chosen{};
  Verb top;
  std::unique_ptr<CLI::App> cli;
};

/// `words` lead to a verb.
std::string help_text(const Program& program, const std::vector<std::string>& words) {
  Bound bound(program);
  std::vector<std::string> reversed{"--help"};
  reversed.insert(reversed.end(), words.rbegin(), words.rend());
  try {
    bound.cli->parse(reversed);
  } catch (const CLI::ParseError&) {  // that of --help
  }
  return bound.cli->help();
}

}  // namespace

std::vector<Argument> joined(std::vector<Argument> first, const std::vector<Argument>& second,
                             const std::vector<Argument>& third,
                             const std::vector<Argument>& fourth) {
  for (const auto* more : {&second, &third, &fourth})
    first.insert(first.end(), more->begin(), more->end());
  return first;
}

int show_help(const Program& program, const std::vector<std::string>& words) {
  const Verb top = top_of(program);
  const Found found = find(top, words);
  if (found.wrong.empty() && found.words == words.size()) {
    print_help(help_text(program, words), std::cout);
    return exit_done;
  }
  std::cerr << (found.wrong.empty() ? found.path + ": there is no verb below it" : found.wrong)
            << "\n";
  return exit_usage;
}

int run(const Program& program, int argc, const char* const* argv) {
  const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  if (words.empty()) {
    print_help(help_text(program, {}), std::cerr);
    return exit_usage;
  }
  Bound bound(program);
  const Found found = find(bound.top, words);
  if (const std::string wrong = complaint_about(found, words); !wrong.empty()) {
    std::cerr << wrong << "\n`" << found.path << " --help` says more.\n";
    return exit_usage;
  }
  try {
    bound.cli->parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    print_help(bound.cli->help(), std::cout);
    return exit_done;
  } catch (const CLI::Success& e) {
    return bound.cli->exit(e);
  } catch (const CLI::ParseError& e) {
    std::cerr << found.path << ": " << e.what() << "\n`" << found.path
              << " --help` says what it takes.\n";
    return exit_usage;
  }
  try {
    return bound.chosen();
  } catch (const std::bad_alloc&) {
    std::cerr << found.path << ": out of memory\n";
  } catch (const std::exception& e) {
    std::cerr << found.path << ": " << e.what() << "\n";
  }
  return exit_failed;
}

}  // namespace nonio::app
