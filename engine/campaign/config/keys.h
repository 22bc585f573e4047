// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>
#include <type_traits>

/// Declares the keys of Nonio's TOML files as data, from which `TableReader` fills structs and
/// `schema.cpp` makes a JSON schema. Checks that involve several keys are functions of checks.h.
namespace nonio::config {

struct Choice {
  std::string_view name;
  /// Text in brackets after the name in messages: "um (deviation)".
  std::string_view meaning{};
  int value = 0;  ///< value of the enum or bool that the choice sets
};

/// Condition that another key of the same table has one of these values.
struct When {
  std::string_view key{};
  std::span<const std::string_view> values{};
};

/// An empty text obeys every rule.
struct TextRule {
  std::string_view letters{};  ///< allowed characters, such as "a-z0-9._-"; all if empty
  std::string_view not_letters{};
  std::string_view not_first{};
  std::size_t shortest = 0, longest = 0;  ///< in bytes; 0 if not limited
  std::span<const std::string_view> except{};
  std::string_view begins{};
};

/// Kind of a name in a text. Valid names are known only at run time, from the loaded plugins.
enum class Named { nothing, method, reader, effect, analysis, output, control };

class TableReader;

struct Key {
  enum class Holds {
    text,            ///< one line of text
    number,          ///< a finite number
    number_or_none,  ///< a finite number, or the text "none"
    whole,           ///< a whole number from 0 to 1000000000
    flag,
    date,  ///< a date without quotes
    texts,
    numbers,
    wholes,
    span,          ///< two numbers, the smaller first
    number_table,  ///< a table of numbers under any name
    translations,  ///< a text, or a table of texts by language
    table,         ///< a table with the keys in `keys`
    tables,        ///< a list of tables with the keys in `keys`: [[name]]
    named_tables,  ///< tables with the keys in `keys`, under any name
    options,       ///< a table for each plugin, with its options
    anything,      ///< a table whose content is not checked
    by_kind        ///< a key that different methods declare differently
  };

  /// Made by bind.h: the kind of value of a key, and the function that reads it into a member. A
  /// key that is made from `Holds` alone is only checked.
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
  std::string_view help;  ///< in plain English, beginning with a capital letter
  Into into;
  std::string_view unit{};       ///< unit in documentation, such as "um" or "mm or deg"
  double scale = 1.0;            ///< factor from `unit` to the unit of the member
  std::string_view otherwise{};  ///< default value in schema and reference, or empty
  bool required = false;
  When only{};    ///< condition without which the key is unknown
  When needed{};  ///< condition under which the key is required
  /// Text after "x: is missing: "; if empty, the message is "x is missing".
  std::string_view missing{};
  /// Message about a value that the following limits refuse; {} is replaced by the value.
  std::string_view wanted{};
  bool may_be_secret = false;  ///< the text may be a password, so messages do not repeat it
  /// Allowed values of a text, or of each text of a list; all if empty.
  std::span<const Choice> choices{};
  Named named = Named::nothing;
  TextRule text{};
  /// Limits in `unit` of a number, or of each number of a list or table.
  std::optional<double> least{}, most{};
  bool above = false;            ///< the value must be greater than `least`
  std::size_t longest_list = 0;  ///< largest number of elements of a list; 0 if not limited
  bool distinct = false;
  std::span<const Key> keys{};
  /// For named_tables: if the name of a table begins with one of these letters, its key `by_name`
  /// has the default `named_so`.
  std::string_view initials{};
  std::string_view by_name{};
  std::string_view named_so{};
  /// Name in an earlier version, accepted with a warning and omitted by schema and reference.
  std::string_view former{};

  /// For a constant, an exception in this constructor is a compile-time error.
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

/// Any key that these declarations of campaign.toml and site.toml do not contain is an error.
const Key& campaign_file();
const Key& site_file();
/// Returns the declaration of SITE/machines/<asset>.toml.
const Key& machine_file();
/// Files in which people make entries.
const Key& events_file();
const Key& acknowledged_file();
const Key& forgotten_file();
/// Returns the declaration of causes/*.toml of the templates and of a site.
const Key& causes_file();
/// Returns the declaration of SITE/fleet.toml.
const Key& fleet_file();
/// Key of conditions on the kind of a test cycle; set with `TableReader::settle`, never in a file.
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
                                                      "fleet.toml",
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
/// Whether the name begins with A, B or C, as for rotary axes (ISO 841).
bool rotary_by_name(std::string_view axis);

}  // namespace nonio::config
