// SPDX-License-Identifier: Apache-2.0
#include "host/storage/database.h"

#include <sqlite3.h>

#include <array>
#include <charconv>
#include <utility>

namespace nonio::host::storage {

void Database::Close::operator()(sqlite3* file) const { ::sqlite3_close_v2(file); }
void Database::Finalize::operator()(sqlite3_stmt* statement) const {
  ::sqlite3_finalize(statement);
}

namespace {
constexpr const char* locked_words = "another process keeps it locked";
}  // namespace

bool is_locked(const Error& error) { return error.message.ends_with(locked_words); }

Expected<Database> Database::open(const std::filesystem::path& path, Use use, double patience) {
  sqlite3* file = nullptr;
  const int flags = SQLITE_OPEN_READWRITE | (use == Use::create ? SQLITE_OPEN_CREATE : 0);
  const int opened = ::sqlite3_open_v2(path.c_str(), &file, flags, nullptr);
  Database database(file, path);
  if (file == nullptr) return fail("no memory for " + path.string());
  if (opened != SQLITE_OK) {
    database.note_error();
  } else {
    ::sqlite3_busy_timeout(file, static_cast<int>(1000.0 * patience));
    ::sqlite3_extended_result_codes(file, 1);
    // EXTRA is FULL, and the folder is flushed too before a commit returns: the journal does not
    // come back after a power failure and undo it.
    database.rows("PRAGMA synchronous = EXTRA");
    database.rows("PRAGMA foreign_keys = ON");
  }
  if (auto well = database.take_error(); !well) return fail(well.error());
  return database;
}

void Database::note_error() {
  if (!error_.empty()) return;
  constexpr int primary = 0xFF;
  const bool busy = (::sqlite3_extended_errcode(file_.get()) & primary) == SQLITE_BUSY;
  error_ = path_.string() + ": " + (busy ? locked_words : ::sqlite3_errmsg(file_.get()));
}

Expected<void> Database::take_error() {
  if (error_.empty()) return {};
  return fail(std::exchange(error_, {}));
}

namespace {

void bind(sqlite3_stmt* statement, int place, const Database::Value& value) {
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

std::string cell(sqlite3_stmt* statement, int column) {
  if (::sqlite3_column_type(statement, column) == SQLITE_FLOAT) {
    std::array<char, 32> text{};
    const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(),
                                            ::sqlite3_column_double(statement, column));
    return {text.data(), end};
  }
  const auto* bytes = static_cast<const char*>(::sqlite3_column_blob(statement, column));
  return {bytes == nullptr ? "" : bytes,
          static_cast<std::size_t>(::sqlite3_column_bytes(statement, column))};
}

}  // namespace

sqlite3_stmt* Database::prepared(const char* sql) {
  const auto [at, is_new] = statements_.try_emplace(sql);
  if (!is_new) return at->second.get();
  sqlite3_stmt* made = nullptr;
  const bool well = ::sqlite3_prepare_v2(file_.get(), sql, -1, &made, nullptr) == SQLITE_OK;
  at->second.reset(made);
  if (well) return made;
  note_error();
  statements_.erase(at);
  return nullptr;
}

std::vector<Database::Row> Database::rows(const char* sql, std::initializer_list<Value> values) {
  std::vector<Row> rows;
  if (failed()) return rows;
  sqlite3_stmt* statement = prepared(sql);
  if (statement == nullptr) return rows;
  int place = 0;
  for (const Value& value : values) bind(statement, ++place, value);
  int step = SQLITE_ROW;
  while ((step = ::sqlite3_step(statement)) == SQLITE_ROW) {
    Row& row = rows.emplace_back();
    for (int i = 0; i < ::sqlite3_column_count(statement); ++i) row.push_back(cell(statement, i));
  }
  if (step != SQLITE_DONE) note_error();
  // What is bound is not ours for longer than this call; a statement at rest holds no lock.
  ::sqlite3_reset(statement);
  ::sqlite3_clear_bindings(statement);
  return rows;
}

void Database::script(const std::string& sql) {
  if (!failed() && ::sqlite3_exec(file_.get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
    note_error();
}

std::string Database::first(const char* sql, std::initializer_list<Value> values) {
  auto all = rows(sql, values);
  return all.empty() || all.front().empty() ? "" : std::move(all.front().front());
}

// At once with the right to write: two that read first and write then would wait for each other.
Database::Transaction::Transaction(Database& database) : database_(database) {
  database_.rows("BEGIN IMMEDIATE");
}

Database::Transaction::~Transaction() {
  if (!open_) return;
  [[maybe_unused]] const auto why = database_.take_error();
  if (::sqlite3_get_autocommit(database_.file_.get()) == 0) database_.rows("ROLLBACK");
}

Expected<void> Database::Transaction::end() {
  database_.rows("COMMIT");
  if (database_.failed()) return database_.take_error();  // and the destructor takes it back
  open_ = false;
  return {};
}

}  // namespace nonio::host::storage
