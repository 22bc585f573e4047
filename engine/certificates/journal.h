// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "platform/storage/database.h"
#include "platform/storage/json_values.h"

namespace nonio::certificates {

/// What happened in a register, in order. Entries are only ever added. Each holds a digest of
/// itself and of the digest before, so that nothing before the last one can be changed or taken out
/// unseen.
class Journal {
 public:
  struct Entry {
    std::int64_t place = 0;  ///< from 1, without gaps
    std::string at;          ///< UTC, "2026-11-22T14:21:33Z"
    std::string what;        ///< made, carried-over, drawn, approved, issued, withdrawn
    std::string number;      ///< empty: of no number
    std::string says;        ///< JSON
    std::string sha256;
  };
  static const char* const schema;

  explicit Journal(storage::Database& database) : database_(database) {}

  /// In the transaction of the change that it records. Every entry states the account that wrote it.
  Entry add(const char* what, const std::string& number, storage::Json says);
  std::vector<Entry> all();
  std::optional<Entry> last();
  /// The last of a kind that is about a number.
  std::optional<Entry> last_of(const char* what, const std::string& number);
  /// The digest that an entry has to have behind one with the digest `before`.
  static std::string digest(const Entry& entry, const std::string& before);

 private:
  std::optional<Entry> first(const char* sql,
                             std::initializer_list<storage::Database::Value> values);
  storage::Database& database_;
};

/// Of the real user of this process, as the operating system knows him, and the host:
/// "lab@measuring-room".
std::string own_account();
/// False in a user namespace of a person's own, where any number and name of an account can be chosen.
bool is_own_account_certain();
/// Now, as the journal writes it.
std::string utc_now();

}  // namespace nonio::certificates
