// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <toml++/toml.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "campaign/config/bind.h"
#include "campaign/config/manifest.h"
#include "nonio/sdk/error.h"
#include "nonio/sdk/settings.h"

namespace nonio::config {

/// Reads one table of a TOML file according to its declaration. Errors of the file are collected,
/// not thrown.
class TableReader {
 public:
  /// Makes a reader of a whole file. `declaration` must outlive the reader.
  TableReader(const toml::table& table, const Key& declaration, const std::string& file,
              std::vector<Error>& errors)
      : TableReader(table, declaration, {}, file, errors) {}

  /// Reads all keys that are declared with a member into `object`, and checks the others. Keys
  /// whose condition (`Key::only`) is not fulfilled are skipped.
  template <class T>
  void fill(T& object) {
    fill(&object, &binding::tag<T>);
  }

  /// Sets the value of `key` for conditions of the declaration, for tables that do not contain the
  /// key.
  void settle(std::string_view key, std::string_view value) { settled_ = {key, value}; }
  /// Returns the value that `settle` set; for an axis it is "linear" or "rotary".
  std::string_view settled() const { return settled_.second; }
  /// Returns a reader of the same table with another declaration.
  TableReader declared(const Key& declaration) const;
  /// Reports every unknown key with the nearest known one. Throws std::logic_error for a declared
  /// key that was not read.
  void finish();

  void error(std::string_view key, std::string message);
  void error(Error error) { errors_.push_back(std::move(error)); }
  /// Whether this table has an error that was found since `fill` began.
  bool has_errors() const { return errors_.size() > errors_before_; }
  const toml::table* anything(const Key& key) { return table_at(key); }
  /// Returns readers of the tables under a key: of one table, a list, or tables under any name.
  std::vector<TableReader> tables(const Key& key);
  bool contains(std::string_view key) const { return table_.contains(key); }
  std::uint64_t line_of(std::string_view key) const;
  std::uint64_t line() const { return table_.source().begin.line; }
  const std::string& file() const { return file_; }
  /// Returns the name of this table if its declaration allows any name. For a table of a list it is
  /// the name of the table that contains the list. Otherwise empty.
  const std::string& name() const { return name_; }
  const toml::table& raw() const { return table_; }
  const std::string& place() const { return place_; }
  std::string place(std::string_view key) const {
    return place_.empty() ? std::string(key) : place_ + "." + std::string(key);
  }

 private:
  template <class T>
  friend std::optional<T> value_of(TableReader&, const Key&);
  friend void read_tables(TableReader&, const Key&, void*, void* (*)(void*, std::string_view),
                          void (*)(TableReader&, void*, void*));

  TableReader(const toml::table& table, const Key& declaration, std::string place,
              const std::string& file, std::vector<Error>& errors)
      : table_(table),
        declaration_(&declaration),
        place_(std::move(place)),
        file_(file),
        errors_(errors) {}
  TableReader inside(const toml::table& table, const Key& declaration, std::string place) const {
    return {table, declaration, std::move(place), file_, errors_};
  }

  void fill(void* object, const void* type);
  /// Returns the value of a key; null if it is missing, which is reported if the key is needed.
  const toml::node* take(const Key& key);
  bool holds(const When& when) const;
  bool is_needed(const Key& key) const { return key.required || holds(key.needed); }
  void missing(const Key& key);
  void refuse(const Key& key, const std::string& found = {});
  void wrong_type(std::string_view key, const toml::node& found, std::string_view wanted);
  std::optional<std::string> one_line(const Key& key, const toml::node& node);
  std::optional<std::string> date(const Key& key, const toml::node& node);
  std::optional<double> finite(std::string_view key, const toml::node& node);
  bool check_choice(const Key& key, const std::string& value);
  const toml::table* table_at(const Key& key);
  std::optional<std::vector<double>> number_list(const Key& key);
  void check(const Key& key);
  void settle_by_name();

  const toml::table& table_;
  const Key* declaration_;
  std::string place_, name_;
  const std::string& file_;
  std::vector<Error>& errors_;
  std::size_t errors_before_ = 0;
  std::pair<std::string_view, std::string_view> settled_;
  std::vector<const Key*> read_;
};

/// Parses a whole TOML file. If it is not valid, returns the first error with its line.
Expected<toml::table> parse_toml(std::string_view text, const std::string& file);

/// A key with the name of an earlier version. It may also be the header of a table, or the id of a
/// finding.
struct FormerKey {
  std::string place;         ///< table that contains the key: "machine.axes.X"; empty: the file
  std::string former, name;  ///< former and present name: "table_on", "active_table"
  std::uint64_t line = 0;    ///< number of the line, from 1
  bool is_value = false;     ///< `former` is the id of a finding instead of a key
};
/// Renames the keys in `table` that have former names according to `declaration`, and ids of
/// findings that were renamed, so that all later code finds the present names. Returns them in the
/// order of their lines. A former name next to the present one is not renamed and stays unknown.
std::vector<FormerKey> rename_former_keys(toml::table& table, const Key& declaration);
/// Returns one warning, with the line of the first use, for each former name in a table or in all
/// tables of a list.
std::vector<Error> warnings_of(const std::vector<FormerKey>& keys, const std::string& file);

/// Adds the line of each key below a table to `lines`, by names such as "axes.X.number".
void note_lines(const toml::table& table, const std::string& prefix, KeyLines& lines);

std::string type_name(const toml::node& node);

/// Converts a value, or tables of numbers, into a setting; none for other tables, dates, times and
/// arrays that are neither all texts nor all numbers.
std::optional<Setting> to_setting(const toml::node& node);

}  // namespace nonio::config
