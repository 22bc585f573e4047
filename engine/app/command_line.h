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

/// The command line as data: one table of commands and their arguments. Parsing, help, the hint for
/// a mistyped word, the man page, the completion of shells and the reference come from it. `Option`
/// of the SDK cannot replace `Argument`: it describes values that a plugin looks up by name, while
/// an argument has a place, flags, lists, paths that must exist, and the member that it fills.
namespace nonio::app {

inline constexpr int exit_done = 0, exit_failed = 1, exit_usage = 2, exit_interrupted = 130;

/// Where the value of an argument goes; a bool is a flag, a list may be given
/// several times.
using Target = std::variant<bool*, std::string*, std::vector<std::string>*, std::int64_t*,
                            std::uint64_t*, double*>;

struct Argument {
  /// What a value has to be before the verb is run; completion offers files
  /// accordingly.
  enum class Takes { anything, folder, file, path };

  std::string name;  ///< "--out", or in capital letters, "SITE": a place without a name
  Target target;
  std::string help;
  bool required = false;
  Takes takes = Takes::anything;
  bool exists = false;                 ///< the folder, file or path must be there
  std::vector<std::string> choices{};  ///< empty: any
  std::vector<std::string> offers{};   ///< what completion offers where there are no choices
  std::optional<std::pair<double, double>> range{};  ///< of a number, both ends included
  std::string bare{};          ///< the value of `--name` without one; empty: it needs one
  bool shows_default = false;  ///< help states the value that it has if it is not given
  std::string brief{};         ///< "-v"
  std::string old{};           ///< former name, still accepted
  bool hidden = false;         ///< accepted, and not listed: it belongs to a former command

  bool is_positional() const { return !name.starts_with('-'); }
  bool is_flag() const { return std::holds_alternative<bool*>(target); }
  bool is_list() const { return std::holds_alternative<std::vector<std::string>*>(target); }
  bool needs_value() const { return !is_positional() && !is_flag() && bare.empty(); }
};

inline Argument required(Argument a) {
  a.required = true;
  return a;
}
/// A value that names what must be there.
inline Argument existing(Argument::Takes kind, Argument a) {
  a.takes = kind;
  a.exists = true;
  return a;
}
/// A value that names a file or folder, there or not; or several with ','
/// between them.
inline Argument takes(Argument::Takes kind, Argument a) {
  a.takes = kind;
  return a;
}
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

/// A command, or a group of commands: `nonio plan triples`. `run` of a group is empty, unless the
/// group can be run itself: `nonio run SITE`.
struct Verb {
  std::string name, summary;
  std::vector<Argument> arguments{};
  std::string footer{};  ///< paragraphs of the help below the arguments
  std::vector<std::string> examples{};
  std::function<int()> run{};
  std::vector<Verb> verbs{};
  std::string heading{};  ///< of the help under which it is listed; empty: not listed
};

/// A former name. `words` take the place of `old_words`; both are separated by spaces.
struct Alias {
  std::string old_words, words;
  bool is_announced = true;  ///< on stderr, with the new name
};

struct Program {
  std::string name, version;
  std::string purpose;  ///< a few words, after the name in man(1)
  std::string summary, footer;
  std::vector<Verb> verbs{};
  std::vector<Alias> aliases{};
  std::string aliases_until{};  ///< the version that removes them
  /// A word that a user may type, and the command for it.
  std::vector<std::pair<std::string, std::string>> synonyms{};
};

/// Fills the targets and runs the command. Help goes to stdout, what is wrong to stderr with the
/// command or option that may be meant. The exit status: that of the command, 0 for help, 2 for a
/// mistake.
int run(const Program& program, int argc, const char* const* argv);
/// The words by which the running command was called: "nonio model add".
const std::string& command_words();

/// Prints the help of one command, `words` = {"plan", "triples"}, or of the program. The exit
/// status: 2 if there is no such command.
int show_help(const Program& program, const std::vector<std::string>& words);

/// "nonio plan triples --x NUMBER --y NUMBER [OPTIONS]"
std::string synopsis(const std::string& path, const Verb& verb);
/// A page for man(1).
void write_man_page(const Program& program, std::ostream& out);
/// Completion for "bash" or "zsh".
void write_completion(const Program& program, const std::string& shell, std::ostream& out);
/// The whole table as JSON, schema nonio-commands/1.
void write_table(const Program& program, std::ostream& out);

}  // namespace nonio::app
