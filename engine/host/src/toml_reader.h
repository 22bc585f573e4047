// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <toml++/toml.h>

#include <optional>
#include <string>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/settings.h"

namespace nonio::host {

/// One table of a TOML file, read key by key. What is wrong is collected, not thrown, and `finish`
/// reports every key that nobody asked for, with the nearest name that somebody did ask for.
class TableReader {
 public:
  TableReader(const toml::table& table, std::string name, const std::string& file,
              std::vector<Error>& errors)
      : table_(table), name_(std::move(name)), file_(file), errors_(errors) {}

  std::string text(const char* key, bool required = false);
  std::optional<double> number(const char* key, double scale = 1.0);
  std::optional<int> whole(const char* key);
  std::optional<bool> flag(const char* key);
  std::string date(const char* key);
  std::optional<std::vector<std::string>> texts(const char* key);
  std::optional<std::vector<double>> numbers(const char* key);
  /// A table of numbers, each multiplied by `scale`; none if absent.
  std::vector<std::pair<std::string, double>> number_table(const char* key, double scale);
  const toml::table* table(const char* key);
  const toml::array* tables(const char* key);
  /// One of the given words, or empty if absent.
  std::string choice(const char* key, const std::vector<std::string>& allowed,
                     bool required = false);
  void unused(const char* key) { known_.emplace_back(key); }
  void finish();

  void error(const char* key, std::string message);
  std::uint64_t line_of(const char* key) const;
  const toml::table& raw() const { return table_; }
  std::string place(const std::string& key) const {
    return name_.empty() ? key : name_ + "." + key;
  }

 private:
  const toml::node* find(const char* key);
  void wrong_type(const char* key, const toml::node& found, const char* wanted);

  const toml::table& table_;
  std::string name_;
  const std::string& file_;
  std::vector<Error>& errors_;
  std::vector<std::string> known_;
};

/// The whole file, or one error with its line.
Expected<toml::table> parse_toml(std::string_view text, const std::string& file);

std::string type_name(const toml::node& node);

/// A leaf as a setting; nothing for tables, dates and mixed arrays.
std::optional<Setting> to_setting(const toml::node& node);

}  // namespace nonio::host
