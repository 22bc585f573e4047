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

/// Reads one table of a TOML file according to its declaration, and collects errors.
class TableReader {
 public:
  /// `declaration` must outlive the reader.
  TableReader(const toml::table& table, const Key& declaration, const std::string& file,
              std::vector<Error>& errors)
      : TableReader(table, declaration, {}, file, errors) {}

  /// Reads the keys that have a member into `object`. Keys whose `Key::only` is false are skipped.
  template <class T>
  void fill(T& object) {
    fill(&object, &binding::tag<T>);
  }

  /// Sets the value of `key` for conditions, for tables that do not contain the key.
  void settle(std::string_view key, std::string_view value) { settled_ = {key, value}; }
  std::string_view settled() const { return settled_.second; }
  TableReader declared(const Key& declaration) const;
  /// Reports unknown keys with the nearest known one. Throws std::logic_error if a declared key was
  /// not read.
  void finish();

  void error(std::string_view key, std::string message);
  void error(Error error) { errors_.push_back(std::move(error)); }
  bool has_errors() const { return errors_.size() > errors_before_; }
  const toml::table* anything(const Key& key) { return table_at(key); }
  /// Returns readers of the table under a key, of a list of tables, or of tables under any name.
  std::vector<TableReader> tables(const Key& key);
  bool contains(std::string_view key) const { return table_.contains(key); }
  std::uint64_t line_of(std::string_view key) const;
  std::uint64_t line() const { return table_.source().begin.line; }
  const std::string& file() const { return file_; }
  /// Returns the name of this table, or of the table that contains its list; empty if the
  /// declaration does not allow any name.
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
  /// Returns null for a missing key; a required key is then reported.
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

Expected<toml::table> parse_toml(std::string_view text, const std::string& file);

/// A key with the name of an earlier version. It may also be the header of a table, or the id of a
/// finding.
struct FormerKey {
  std::string place;         ///< table of the key: "machine.axes.X"; empty at the top level
  std::string former, name;  ///< former and present name: "table_on", "active_table"
  std::uint64_t line = 0;
  bool is_value = false;  ///< `former` is the id of a finding instead of a key
};
/// Renames former keys and ids of findings, and returns them in the order of their lines. A former
/// name next to the present one stays unknown.
std::vector<FormerKey> rename_former_keys(toml::table& table, const Key& declaration);
/// Returns one warning for each former name, with the line of its first use.
std::vector<Error> warnings_of(const std::vector<FormerKey>& keys, const std::string& file);

void note_lines(const toml::table& table, const std::string& prefix, KeyLines& lines);

/// Returns the text as a TOML string in quotes.
std::string quoted_toml(const std::string& text);

std::string type_name(const toml::node& node);

/// Returns nullopt for dates, times, mixed lists, and tables that contain other values than
/// numbers.
std::optional<Setting> to_setting(const toml::node& node);

}  // namespace nonio::config
