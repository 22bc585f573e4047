// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "platform/storage/database.h"

namespace nonio::storage {

/// Interface to SQLite or PostgreSQL. All functions except `rollback` return an error message, or
/// an empty text on success. After an error only `rollback` may be called.
class Connection {
 public:
  Connection() = default;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  virtual ~Connection() = default;

  virtual std::string rows(const char* sql, std::span<const Database::Value> values,
                           std::vector<Database::Row>& rows) = 0;
  virtual std::string each(const char* sql, std::span<const Database::Value> values,
                           const Database::Take& take) {
    std::vector<Database::Row> all;
    std::string trouble = rows(sql, values, all);
    for (const Database::Row& row : all) take({row.begin(), row.end()});
    return trouble;
  }
  /// Runs a statement without rows; its error may be returned by a later call.
  virtual std::string put(const char* sql, std::span<const Database::Value> values) = 0;
  virtual std::string script(const std::string& sql) = 0;
  virtual std::string begin() = 0;
  virtual std::string commit() = 0;
  virtual void rollback() = 0;
};

inline constexpr const char* locked_words = "another process keeps it locked";
inline constexpr const char* away_words = "the server is away";

/// Formats a number with the fewest digits that reproduce the double.
std::string shortest(double number);

Expected<std::unique_ptr<Connection>> connect_sqlite(const std::filesystem::path& path,
                                                     Database::Use use, double patience);

/// Functions that the library with libpq exports as `nonio_postgresql` (late_library.h).
struct PostgreSQL {
  Expected<void> (*check_address)(const std::string& url);
  Expected<std::unique_ptr<Connection>> (*connect)(const Server& server, double patience);
};

}  // namespace nonio::storage
