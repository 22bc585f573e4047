// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "platform/storage/database.h"
#include "platform/storage/json_values.h"

namespace nonio::certificates {

/// Events of a register in their order. Entries are only appended. Each contains its own digest and
/// that of the entry before, so that a change or removal of any entry but the last is detected.
class Journal {
 public:
  struct Entry {
    std::int64_t place = 0;  ///< position in the journal, counted from 1 without gaps
    std::string at;          ///< UTC, for example "2026-11-22T14:21:33Z"
    /// Kind of the event: made, drawn, approved, issued, withdrawn, or second (a second approval,
    /// which has no effect).
    std::string what;
    std::string number;  ///< certificate number; may be empty
    std::string says;    ///< details, a JSON object
    std::string sha256;
  };
  static const char* const schema;

  explicit Journal(storage::Database& database) : database_(database) {}

  /// Must be called in the transaction of the change that the entry records. Adds the account.
  Entry add(const char* what, const std::string& number, storage::Json says);
  std::vector<Entry> all();
  std::optional<Entry> last();
  std::optional<Entry> last_of(const char* what, const std::string& number);
  /// Returns the digest of an entry that follows an entry with the digest `before`.
  static std::string digest(const Entry& entry, const std::string& before);

 private:
  std::optional<Entry> first(const char* sql,
                             std::initializer_list<storage::Database::Value> values);
  storage::Database& database_;
};

/// Returns the account of this process' real user and the host, for example "lab@measuring-room".
std::string own_account();
/// Returns false in a user namespace of one person, in which that person can choose any account.
bool is_own_account_certain();
/// Returns, for example, "2026-11-22T14:21:33Z".
std::string utc_now();

}  // namespace nonio::certificates
