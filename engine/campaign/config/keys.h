// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>

/// Declares the keys of Nonio's TOML files as data. `TableReader` uses them to fill structs,
/// `schema.cpp` to make a JSON schema. Checks that involve several keys are functions of checks.h.
namespace nonio::config {

struct Choice {
  std::string_view name;
  /// Text that messages show in brackets after the name: "um (deviation)".
  std::string_view meaning{};
  int value = 0;  ///< value of the enum or bool that the choice sets
};

/// Condition that another key of the same table has one of these values.
struct When {
  std::string_view key{};
  std::span<const std::string_view> values{};
};

/// Rules for the characters, the length and the beginning of a text, with texts that are refused.
/// An empty text is always accepted.
struct TextRule {
  std::string_view letters{};      ///< allowed characters: "a-z0-9._-"; empty: all
  std::string_view not_letters{};  ///< characters that are not allowed
  std::string_view not_first{};
  std::size_t shortest = 0, longest = 0;  ///< limits of the length in bytes; 0: no limit
  std::span<const std::string_view> except{};
  std::string_view begins{};
};

/// Kind of name that a text contains. Valid names are known only at run time, from the loaded
/// plugins.
enum class Named { nothing, method, reader, effect, analysis, output, control };

class TableReader;

struct Key {
  enum class Holds {
    text,            ///< one line of text
    number,          ///< a finite number
    number_or_none,  ///< a finite number, or the text "none"
    whole,           ///< a whole number from 0 to 1000000000
    flag,            ///< a flag: true or false
    date,            ///< a date without quotes
    texts,           ///< a list of texts
    numbers,         ///< a list of numbers
    wholes,          ///< a list of whole numbers
    span,            ///< two numbers, the smaller first
    number_table,    ///< a table of numbers under any name
    translations,    ///< a text, or a table of texts by language
    table,           ///< a table with the keys in `keys`
    tables,          ///< a list of tables with the keys in `keys`: [[name]]
    named_tables,    ///< tables with the keys in `keys`, under any name
    options,         ///< a table for each plugin, with its options
    anything,        ///< a table whose content is not checked
    by_kind          ///< a key that different methods declare differently
  };

  /// Kind of value of a key, and the function that reads it into a member of the struct that the
  /// table fills. bind.h makes it. A key that is made from `Holds` alone is only checked.
  struct Into {
    Holds holds;
    void (*read)(TableReader&, const Key&, void* object) = nullptr;
    const void* of = nullptr;     ///< identifies the type of `object`
    const void* inner = nullptr;  ///< identifies the type that the keys of an inner table fill
    bool by_choice = false;       ///< the member receives the `Choice::value` of the text
    constexpr Into(Holds h) : holds(h) {}
    template <class Read>
    constexpr Into(Holds h, Read r, const void* o, const void* i = nullptr, bool c = false)
        : holds(h), read(r), of(o), inner(i), by_choice(c) {}
  };

  std::string_view name;
  Holds holds;
  std::string_view help;  ///< explanation in plain English; the first letter is a capital
  Into into;
  std::string_view unit{};  ///< unit as documentation states it: "um", "mm or deg"; empty: none
  double scale = 1.0;       ///< factor from this unit to that of the member
  std::string_view otherwise{};  ///< default value that schema and reference state; empty: none
  bool required = false;
  When only{};    ///< condition without which the key is unknown
  When needed{};  ///< condition under which the key is required
  /// Text after "x: is missing: " in the message about a missing key; empty: the message is "x is
  /// missing".
  std::string_view missing{};
  /// Message about a value that the following limits refuse; {} is replaced by the value.
  std::string_view wanted{};
  bool may_be_secret = false;  ///< messages do not repeat the text, because it may be a password
  /// Allowed values of a text or of each text of a list; empty: all.
  std::span<const Choice> choices{};
  Named named = Named::nothing;  ///< kind of name that a text, or each text of a list, contains
  TextRule text{};               ///< rule for a text, or for each text of a list
  /// Limits, in `unit`, of a number or of each number of a list or table.
  std::optional<double> least{}, most{};
  bool above = false;            ///< the value must be greater than `least`
  std::size_t longest_list = 0;  ///< largest number of elements of a list; 0: no limit
  bool distinct = false;         ///< all elements of a list must differ
  std::span<const Key> keys{};   ///< keys of a table or of each table of a list
  /// For named_tables: if the name of a table begins with one of these letters, its key `by_name`
  /// has the default `named_so`.
  std::string_view initials{};
  std::string_view by_name{};
  std::string_view named_so{};
  /// Name of the key in an earlier version. It is accepted with a warning; schema and reference
  /// omit it.
  std::string_view former{};

