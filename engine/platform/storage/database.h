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

/// A database of PostgreSQL, as `[database]` of site.toml names it.
struct Server {
  std::string url;  ///< postgresql://..., as libpq reads it; without a password
  std::string schema;
  std::filesystem::path password_file;  ///< empty: as libpq finds it (service, ~/.pgpass, ...)
};

/// Whether libpq reads this address and no password is in it. The error never repeats it.
Expected<void> check_address(const std::string& url);

/// A connection to an SQLite file or a server: one process, one thread, never across a fork. After
/// the first error in a transaction nothing more of it is done, and `Transaction::end` returns it.
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
  /// Made if it is missing with Use::create. With Use::read nothing is written, no lock is taken
  /// and no journal is searched: for a file from anywhere that no process changes. A locked
  /// database is waited for up to `patience` seconds; then `is_locked` of the error is true.
  static Expected<Database> open(const std::filesystem::path& path, Use use,
                                 double patience = usual_patience);
  /// Names of tables are those of the server's schema, whether it is there or not.
  static Expected<Database> open(const Server& server, double patience = usual_patience);
  Database(Database&&) noexcept;
  Database& operator=(Database&&) noexcept;
  ~Database();

  enum class Kind { sqlite, postgresql };
  Kind kind() const { return kind_; }

  /// The rows of one statement whose `?` are these values. NULL comes as "", a double in the fewest
  /// digits that give it back. A statement is prepared once and kept.
  std::vector<Row> rows(const char* sql, std::initializer_list<Value> values = {});
  /// The same, row by row, valid during the call of `take`, which may not use the database.
  using Take = std::function<void(const std::vector<std::string_view>& row)>;
  void each(const char* sql, std::initializer_list<Value> values, const Take& take);
  /// The first column of the first row; "" if there is none.
  std::string first(const char* sql, std::initializer_list<Value> values = {});
  /// A statement without rows. A server gets many of them in one go, so that an error may show
  /// only with a later call, at the latest with `rows` or the end of the transaction.
  void put(const char* sql, std::initializer_list<Value> values = {});
  /// Statements one after the other, without values and rows.
  void script(const std::string& sql);
  bool failed() const { return !error_.empty(); }
  /// The first error since the last call.
  Expected<void> take_error();

  /// Statements that are done all or not at all; taken back unless `end` was called.
  class Transaction {
   public:
    explicit Transaction(Database& database);
    Transaction(const Transaction&) = delete;
    Transaction& operator=(const Transaction&) = delete;
    ~Transaction();
    /// Returns when all of it is on disk.
    Expected<void> end();

   private:
    Database& database_;
    bool open_ = true;
  };

 private:
  Database(std::unique_ptr<Connection> connection, Kind kind);

  std::unique_ptr<Connection> connection_;
  Kind kind_;
  std::string error_;
};

/// An SQLite file as it is at one moment, whatever other processes write meanwhile, in a new file.
Expected<void> copy_database(const std::filesystem::path& from, const std::filesystem::path& to,
                             double patience = Database::usual_patience);

/// Whether another process kept the database to itself, or its server was away: the same may succeed
/// later.
bool is_locked(const Error& error);

/// Tables and their columns as SQLite takes them, in PostgreSQL's words. Texts are ordered by their
/// bytes, as SQLite orders them.
std::string server_words(std::string sql);

}  // namespace nonio::storage
