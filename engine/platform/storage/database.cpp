// SPDX-License-Identifier: Apache-2.0
#include "platform/storage/database.h"

#include <array>
#include <charconv>
#include <utility>

#include "platform/storage/connection.h"
#include "platform/storage/late_library.h"

namespace nonio::storage {

bool is_locked(const Error& error) {
  return error.message.ends_with(locked_words) || error.message.ends_with(away_words);
}

std::string server_words(std::string sql) {
  constexpr std::pair<std::string_view, std::string_view> words[] = {
      {" TEXT", " TEXT COLLATE \"C\""},
      {" BLOB", " BYTEA"},
      {" INTEGER", " BIGINT"},
      {" WITHOUT ROWID", ""}};
  for (const auto& [old, by] : words)
    for (std::size_t at = 0; (at = sql.find(old, at)) != std::string::npos; at += by.size())
      sql.replace(at, old.size(), by);
  return sql;
}

std::string shortest(double number) {
  std::array<char, 32> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), number);
  return {text.data(), end};
}

Database::Database(std::unique_ptr<Connection> connection, Kind kind)
    : connection_(std::move(connection)), kind_(kind) {}
Database::Database(Database&&) noexcept = default;
Database& Database::operator=(Database&&) noexcept = default;
Database::~Database() = default;

Expected<Database> Database::open(const std::filesystem::path& path, Use use, double patience) {
  NONIO_TRY(auto connection, connect_sqlite(path, use, patience));
  return Database(std::move(connection), Kind::sqlite);
}

namespace {

Expected<const PostgreSQL*> postgresql() {
  return exported_as<PostgreSQL>("libnonio_postgresql.so", "nonio_postgresql");
}

}  // namespace

Expected<void> check_address(const std::string& url) {
  const auto library = postgresql();
  return library ? (*library)->check_address(url) : fail(library.error());
}

Expected<Database> Database::open(const Server& server, double patience) {
  NONIO_TRY(const auto library, postgresql());
  NONIO_TRY(auto connection, library->connect(server, patience));
  return Database(std::move(connection), Kind::postgresql);
}

Expected<void> Database::take_error() {
  if (error_.empty()) return {};
  return fail(std::exchange(error_, {}));
}

std::vector<Database::Row> Database::rows(const char* sql, std::initializer_list<Value> values) {
  std::vector<Row> rows;
  if (!failed()) error_ = connection_->rows(sql, {values.begin(), values.size()}, rows);
  return rows;
}

void Database::each(const char* sql, std::initializer_list<Value> values, const Take& take) {
  if (!failed()) error_ = connection_->each(sql, {values.begin(), values.size()}, take);
}

void Database::put(const char* sql, std::initializer_list<Value> values) {
  if (!failed()) error_ = connection_->put(sql, {values.begin(), values.size()});
}

void Database::script(const std::string& sql) {
  if (!failed()) error_ = connection_->script(sql);
}

std::string Database::first(const char* sql, std::initializer_list<Value> values) {
  auto all = rows(sql, values);
  return all.empty() || all.front().empty() ? "" : std::move(all.front().front());
}

Database::Transaction::Transaction(Database& database) : database_(database) {
  if (!database_.failed()) database_.error_ = database_.connection_->begin();
}

Database::Transaction::~Transaction() {
  if (!open_) return;
  [[maybe_unused]] const auto why = database_.take_error();
  database_.connection_->rollback();
}

Expected<void> Database::Transaction::end() {
  if (!database_.failed()) database_.error_ = database_.connection_->commit();
  if (database_.failed()) return database_.take_error();
  open_ = false;
  return {};
}

Database::Reading::Reading(Database& database)
    : file_(database.kind_ == Kind::sqlite ? database.connection_.get() : nullptr) {
  if (file_ != nullptr) database.put("BEGIN");
}

Database::Reading::~Reading() {
  if (file_ != nullptr) file_->rollback();
}

}  // namespace nonio::storage
