// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "nonio/sdk/error.h"

namespace nonio::storage {

class Connection;

/// A PostgreSQL database according to `[database]` in site.toml.
struct Server {
  std::string url;  ///< postgresql://... in libpq's format, without a password
  std::string schema;
  /// If empty, libpq looks up the password (service file, ~/.pgpass, ...).
  std::filesystem::path password_file;
};

/// Checks that libpq accepts this address and that it contains no password. The error message does
/// not repeat the address.
Expected<void> check_address(const std::string& url);

/// A connection to an SQLite file or a server, for one thread of one process; it must not be used
/// after a fork. After the first error in a transaction all further statements are skipped, and
/// `Transaction::end` returns the error.
class Database {
 public:
  struct Blob {
    std::string_view bytes;
  };
  struct Null {};
  using Value = std::variant<std::int64_t, std::string_view, Blob, double, Null>;
  using Row = std::vector<std::string>;

  enum class Use { write, create, read };
  static constexpr double usual_patience = 60.0;
  /// Opens an SQLite file; Use::create creates a missing one. Use::read takes no lock and ignores
  /// journals, so the file must not change. Waits up to `patience` seconds for a locked database,
  /// then returns an error for which `is_locked` is true.
  static Expected<Database> open(const std::filesystem::path& path, Use use,
                                 double patience = usual_patience);
  /// Tables belong to the schema of `server`, which need not exist yet.
  static Expected<Database> open(const Server& server, double patience = usual_patience);
  Database(Database&&) noexcept;
  Database& operator=(Database&&) noexcept;
  ~Database();

  enum class Kind { sqlite, postgresql };
  Kind kind() const { return kind_; }

  /// `values` replace the `?` of the statement. NULL is returned as "", and a double with the
  /// fewest digits that reproduce it.
  std::vector<Row> rows(const char* sql, std::initializer_list<Value> values = {});
  /// Calls `take` for each row, which is valid during the call only; `take` must not use the
  /// database.
  using Take = std::function<void(const std::vector<std::string_view>& row)>;
  void each(const char* sql, std::initializer_list<Value> values, const Take& take);
  /// Returns the first column of the first row; "" without a row.
  std::string first(const char* sql, std::initializer_list<Value> values = {});
  /// Runs a statement without rows. Statements are sent to a server in groups, so an error may be
  /// reported by a later call: at the latest by `rows` or at the end of the transaction.
  void put(const char* sql, std::initializer_list<Value> values = {});
  /// Runs several statements without values and rows.
  void script(const std::string& sql);
  bool failed() const { return !error_.empty(); }
  /// Returns and clears the first error since the last call.
  Expected<void> take_error();

  /// Statements that take effect together. The destructor rolls them back unless `end` was called.
  class Transaction {
   public:
    explicit Transaction(Database& database);
    Transaction(const Transaction&) = delete;
    Transaction& operator=(const Transaction&) = delete;
    ~Transaction();
    /// Commits; returns after everything is on disk.
    Expected<void> end();

   private:
    Database& database_;
    bool open_ = true;
  };

  /// During its lifetime all reads of an SQLite file are as of one moment under one lock. For a
  /// server it has no effect.
  class Reading {
   public:
    explicit Reading(Database& database);
    Reading(const Reading&) = delete;
    Reading& operator=(const Reading&) = delete;
    ~Reading();

   private:
    Connection* file_;
  };

 private:
  Database(std::unique_ptr<Connection> connection, Kind kind);

  std::unique_ptr<Connection> connection_;
  Kind kind_;
  std::string error_;
};

/// Copies an SQLite file as of one moment into a new file, even while other processes write to it.
/// Waits up to `patience` seconds for a lock.
Expected<void> copy_database(const std::filesystem::path& from, const std::filesystem::path& to,
                             double patience = Database::usual_patience);

/// Whether a later call may succeed: another process has locked the database, or its server cannot
/// be reached.
bool is_locked(const Error& error);

/// Converts CREATE TABLE statements from SQLite's to PostgreSQL's dialect. Texts are sorted by
/// their bytes, as in SQLite.
std::string server_words(std::string sql);

}  // namespace nonio::storage
