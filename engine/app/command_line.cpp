// SPDX-License-Identifier: Apache-2.0
#include "command_line.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <filesystem>
#include <iostream>
#include <sstream>
#include <utility>

#include "common.h"
#include "nonio/sdk/format.h"
#include "platform/storage/nearest.h"
#include "text_layout.h"

namespace nonio::app {
namespace fs = std::filesystem;

namespace {

using Words = std::vector<std::string>;

std::string& typed_words() {
  static std::string words = "nonio";
  return words;
}

CLI::Option* bind(CLI::App& app, const Argument& a) {
  std::string names = a.name;
  for (const std::string& other : {a.brief, a.old})
    if (!other.empty()) names += "," + other;
  if (auto* const* flag = std::get_if<bool*>(&a.target)) return app.add_flag(names, **flag);
  if (auto* const* list = std::get_if<Words*>(&a.target)) {
    CLI::Option* option = app.add_option(names, **list);
    // Each option takes one value, so that the word after its value is not taken for a second
    // value.
    if (!a.is_positional()) option->take_all()->expected(1)->allow_extra_args(false);
    return option;
  }
  if (!a.bare.empty())  // CLI11 supports optional values only for flags
    return app.add_flag(a.name + "{" + a.bare + "}", *std::get<std::string*>(a.target));
  return std::visit([&](auto* to) -> CLI::Option* { return app.add_option(names, *to); }, a.target);
}

CLI::Validator member_of(const Words& choices) {
  return {[choices](const std::string& found) {
            if (std::find(choices.begin(), choices.end(), found) != choices.end())
              return std::string();
            return storage::not_one_of(choices, found);
          },
          ""};
}

CLI::Validator existing(Argument::Takes takes) {
  return {
      [takes](const std::string& path) {
        std::error_code error;
        const fs::file_status found = fs::status(path, error);
        using Takes = Argument::Takes;
        if (!fs::exists(found))
          return std::string(takes == Takes::folder ? "there is no folder " : "there is no file ") +
                 path;
        if (takes == Takes::folder && !fs::is_directory(found)) return path + " is not a folder";
        if (takes == Takes::file && fs::is_directory(found))
          return path + " is a folder, not a file";
        return std::string();
      },
      ""};
}

CLI::Validator calendar_day() {
  return {[](const std::string& found) {
            return found.empty() || is_day(found)
                       ? std::string()
                       : "expected a day as YYYY-MM-DD, found \"" + found + "\"";
          },
          ""};
}

CLI::Validator between(double least, double most) {
  return {[least, most](const std::string& found) {
            double value = 0.0;
            const char* const end = found.data() + found.size();
            const auto [at, error] = std::from_chars(found.data(), end, value);
            if (error == std::errc() && at == end && value >= least && value <= most)
              return std::string();
            std::string text = "expected a number from ";
            append_shortest(text, least);
            append_shortest(text += " to ", most);
            return text + ", found \"" + found + "\"";
          },
          ""};
}

void check(CLI::Option& option, const Argument& a) {
  if (a.required) option.required();
  if (a.exists) option.check(existing(a.takes));
  if (a.takes == Argument::Takes::day) option.check(calendar_day());
  if (!a.choices.empty()) option.check(member_of(a.choices));
  if (a.range) option.check(between(a.range->first, a.range->second));
}

Words split(const std::string& text) {
  std::istringstream stream(text);
  Words words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

const Verb* find(const std::vector<Verb>& verbs, const std::string& name) {
  const auto it =
      std::find_if(verbs.begin(), verbs.end(), [&](const Verb& v) { return v.name == name; });
  return it == verbs.end() ? nullptr : &*it;
}

Words names_of(const std::vector<Verb>& verbs) {
  Words names;
  for (const Verb& v : verbs)
    if (!v.heading.empty()) names.push_back(v.name);
  return names;
}

struct Found {
  const Verb* verb = nullptr;
  std::string path;
  std::string typed;
  Words rest{};
  std::string wrong{};  ///< error for a word that is not a command
  const Alias* alias = nullptr;
};

const Alias* alias_of(const Program& program, const Words& words) {
  const Alias* longest = nullptr;
  for (const Alias& alias : program.aliases) {
    const Words old = split(alias.old_words);
    if (old.size() <= words.size() && std::equal(old.begin(), old.end(), words.begin()) &&
        (longest == nullptr || alias.old_words.size() > longest->old_words.size()))
      longest = &alias;
  }
  return longest;
}

std::string hint_for(const Program& program, const std::string& word) {
  Words names;
  for (const Verb& v : program.verbs) {
    names.push_back(v.name);
    for (const Verb& inner : v.verbs) names.push_back(v.name + " " + inner.name);
  }
  const auto meant = [](const std::string& command) {
    return " (did you mean \"nonio " + command + "\"?)";
  };
  for (const auto& [synonym, command] : program.synonyms)
    if (word == synonym) return meant(command);
  for (const std::string& name : names)
    if (name.ends_with(" " + word)) return meant(name);
  for (const Alias& alias : program.aliases) names.push_back(alias.old_words);
  return storage::suggestion(word, names);
}

std::string no_command(const Program& program, const Found& at, const std::string& word) {
  const Words names = names_of(at.verb->verbs);
  const std::string hint =
      at.path == program.name ? hint_for(program, word) : storage::suggestion(word, names);
  return at.path + ": there is no command \"" + word + "\"" +
         (!hint.empty()             ? hint
          : at.path == program.name ? ". `" + program.name + " help` lists the commands"
                                    : "; there are " + storage::listed(names));
}

Found find(const Program& program, const Verb& top, const Words& typed) {
  Found found{&top, program.name, program.name};
  found.alias = alias_of(program, typed);
  Words words = typed;
  if (found.alias != nullptr) {
    const Words present = split(found.alias->words);
    words.erase(words.begin(),
                words.begin() + std::ptrdiff_t(split(found.alias->old_words).size()));
    words.insert(words.begin(), present.begin(), present.end());
  }
  std::size_t used = 0;
  for (; used < words.size() && !found.verb->verbs.empty() && !words[used].starts_with('-');
       ++used) {
    const Verb* next = find(found.verb->verbs, words[used]);
    if (next == nullptr) {
      if (!found.verb->run) found.wrong = no_command(program, found, words[used]);
      break;
    }
    found.verb = next;
    found.path += " " + words[used];
  }
  found.rest.assign(words.begin() + std::ptrdiff_t(used), words.end());
  found.typed = found.alias == nullptr ? found.path : program.name + " " + found.alias->old_words;
  return found;
}

bool is_option(const std::string& word) {
  return word.size() > 1 && word[0] == '-' && word.find_first_of("0123456789.") != 1;
}

/// The values of the options are omitted.
Words options_of(const Verb& verb, const Words& words) {
  Words options;
  for (std::size_t i = 0; i < words.size() && words[i] != "--"; ++i) {
    if (!is_option(words[i])) continue;
    options.push_back(words[i].substr(0, words[i].find('=')));
    for (const Argument& a : verb.arguments)
      if ((a.name == words[i] || a.old == words[i]) && a.needs_value()) ++i;
  }
  return options;
}

std::string unknown_option(const Verb& verb, const Words& options, bool at_top) {
  Words own{"--help", "-h"}, accepted;
  if (at_top) own.emplace_back("--version");
  for (const Argument& a : verb.arguments) {
    if (a.is_positional()) continue;
    (a.hidden ? accepted : own).push_back(a.name);
    accepted.insert(accepted.end(), {a.brief, a.old});
  }
  accepted.insert(accepted.end(), own.begin(), own.end());
  for (const std::string& option : options)
    if (std::find(accepted.begin(), accepted.end(), option) == accepted.end())
      return "there is no option " + option + storage::suggestion(option, own);
  return {};
}

bool has(const Words& options, const char* name) {
  return std::find(options.begin(), options.end(), name) != options.end();
}

bool asks_for_help(const Words& options) { return has(options, "--help") || has(options, "-h"); }

std::string complaint_about(const Found& found, const Words& options, const Program& program) {
  if (!found.wrong.empty()) return found.wrong;
  if (const std::string wrong = unknown_option(*found.verb, options, found.path == program.name);
      !wrong.empty())
    return found.typed + ": " + wrong;
  if (!found.verb->run && !asks_for_help(options) && !has(options, "--version"))
    return found.typed + ": expected one of " + storage::listed(names_of(found.verb->verbs));
  return {};
}

std::string value_of(const Argument& a) {
  if (!a.choices.empty()) {
    std::string all;
    for (const std::string& choice : a.choices) all += (all.empty() ? "" : "|") + choice;
    return all.size() <= 24 ? all : "NAME";
  }
  switch (a.takes) {
    case Argument::Takes::folder:
      return "FOLDER";
    case Argument::Takes::file:
      return "FILE";
    case Argument::Takes::path:
      return "PATH";
    case Argument::Takes::number:
      return "NUMBER";
    case Argument::Takes::day:
      return "DAY";
    case Argument::Takes::control:
      return "CONTROL";
    case Argument::Takes::anything:
      break;
  }
  if (std::holds_alternative<std::int64_t*>(a.target) ||
      std::holds_alternative<std::uint64_t*>(a.target))
    return "N";
  return std::holds_alternative<double*>(a.target) ? "NUMBER" : "TEXT";
}

std::string left_column(const Argument& a) {
  if (a.is_positional()) return a.name + (a.is_list() ? "..." : "");
  if (a.is_flag()) return (a.brief.empty() ? "" : a.brief + ", ") + a.name;
  return a.bare.empty() ? a.name + " " + value_of(a) : a.name + "[=" + value_of(a) + "]";
}

std::string right_column(const Argument& a) {
  std::string text = a.help;
  std::replace(text.begin(), text.end(), '\n', ' ');
  if (value_of(a) == "NAME" && !a.choices.empty()) text += "; one of " + storage::listed(a.choices);
  if (a.shows_default)
    text += " (default: " +
            std::visit(
                [](auto* target) -> std::string {
                  using T = std::remove_pointer_t<decltype(target)>;
                  if constexpr (std::is_same_v<T, Words>) return storage::listed(*target);
                  std::ostringstream out;
                  if constexpr (!std::is_same_v<T, Words>) out << *target;
                  return out.str();
                },
                a.target) +
            ")";
  return text + (a.required && !a.is_positional() ? " (required)" : "");
}

class HelpPage {
 public:
  HelpPage(std::ostream& out, int descriptor)
      : out_(out), descriptor_(descriptor), width_(line_width(descriptor)) {}

  void program(const Program& p) {
    out_ << wrapped(one_paragraph(p.summary), 0, width_) << "\nUsage: " << p.name
         << " COMMAND [ARGUMENTS]\n";
    verbs(p.verbs);
    out_ << "\n" << wrapped(p.footer, 0, width_);
  }

  void command(const Found& found) {
    const Verb& v = *found.verb;
    out_ << wrapped(v.summary + (v.summary.ends_with('.') ? "" : "."), 0, width_) << "\n";
    if (v.run) out_ << wrapped("Usage: " + synopsis(found.path, v), 0, width_, 7);
    if (!v.verbs.empty()) out_ << "Usage: " << found.path << " COMMAND [ARGUMENTS]\n";
    verbs(v.verbs);
    arguments(v, "Arguments:", true);
    arguments(v, "Options:", false);
    if (!v.footer.empty()) out_ << "\n" << wrapped(v.footer, 0, width_);
    if (v.examples.empty()) return;
    heading(v.examples.size() == 1 ? "Example:" : "Examples:");
    for (const std::string& example : v.examples) out_ << command_lines(example);
  }

  static std::string synopsis(const std::string& path, const Verb& v) {
    std::string line = path;
    bool has_options = false;
    for (const Argument& a : v.arguments) {
      if (a.is_positional())
        line += " " + (a.required ? left_column(a) : "[" + left_column(a) + "]");
      else if (a.required)
        line += " " + left_column(a);
      else
        has_options = has_options || !a.hidden;
    }
    return line + (has_options ? " [OPTIONS]" : "");
  }

 private:
  /// An example that can be pasted: divided between words outside of quotes, with a backslash.
  std::string command_lines(const std::string& example) const {
    std::string out, row = "  ";
    std::istringstream words(example);
    std::string word;
    for (std::string part; std::getline(words, part, ' ');) {
      word += (word.empty() ? "" : " ") + part;
      if (std::count(word.begin(), word.end(), '"') % 2 != 0) continue;
      if (row.size() > 4 && row.size() + word.size() + 3 > width_) {
        out += row + " \\\n";
        row = "   ";
      }
      row += (row == "  " ? "" : " ") + std::exchange(word, "");
    }
    return out + row + "\n";
  }

  static std::string one_paragraph(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
  }

  void heading(const std::string& text) {
    out_ << "\n" << coloured(text, Colour::bold, descriptor_) << "\n";
  }

  void row(const std::string& left, std::size_t column, const std::string& right) {
    const std::string text = wrapped(right, column, width_);
    if (columns_of(left) + 3 > column)
      out_ << "  " << left << "\n" << text;
    else
      out_ << "  " << padded(left, column - 2) << text.substr(column);
  }

  void verbs(const std::vector<Verb>& all) {
    std::string last;
    for (const Verb& v : all) {
      if (v.heading.empty()) continue;
      if (v.heading != last) heading((last = v.heading) + ":");
      std::string names;
      for (const Verb& inner : v.verbs) names += (names.empty() ? "" : ", ") + inner.name;
      row(v.name, 15, v.summary + (names.empty() ? "" : " (" + names + ")"));
    }
  }

  void arguments(const Verb& v, const char* title, bool positional) {
    std::size_t column = 0;
    for (const Argument& a : v.arguments)
      if (a.is_positional() == positional && !a.hidden)
        column = std::max(column, std::min<std::size_t>(columns_of(left_column(a)) + 4, 28));
    if (!positional) column = std::max<std::size_t>(column, 12);
    bool is_first = true;
    for (const Argument& a : v.arguments) {
      if (a.is_positional() != positional || a.hidden) continue;
      if (std::exchange(is_first, false)) heading(title);
      row(left_column(a), column, right_column(a));
    }
  }

  std::ostream& out_;
  int descriptor_;
  std::size_t width_;
};

Verb top_of(const Program& program) {
  return {.name = program.name, .summary = program.summary, .verbs = program.verbs};
}

void print_help(const Program& program, const Found& found, std::ostream& out, int descriptor) {
  HelpPage page(out, descriptor);
  found.path == program.name ? page.program(program) : page.command(found);
}

/// Names the argument that is missing or lacks its value, what it means, and an example.
std::string message_of(const CLI::ParseError& e, const Found& found) {
  const std::string raw = e.what();
  if (dynamic_cast<const CLI::ExtrasError*>(&e) != nullptr) {
    const Words extra = split(raw.substr(raw.find(": ") + 2));  // in reversed order
    return "unexpected argument \"" + extra.back() + "\"; expected " +
           HelpPage::synopsis(found.path, *found.verb);
  }
  const bool is_missing = dynamic_cast<const CLI::RequiredError*>(&e) != nullptr;
  if (!is_missing && dynamic_cast<const CLI::ArgumentMismatch*>(&e) == nullptr) return raw;
  const std::string name = raw.substr(0, raw.find_first_of(": "));
  std::string text = raw;
  for (const Argument& a : found.verb->arguments)
    if (a.name == name)
      text = (is_missing ? left_column(a) + " is missing"
                         : name + " requires a value, " + left_column(a)) +
             ": " + a.help;
  if (!found.verb->examples.empty()) text += "\nExample: " + found.verb->examples.front();
  return text;
}

int parse(const Found& found, const Words& options) {
  CLI::App cli;
  for (const Argument& a : found.verb->arguments) check(*bind(cli, a), a);
  Words reversed(found.rest.rbegin(), found.rest.rend());
  try {
    cli.parse(std::move(reversed));
  } catch (const CLI::ParseError& e) {
    std::cerr << found.typed << ": " << message_of(e, found) << "\nSee `" << found.path
              << " --help`.\n";
    return exit_usage;
  }
  for (const Argument& a : found.verb->arguments)
    if (!a.old.empty() && has(options, a.old.c_str()))
      std::cerr << found.typed << ": the option " << a.old << " is now " << a.name << "\n";
  return exit_done;
}

}  // namespace

std::vector<Argument> joined(std::vector<Argument> first, const std::vector<Argument>& second,
                             const std::vector<Argument>& third,
                             const std::vector<Argument>& fourth) {
  for (const auto* more : {&second, &third, &fourth})
    first.insert(first.end(), more->begin(), more->end());
  return first;
}

const std::string& command_words() { return typed_words(); }

std::string synopsis(const std::string& path, const Verb& verb) {
  return HelpPage::synopsis(path, verb);
}

int show_help(const Program& program, const Words& words) {
  const Verb top = top_of(program);
  Found found = find(program, top, words);
  if (found.alias != nullptr) found.rest.clear();
  if (found.wrong.empty() && found.rest.empty()) {
    print_help(program, found, std::cout, STDOUT_FILENO);
    return exit_done;
  }
  std::cerr << (found.wrong.empty() ? found.path + ": there is no command below it" : found.wrong)
            << "\n";
  return exit_usage;
}

int run(const Program& program, int argc, const char* const* argv) {
  const Words words(argv + std::min(argc, 1), argv + argc);
  const Verb top = top_of(program);
  const Found found = find(program, top, words);
  typed_words() = found.typed;
  if (words.empty()) {
    print_help(program, found, std::cerr, STDERR_FILENO);
    return exit_usage;
  }
  const Words options = options_of(*found.verb, found.rest);
  if (const std::string wrong = complaint_about(found, options, program); !wrong.empty()) {
    std::cerr << wrong << "\nSee `" << found.path << " --help`.\n";
    return exit_usage;
  }
  if (asks_for_help(options)) {
    print_help(program, found, std::cout, STDOUT_FILENO);
    return exit_done;
  }
  if (found.path == program.name) {
    std::cout << program.name << " " << program.version << "\n";
    return exit_done;
  }
  if (found.alias != nullptr && found.alias->is_announced)
    std::cerr << "'" << found.typed << "' is now '" << program.name << " " << found.alias->words
              << "'; the old name will be removed in version " << program.aliases_until << "\n";
  if (const int status = parse(found, options); status != exit_done) return status;
  try {
    return found.verb->run();
  } catch (const std::bad_alloc&) {
    std::cerr << found.typed << ": out of memory\n";
  } catch (const std::exception& e) {
    std::cerr << found.typed << ": " << e.what() << "\n";
  }
  return exit_failed;
}

}  // namespace nonio::app
