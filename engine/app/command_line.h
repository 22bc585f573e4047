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

/// The command line as data: one table of commands and their arguments, from which parsing, help,
/// hints for mistyped words, the man page, shell completion and the reference are made. `Option` of
/// the SDK cannot replace `Argument`, because it has no position, flags, lists or paths that must
/// exist, and sets no member.
namespace nonio::app {

inline constexpr int exit_done = 0, exit_failed = 1, exit_usage = 2, exit_interrupted = 130;

/// Member that an argument sets; a bool is a flag, and a list may be given several times.
using Target = std::variant<bool*, std::string*, std::vector<std::string>*, std::int64_t*,
                            std::uint64_t*, double*>;

struct Argument {
  /// What a value must denote, checked before the command runs; completion offers files
  /// accordingly.
  enum class Takes { anything, folder, file, path, number, day };

  std::string name;  ///< name of an option, "--out", or of a positional argument in capital
                     ///< letters, "SITE"
  Target target;
  std::string help;
  bool required = false;
  Takes takes = Takes::anything;
  bool exists = false;                 ///< whether the folder, file or path must exist
  std::vector<std::string> choices{};  ///< accepted values; empty: any
  std::vector<std::string> offers{};   ///< values offered by completion, which are not the only
                                       ///< accepted ones
  std::optional<std::pair<double, double>> range{};  ///< range of a number, both ends included
  std::string bare{};          ///< value of `--name` given without a value; empty: a value is
                               ///< required
  bool shows_default = false;  ///< whether the help states the default value
  std::string brief{};         ///< short form, for example "-v"
  std::string old{};           ///< former name of the argument, which is still accepted
  bool hidden = false;         ///< whether the argument is accepted but not listed, since it
                               ///< belongs to a former command

  bool is_positional() const { return !name.starts_with('-'); }
  bool is_flag() const { return std::holds_alternative<bool*>(target); }
  bool is_list() const { return std::holds_alternative<std::vector<std::string>*>(target); }
  bool needs_value() const { return !is_positional() && !is_flag() && bare.empty(); }
};

inline Argument required(Argument a) {
  a.required = true;
  return a;
}
/// Marks the argument as a path of this kind that must exist.
inline Argument existing(Argument::Takes kind, Argument a) {
  a.takes = kind;
  a.exists = true;
  return a;
}
/// Marks the argument as a path of this kind that need not exist, or as several paths separated by
/// commas.
inline Argument takes(Argument::Takes kind, Argument a) {
  a.takes = kind;
  return a;
}
/// Marks the value as a number, which the command parses itself to keep its digits.
inline Argument number(Argument a) { return takes(Argument::Takes::number, std::move(a)); }
/// Marks the value as a day, YYYY-MM-DD, checked before the command runs.
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

/// A command, or a group of commands such as `nonio plan`. `run` of a group is empty, unless the
/// group itself is a command, such as `nonio run SITE`.
struct Verb {
  std::string name, summary;
  std::vector<Argument> arguments{};
  std::string footer{};  ///< paragraphs below the arguments in the help
  std::vector<std::string> examples{};
  std::function<int()> run{};
  std::vector<Verb> verbs{};
  std::string heading{};  ///< heading under which the help lists the command; empty: not listed
};

/// A former name of a command. `words` replace `old_words`; both are separated by spaces.
struct Alias {
  std::string old_words, words;
  bool is_announced = true;  ///< whether its use is reported on stderr with the new name
};

struct Program {
  std::string name, version;
  std::string purpose;  ///< a few words that follow the name in man(1)
  std::string summary, footer;
  std::vector<Verb> verbs{};
  std::vector<Alias> aliases{};
  std::string aliases_until{};  ///< version that removes the former names
  /// Pairs of a word that users may type and the command for it.
  std::vector<std::pair<std::string, std::string>> synonyms{};
};

/// Parses the arguments and runs the command. Help is printed on stdout, errors on stderr with the
/// command or option that may be meant. Returns the exit status: that of the command, 0 for help
/// and version, 2 for a usage error, 1 if the command throws an exception.
int run(const Program& program, int argc, const char* const* argv);
/// Returns the words with which the running command was called, for example "nonio model add".
const std::string& command_words();

/// Prints the help of one command, `words` = {"plan", "triples"}, or of the program. Returns the
/// exit status: 2 if the command does not exist.
int show_help(const Program& program, const std::vector<std::string>& words);

/// Returns, for example, "nonio plan triples --x NUMBER --y NUMBER [OPTIONS]".
std::string synopsis(const std::string& path, const Verb& verb);
/// Writes the manual page for man(1).
void write_man_page(const Program& program, std::ostream& out);
/// Writes the completion script for "bash" or "zsh".
void write_completion(const Program& program, const std::string& shell, std::ostream& out);
/// Writes the table of commands as JSON, schema nonio-commands/1.
void write_table(const Program& program, std::ostream& out);

}  // namespace nonio::app
