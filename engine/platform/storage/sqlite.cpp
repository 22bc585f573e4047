// SPDX-License-Identifier: Apache-2.0
#include <sqlite3.h>

#include <cctype>
#include <string_view>
#include <unordered_map>

#include "platform/storage/connection.h"

namespace nonio::storage {

namespace {

using Value = Database::Value;

void bind(sqlite3_stmt* statement, int place, const Value& value) {
  if (const auto* number = std::get_if<std::int64_t>(&value))
    ::sqlite3_bind_int64(statement, place, *number);
  else if (const auto* text = std::get_if<std::string_view>(&value))
    ::sqlite3_bind_text64(statement, place, text->empty() ? "" : text->data(), text->size(),
                          SQLITE_STATIC, SQLITE_UTF8);
  else if (const auto* real = std::get_if<double>(&value))
    ::sqlite3_bind_double(statement, place, *real);
  else if (std::holds_alternative<Database::Null>(value))
    ::sqlite3_bind_null(statement, place);
  else if (const std::string_view bytes = std::get<Database::Blob>(value).bytes; bytes.empty())
    ::sqlite3_bind_zeroblob(statement, place, 0);
  else
    ::sqlite3_bind_blob64(statement, place, bytes.data(), bytes.size(), SQLITE_STATIC);
}

/// The result is valid until the next step of the statement; `real` is the buffer for a double.
std::string_view sqlite_cell(sqlite3_stmt* statement, int column, std::string& real) {
  if (::sqlite3_column_type(statement, column) == SQLITE_FLOAT)
    return real = shortest(::sqlite3_column_double(statement, column));
  const auto* bytes = static_cast<const char*>(::sqlite3_column_blob(statement, column));
  return {bytes == nullptr ? "" : bytes,
          static_cast<std::size_t>(::sqlite3_column_bytes(statement, column))};
}

class Sqlite final : public Connection {
 public:
  Sqlite(sqlite3* file, const std::filesystem::path& path) : file_(file), path_(path.string()) {}

  std::string rows(const char* sql, std::span<const Value> values,
                   std::vector<Database::Row>& rows) override {
    return each(sql, values, [&](const std::vector<std::string_view>& row) {
      rows.emplace_back(row.begin(), row.end());
    });
  }

  std::string each(const char* sql, std::span<const Value> values,
                   const Database::Take& take) override {
    sqlite3_stmt* statement = prepared(sql);
    if (statement == nullptr) return error();
    int place = 0;
    for (const Value& value : values) bind(statement, ++place, value);
    const auto columns = static_cast<std::size_t>(::sqlite3_column_count(statement));
    std::vector<std::string_view> row(columns);
    std::vector<std::string> reals(columns);
    int step = SQLITE_ROW;
    while ((step = ::sqlite3_step(statement)) == SQLITE_ROW) {
      for (std::size_t i = 0; i < columns; ++i)
        row[i] = sqlite_cell(statement, static_cast<int>(i), reals[i]);
      take(row);
    }
    std::string trouble = step == SQLITE_DONE ? std::string() : error();
    // Bound values are valid only during this call, and a statement that was reset holds no lock.
    ::sqlite3_reset(statement);
    ::sqlite3_clear_bindings(statement);
    return trouble;
  }

  std::string put(const char* sql, std::span<const Value> values) override {
    std::vector<Database::Row> none;
    return rows(sql, values, none);
  }

  std::string script(const std::string& sql) override {
    const bool well =
        ::sqlite3_exec(file_.get(), sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK;
    return well ? std::string() : error();
  }

  // Takes the write lock at once, because two transactions that first read and then write would
  // wait for each other.
  std::string begin() override { return put("BEGIN IMMEDIATE", {}); }
  std::string commit() override { return put("COMMIT", {}); }
  void rollback() override {
    if (::sqlite3_get_autocommit(file_.get()) == 0) put("ROLLBACK", {});
  }

  std::string error() const {
    constexpr int primary = 0xFF;
    const bool busy = (::sqlite3_extended_errcode(file_.get()) & primary) == SQLITE_BUSY;
    return path_ + ": " + (busy ? locked_words : ::sqlite3_errmsg(file_.get()));
  }

 private:
  struct Close {
    void operator()(sqlite3* file) const { ::sqlite3_close_v2(file); }
  };
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { ::sqlite3_finalize(statement); }
  };

  sqlite3_stmt* prepared(const char* sql) {
    const auto [at, is_new] = statements_.try_emplace(sql);
    if (!is_new) return at->second.get();
    sqlite3_stmt* made = nullptr;
    const bool well = ::sqlite3_prepare_v2(file_.get(), sql, -1, &made, nullptr) == SQLITE_OK;
    at->second.reset(made);
    if (well) return made;
    statements_.erase(at);
    return nullptr;
  }

