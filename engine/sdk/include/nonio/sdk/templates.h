// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "nonio/sdk/settings.h"

namespace nonio {

/// Bytes that do not change, in memory or of a mapped file. Copies share them.
class SharedBytes {
 public:
  SharedBytes(std::string bytes = {}) {
    const auto kept = std::make_shared<const std::string>(std::move(bytes));
    bytes_ = *kept, owner_ = kept;
  }
  SharedBytes(const char* bytes) : SharedBytes(std::string(bytes)) {}
  SharedBytes(std::shared_ptr<const void> owner, std::string_view bytes)
      : owner_(std::move(owner)), bytes_(bytes) {}

  operator std::string_view() const { return bytes_; }

 private:
  std::shared_ptr<const void> owner_{};
  std::string_view bytes_{};
};

/// Tables of templates/ by path without the extension ("words/en/site"). The words of a language
/// may be read only when one of its tables is first looked up; `begin` reads all languages. Several
/// threads may look up at the same time.
class TemplateTables {
 public:
  using Map = std::map<std::string, Settings, std::less<>>;
  /// Adds the tables "words/LANGUAGE/..." that are not in the map.
  using Reader = std::function<void(const std::string& language, Map& tables)>;

  void read_later(std::set<std::string> languages, Reader reader);
  void read(std::string_view language) const;

  Settings& operator[](const std::string& name);
  const Settings& at(std::string_view name) const;  ///< std::out_of_range if absent
  bool contains(std::string_view name) const { return find(name) != tables_.end(); }
  bool empty() const { return tables_.empty() && unread_.empty(); }
  Map::const_iterator find(std::string_view name) const;
  Map::const_iterator begin() const;
  Map::const_iterator end() const { return tables_.end(); }
  /// Text of a key in the words of a language, or an empty text. If files have the same key, the
  /// first file has priority.
  std::string text(std::string_view language, std::string_view key) const;

 private:
  void read_now(std::string_view language) const;  // the caller has locked
  void gather(const std::string& language) const;

  std::shared_ptr<std::mutex> lock_ = std::make_shared<std::mutex>();
  mutable Map tables_{};
  mutable std::set<std::string, std::less<>> unread_{};
  /// Texts that are looked up most often (findings, notes, terms), of all files of a language.
  mutable Map gathered_{};
  Reader reader_{};
};

/// The files of templates/: `*.toml` as tables, all others (logo, fonts) as bytes under the whole
/// path.
struct Templates {
  TemplateTables tables;
  std::map<std::string, SharedBytes, std::less<>> files;
};

}  // namespace nonio
