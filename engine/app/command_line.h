// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

/// The commands and their arguments are data, from which parser, help, man page, shell completion
/// and reference are made.
namespace nonio::app {

inline constexpr int exit_done = 0, exit_failed = 1, exit_usage = 2, exit_interrupted = 130;

/// Variable that receives the value of an argument; a bool is a flag, and a vector collects
/// repeated options.
using Target = std::variant<bool*, std::string*, std::vector<std::string>*, std::int64_t*,
                            std::uint64_t*, double*>;

struct Argument {
  enum class Takes { anything, folder, file, path, number, day, control };

  std::string name;  ///< option ("--out") or positional argument ("SITE")
  Target target;
  std::string help;
  bool required = false;
  Takes takes = Takes::anything;
  bool exists = false;                 ///< whether the path must exist
  std::vector<std::string> choices{};  ///< accepted values; empty if any value is accepted
  /// Values offered by completion; other values are accepted too.
  std::vector<std::string> offers{};
  std::optional<std::pair<double, double>> range{};  ///< closed interval of a number
  std::string bare{};  ///< value of `--name` without "="; empty if a value is required
  bool shows_default = false;
  std::string brief{};
  std::string old{};  ///< former name, which is still accepted
  /// Accepted, but not listed in help, because it belongs to a former command.
  bool hidden = false;

  bool is_positional() const { return !name.starts_with('-'); }
  bool is_flag() const { return std::holds_alternative<bool*>(target); }
  bool is_list() const { return std::holds_alternative<std::vector<std::string>*>(target); }
  bool needs_value() const { return !is_positional() && !is_flag() && bare.empty(); }
};

inline Argument required(Argument a) {
  a.required = true;
  return a;
}
/// Marks the argument as a path that must exist.
inline Argument existing(Argument::Takes kind, Argument a) {
  a.takes = kind;
  a.exists = true;
  return a;
}
/// Marks the argument as a path that need not exist.
inline Argument takes(Argument::Takes kind, Argument a) {
  a.takes = kind;
  return a;
}
/// Marks the value as a number. The command parses the text itself to keep its digits.
inline Argument number(Argument a) { return takes(Argument::Takes::number, std::move(a)); }
/// Marks the value as a day, YYYY-MM-DD, which is checked before the command runs.
inline Argument day(Argument a) { return takes(Argument::Takes::day, std::move(a)); }
inline Argument one_of(std::vector<std::string> choices, Argument a) {
  a.choices = std::move(choices);
  return a;
}
inline Argument offering(std::vector<std::string> words, Argument a) {
  a.offers = std::move(words);
  return a;
}
inline Argument within(double least, double most, Argument a) {
  a.range = {least, most};
  return a;
}
std::vector<Argument> joined(std::vector<Argument> first, const std::vector<Argument>& second,
                             const std::vector<Argument>& third = {},
                             const std::vector<Argument>& fourth = {});

/// A command, or a group of commands, whose `run` is empty unless the group itself is a command.
struct Verb {
  std::string name, summary;
  std::vector<Argument> arguments{};
  std::string footer{};  ///< paragraphs after the arguments in the help
  std::vector<std::string> examples{};
  std::function<int()> run{};
  std::vector<Verb> verbs{};
  /// Heading of the command in the help; empty if the command is not listed.
  std::string heading{};
};

/// A former name of a command; `words` replaces `old_words`, both separated by spaces.
struct Alias {
  std::string old_words, words;
  bool is_announced = true;  ///< whether its use causes a message with the new name on stderr
};

struct Program {
  std::string name, version;
  std::string purpose;  ///< short phrase for the NAME section of the man page
  std::string summary, footer;
  std::vector<Verb> verbs{};
  std::vector<Alias> aliases{};
  std::string aliases_until{};  ///< version that removes the aliases
  /// Pairs of a word that users may type and the command that is suggested for it.
  std::vector<std::pair<std::string, std::string>> synonyms{};
};

/// Parses the arguments and runs the command. Returns its exit status, or 0 for help and version, 2
/// for a usage error, 1 if the command throws an exception.
int run(const Program& program, int argc, const char* const* argv);
/// Returns the command as typed, for example "nonio model add".
const std::string& command_words();

/// Prints the help of one command, such as {"plan", "triples"}, or of the program if `words` is
/// empty. Returns the exit status, 2 if the command does not exist.
int show_help(const Program& program, const std::vector<std::string>& words);

/// Example: "nonio plan triples --x NUMBER --y NUMBER [OPTIONS]".
std::string synopsis(const std::string& path, const Verb& verb);
/// Writes the source of the page for man(1).
void write_man_page(const Program& program, std::ostream& out);
/// Writes the completion script for the shell "bash" or "zsh".
void write_completion(const Program& program, const std::string& shell, std::ostream& out);
/// Writes the table of commands as JSON of schema nonio-commands/1.
void write_table(const Program& program, std::ostream& out);

}  // namespace nonio::app