  std::unique_ptr<sqlite3, Close> file_;
  std::unordered_map<std::string, std::unique_ptr<sqlite3_stmt, Finalize>> statements_;
  std::string path_;
};

std::string address_of(const std::filesystem::path& path) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  std::string address = "file:";
  const std::filesystem::path whole = std::filesystem::absolute(path);
  for (const char c : whole.native()) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain =
        std::isalnum(byte) != 0 || std::string_view("/._-").find(c) != std::string_view::npos;
    address += plain ? std::string(1, c) : std::string{'%', digits[byte >> 4U], digits[byte & 15U]};
  }
  return address + "?immutable=1";
}

Expected<std::unique_ptr<Connection>> connect_to_read(const std::filesystem::path& path) {
  sqlite3* file = nullptr;
  const int opened = ::sqlite3_open_v2(address_of(path).c_str(), &file,
                                       SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  std::unique_ptr<Connection> connection = std::make_unique<Sqlite>(file, path);
  if (file == nullptr) return fail("no memory for " + path.string());
  if (opened != SQLITE_OK) return fail(path.string() + ": " + ::sqlite3_errmsg(file));
  for (const char* pragma :
       {"PRAGMA trusted_schema = OFF", "PRAGMA cell_size_check = ON", "PRAGMA mmap_size = 0"})
    if (const std::string trouble = connection->put(pragma, {}); !trouble.empty())
      return fail(trouble);
  return connection;
}

}  // namespace

Expected<std::unique_ptr<Connection>> connect_sqlite(const std::filesystem::path& path,
                                                     Database::Use use, double patience) {
  sqlite3* file = nullptr;
  if (use == Database::Use::read) return connect_to_read(path);
  const int flags = SQLITE_OPEN_READWRITE | (use == Database::Use::create ? SQLITE_OPEN_CREATE : 0);
  const int opened = ::sqlite3_open_v2(path.c_str(), &file, flags, nullptr);
  auto connection = std::make_unique<Sqlite>(file, path);
  if (file == nullptr) return fail("no memory for " + path.string());
  if (opened != SQLITE_OK) return fail(connection->error());
  ::sqlite3_busy_timeout(file, static_cast<int>(1000.0 * patience));
  ::sqlite3_extended_result_codes(file, 1);
  // EXTRA also flushes the folder before a commit returns; otherwise the journal could reappear
  // after a power failure and undo the commit.
  for (const char* pragma : {"PRAGMA synchronous = EXTRA", "PRAGMA foreign_keys = ON"})
    if (const std::string trouble = connection->put(pragma, {}); !trouble.empty())
      return fail(trouble);
  return connection;
}

Expected<void> copy_database(const std::filesystem::path& from, const std::filesystem::path& to,
                             double patience) {
  struct Close {
    void operator()(sqlite3* file) const { ::sqlite3_close_v2(file); }
  };
  const auto open = [](const std::filesystem::path& path, int flags) {
    sqlite3* file = nullptr;
    const int opened = ::sqlite3_open_v2(path.c_str(), &file, flags, nullptr);
    return std::pair(std::unique_ptr<sqlite3, Close>(file), opened == SQLITE_OK);
  };
  const auto source = open(from, SQLITE_OPEN_READWRITE);
  const auto copy = open(to, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
  const auto wrong = [&](sqlite3* file) {
    return fail(Error{std::string("the database cannot be copied: ") + ::sqlite3_errmsg(file),
                      from.string()});
  };
  for (const auto* one : {&source, &copy})
    if (!one->second) return wrong(one->first.get());
  ::sqlite3_busy_timeout(source.first.get(), static_cast<int>(1000.0 * patience));
  // Takes the read lock first, because sqlite3_backup_step does not wait for a lock.
  if (::sqlite3_exec(source.first.get(), "BEGIN; SELECT count(*) FROM sqlite_schema", nullptr,
                     nullptr, nullptr) != SQLITE_OK)
    return wrong(source.first.get());
  sqlite3_backup* const backup =
      ::sqlite3_backup_init(copy.first.get(), "main", source.first.get(), "main");
  if (backup == nullptr) return wrong(copy.first.get());
  const int step = ::sqlite3_backup_step(backup, -1);
  const int finish = ::sqlite3_backup_finish(backup);
  if (step != SQLITE_DONE || finish != SQLITE_OK) return wrong(copy.first.get());
  return {};
}

}  // namespace nonio::storage
