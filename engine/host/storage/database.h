// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <variant>
#include <vector>

#include "nonio/sdk/error.h"

struct sqlite3;
struct sqlite3_stmt;

namespace nonio::host::storage {

/// A connection to an SQLite file: one process, one thread, never across a fork. After the first
/// trouble in a transaction nothing more of it is done, and `Transaction::end` says what it was.
class Database {
 public:
  struct Blob {
    std::string_view bytes;
  };
  struct Null {};
  using Value = std::variant<std::int64_t, std::string_view, Blob, double, Null>;
  using Row = std::vector<std::string>;

  enum class Use { write, create };
  static constexpr double usual_patience = 60.0;
  /// Made if it is not there with Use::create. Whoever finds it locked waits up to `patience`
  /// seconds; the error is then one of which `is_locked` is true.
  static Expected<Database> open(const std::filesystem::path& path, Use use,
                                 double patience = usual_patience);

  /// The rows of one statement whose `?` are these values. NULL comes as "", a double in the fewest
  /// digits that give it back. A statement is prepared once and kept.
  std::vector<Row> rows(const char* sql, std::initializer_list<Value> values = {});
  /// The first column of the first row; "" if there is none.
  std::string first(const char* sql, std::initializer_list<Value> values = {});
  /// Statements one after the other, without values and rows.
  void script(const std::string& sql);
  bool failed() const { return !error_.empty(); }
  /// The first trouble since it was asked last.
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
  struct Close {
    void operator()(sqlite3*) const;
  };
  Database(sqlite3* file, std::filesystem::path path) : file_(file), path_(std::move(path)) {}
  void note_error();
  sqlite3_stmt* prepared(const char* sql);

  struct Finalize {
    void operator()(sqlite3_stmt*) const;
  };
  std::unique_ptr<sqlite3, Close> file_;
  std::unordered_map<std::string, std::unique_ptr<sqlite3_stmt, Finalize>> statements_;
  std::filesystem::path path_;
  std::string error_;
};

/// Whether it was another process that kept the file to itself: the same may succeed later.
bool is_locked(const Error& error);

}  // namespace nonio::host::storage