  /// Attributes are choices, keys, `Named` and the attributes of bind.h. For a constant, an
  /// exception in this constructor is a compile-time error.
  template <class... Attributes>
  constexpr Key(std::string_view n, Into i, std::string_view h, const Attributes&... attributes)
      : name(n), holds(i.holds), help(h), into(i) {
    (set(attributes), ...);
    if (into.by_choice && choices.empty()) throw std::logic_error("a key without choices");
    for (const Key& key : keys)
      if (key.into.of != nullptr && key.into.of != into.inner)
        throw std::logic_error("a key of another struct than that of its table");
  }

 private:
  constexpr void set(Named kind) { named = kind; }
  constexpr void set(std::span<const Choice> all) { choices = all; }
  constexpr void set(std::span<const Key> all) { keys = all; }
  template <class Attribute>
  requires std::is_invocable_v<const Attribute&, Key&>
  constexpr void set(const Attribute& attribute) { attribute(*this); }
};

/// Return the declarations of campaign.toml and of site.toml, each as one table. Any other key is
/// an error.
const Key& campaign_file();
const Key& site_file();
/// Returns the declaration of SITE/machines/<asset>.toml.
const Key& machine_file();
/// Return the declarations of files in which people make entries: SITE/events.toml (events of
/// machines), acknowledged.toml (findings that are known) and forgotten.toml (campaigns and files
/// that were removed on purpose).
const Key& events_file();
const Key& acknowledged_file();
const Key& forgotten_file();
/// Returns the declaration of causes/*.toml of the templates and of a site.
const Key& causes_file();
/// Key that conditions name (`When::key`) for the kind of a simulated test cycle. Files do not
/// contain it: the code that reads cycles sets its value with `TableReader::settle`.
inline constexpr std::string_view cycle_axis = "(axis)";

/// Names that a campaign must not have, because a run writes such files next to the campaigns'
/// folders or a site contains them.
inline constexpr std::string_view reserved_names[] = {"summary.json",
                                                      "summary.txt",
                                                      "history.sqlite",
                                                      "history.json",
                                                      "index.html",
                                                      "due.html",
                                                      "due.ics",
                                                      "instruments.html",
                                                      "compare.html",
                                                      "machines",
                                                      "history.sqlite-journal",
                                                      "history.sqlite-shm",
                                                      "history.sqlite-wal",
                                                      "site.toml",
                                                      "events.toml",
                                                      "acknowledged.toml",
                                                      "forgotten.toml",
                                                      "templates"};
/// Rule for the asset number of a machine, which names the file of its record in SITE/machines.
inline constexpr TextRule asset_rule{.not_letters = "/\\\n\t", .not_first = ". ", .longest = 100};
/// Message and rule for the id of a campaign, which names its folder of results.
inline constexpr const char* campaign_id_wanted =
    "expected a-z 0-9 . _ - and no more than 100, not starting with . or -, and no name of a file "
    "of the program (summary.json, machines); found \"{}\"";
inline constexpr TextRule campaign_id_rule{
    .letters = "a-z0-9._-", .not_first = ".-", .longest = 100, .except = reserved_names};

bool obeys(std::string_view text, const TextRule& rule);
bool in_range(double value, const Key& key);
const Key* find_key(std::span<const Key> keys, std::string_view name);
/// Whether an axis is rotary according to its name, which then begins with A, B or C (ISO 841).
bool rotary_by_name(std::string_view axis);

}  // namespace nonio::config
