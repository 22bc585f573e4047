// SPDX-License-Identifier: Apache-2.0
#include <libpq-fe.h>
#include <sys/stat.h>

#include <array>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <map>
#include <new>
#include <thread>
#include <utility>

#include "platform/storage/connection.h"
#include "platform/storage/files.h"
#include "platform/storage/late_library.h"

namespace nonio::storage {

namespace {

using Value = Database::Value;

struct Clear {
  void operator()(PGresult* result) const { ::PQclear(result); }
};
using Result = std::unique_ptr<PGresult, Clear>;

// PostgreSQL 12, the first version that writes doubles with the fewest digits.
constexpr int oldest_server = 120000;
constexpr const char* connect_seconds = "10";
/// Number of statements that are sent before their results are read. The results fit into the
/// buffers between server and program, so that neither side blocks.
constexpr int most_under_way = 200;
constexpr Oid type_of_bytes = 17, type_of_doubles = 701;

std::string in_one_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos;)
    text.replace(at, 1, "; ");
  return text;
}

/// Replaces each `?` by `$1`, `$2`, ...; string literals in Nonio's statements contain no question
/// mark.
std::string numbered(std::string_view sql) {
  std::string out;
  int place = 0;
  for (const char c : sql) out += c == '?' ? "$" + std::to_string(++place) : std::string(1, c);
  return out;
}

class Bound {
 public:
  explicit Bound(std::span<const Value> values) {
    texts_.reserve(values.size());
    for (const Value& value : values) add(value);
  }
  bool has_zero() const { return has_zero_; }
  int count() const { return static_cast<int>(pointers_.size()); }
  const char* const* values() const { return pointers_.data(); }
  const int* lengths() const { return lengths_.data(); }
  const int* formats() const { return formats_.data(); }

 private:
  void add(const Value& value) {
    const auto* bytes = std::get_if<Database::Blob>(&value);
    if (const auto* number = std::get_if<std::int64_t>(&value))
      texts_.push_back(std::to_string(*number));
    else if (const auto* real = std::get_if<double>(&value))
      texts_.push_back(shortest(*real));
    else if (const auto* text = std::get_if<std::string_view>(&value))
      texts_.emplace_back(*text);
    else
      texts_.emplace_back(bytes == nullptr ? std::string_view() : bytes->bytes);
    const std::string& last = texts_.back();
    if (bytes == nullptr && last.find('\0') != std::string::npos) has_zero_ = true;
    pointers_.push_back(std::holds_alternative<Database::Null>(value) ? nullptr : last.c_str());
    lengths_.push_back(static_cast<int>(last.size()));
    formats_.push_back(bytes == nullptr ? 0 : 1);
  }

  std::vector<std::string> texts_;
  std::vector<const char*> pointers_;
  std::vector<int> lengths_, formats_;
  bool has_zero_ = false;
};

std::string server_cell(const PGresult* result, int row, int column) {
  if (::PQgetisnull(result, row, column) != 0) return {};
  const char* text = ::PQgetvalue(result, row, column);
  const auto size = static_cast<std::size_t>(::PQgetlength(result, row, column));
  const Oid type = ::PQftype(result, column);
  if (type == type_of_doubles) {
    double number = 0.0;
    std::from_chars(text, text + size, number);
    return shortest(number);
  }
  if (type != type_of_bytes) return {text, size};
  std::size_t length = 0;
  unsigned char* bytes = ::PQunescapeBytea(reinterpret_cast<const unsigned char*>(text), &length);
  if (bytes == nullptr) throw std::bad_alloc();
  std::string out(reinterpret_cast<const char*>(bytes), length);
  ::PQfreemem(bytes);
  return out;
}

class Postgresql final : public Connection {
 public:
  Postgresql(PGconn* server, std::string schema)
      : server_(server), schema_(std::move(schema)), name_("PostgreSQL") {}

  std::string rows(const char* sql, std::span<const Value> values,
                   std::vector<Database::Row>& rows) override {
    if (std::string trouble = settle(); !trouble.empty()) return trouble;
    const Bound bound(values);
    if (bound.has_zero()) return zero_words();
    if (std::string trouble = prepare(sql); !trouble.empty()) return trouble;
    const Result result(::PQexecPrepared(server_.get(), names_[sql].c_str(), bound.count(),
                                         bound.values(), bound.lengths(), bound.formats(), 0));
    if (std::string trouble = error_of(result.get()); !trouble.empty()) return trouble;
    for (int i = 0; i < ::PQntuples(result.get()); ++i) {
      Database::Row& row = rows.emplace_back();
      for (int j = 0; j < ::PQnfields(result.get()); ++j)
        row.push_back(server_cell(result.get(), i, j));
    }
    return {};
  }

  std::string put(const char* sql, std::span<const Value> values) override {
    const Bound bound(values);
    if (bound.has_zero()) return zero_words();
    if (!names_.contains(sql)) {
      if (std::string trouble = settle(); !trouble.empty()) return trouble;
      if (std::string trouble = prepare(sql); !trouble.empty()) return trouble;
    }
    if (under_way_ == 0 && ::PQenterPipelineMode(server_.get()) == 0) return own_error();
    ++under_way_;
    if (::PQsendQueryPrepared(server_.get(), names_[sql].c_str(), bound.count(), bound.values(),
                              bound.lengths(), bound.formats(), 0) == 0)
      return own_error();
    return under_way_ < most_under_way ? std::string() : settle();
  }

  std::string script(const std::string& sql) override {
    if (std::string trouble = settle(); !trouble.empty()) return trouble;
    return error_of(Result(::PQexec(server_.get(), sql.c_str())).get());
  }

  /// Takes a lock, so that only one process writes these tables at a time, as with SQLite's BEGIN
  /// IMMEDIATE.
  std::string begin() override {
    if (std::string trouble = script("BEGIN ISOLATION LEVEL READ COMMITTED READ WRITE");
        !trouble.empty())
      return trouble;
    std::vector<Database::Row> none;
    const Value schema = std::string_view(schema_);
    return rows("SELECT pg_advisory_xact_lock(hashtextextended(?, 1315926633))", {&schema, 1},
                none);
  }
  std::string commit() override {
    if (std::string trouble = settle(); !trouble.empty()) return trouble;
    const Result result(::PQexec(server_.get(), "COMMIT"));
    if (std::string trouble = error_of(result.get()); !trouble.empty()) return trouble;
    // COMMIT of a failed transaction succeeds, but rolls it back.
    if (std::string_view(::PQcmdStatus(result.get())) == "COMMIT") return {};
    return name_ + ": the transaction was taken back";
  }
  void rollback() override {
    settle();
    const PGTransactionStatusType status = ::PQtransactionStatus(server_.get());
    if (status == PQTRANS_INTRANS || status == PQTRANS_INERROR) script("ROLLBACK");
  }

  std::string set_up(double patience) {
    const auto text_of = [](const char* text) { return std::string(text == nullptr ? "" : text); };
    name_ = "database " + text_of(::PQdb(server_.get())) + " on " +
            text_of(::PQhost(server_.get())) + ", schema " + schema_;
    if (::PQstatus(server_.get()) != CONNECTION_OK) return own_error();
    was_there_ = true;
    ::PQsetNoticeProcessor(
        server_.get(), [](void*, const char*) {}, nullptr);
    if (::PQserverVersion(server_.get()) < oldest_server)
      return name_ + ": expected PostgreSQL 12 or newer";
    // A role or a database may have changed these settings.
    return script("SET search_path TO \"" + schema_ +
                  "\"; SET extra_float_digits TO 1; SET bytea_output TO hex; "
                  "SET standard_conforming_strings TO on; SET lock_timeout TO " +
                  std::to_string(static_cast<long>(1000.0 * patience)));
  }

 private:
  struct Finish {
    void operator()(PGconn* server) const { ::PQfinish(server); }
  };

  std::string zero_words() const { return name_ + ": a text with a character 0 in it"; }

  std::string own_error() const { return error_words(::PQerrorMessage(server_.get())); }

  std::string error_words(const char* said) const {
    const bool lost = was_there_ && ::PQstatus(server_.get()) != CONNECTION_OK;
    return lost ? lost_words(said) : name_ + ": " + in_one_line(said);
  }

  std::string lost_words(const char* said) const {
    const std::string words = in_one_line(said == nullptr ? "" : said);
    return name_ + ": " + (words.empty() ? "the connection is lost" : words) + ": " + away_words;
  }

  std::string error_of(const PGresult* result) const {
    const ExecStatusType status = ::PQresultStatus(result);
    if (status == PGRES_COMMAND_OK || status == PGRES_TUPLES_OK || status == PGRES_PIPELINE_SYNC)
      return {};
    const char* code = ::PQresultErrorField(result, PG_DIAG_SQLSTATE);
    const std::string_view state = code == nullptr ? "" : code;
    if (state == "55P03" || state == "40P01" || state == "40001")
      return name_ + ": " + locked_words;
    const char* message = ::PQresultErrorField(result, PG_DIAG_MESSAGE_PRIMARY);
    // The server is shut down, has crashed or is starting. The connection is lost with SQLSTATE
    // class 08, and with errors of libpq, which have no code.
    if ((was_there_ && state.empty()) || state.starts_with("08") || state == "57P01" ||
        state == "57P02" || state == "57P03")
      return lost_words(message);
    return message == nullptr ? own_error() : error_words(message);
  }

  std::string settle() {
    if (under_way_ == 0) return {};
    under_way_ = 0;
    if (::PQpipelineSync(server_.get()) == 0) return own_error();
    std::string trouble;
    for (bool synced = false; !synced;) {
      const Result result(::PQgetResult(server_.get()));
      if (!result) {
        if (::PQstatus(server_.get()) == CONNECTION_OK) continue;
        if (trouble.empty()) trouble = own_error();
        break;
      }
      synced = ::PQresultStatus(result.get()) == PGRES_PIPELINE_SYNC;
      if (trouble.empty()) trouble = error_of(result.get());
    }
    if (::PQexitPipelineMode(server_.get()) == 0 && trouble.empty()) trouble = own_error();
    return trouble;
  }

  std::string prepare(const char* sql) {
    if (names_.contains(sql)) return {};
    const std::string name = "s" + std::to_string(names_.size());
    const Result result(
        ::PQprepare(server_.get(), name.c_str(), numbered(sql).c_str(), 0, nullptr));
    std::string trouble = error_of(result.get());
    if (trouble.empty()) names_.emplace(sql, name);
    return trouble;
  }

  std::unique_ptr<PGconn, Finish> server_;
  std::map<std::string, std::string, std::less<>> names_;
  std::string schema_, name_;
  int under_way_ = 0;
  bool was_there_ = false;
};

Expected<std::string> server_password(const std::filesystem::path& file) {
  constexpr mode_t others = S_IRWXG | S_IRWXO;
  struct stat info {};
  if (::stat(file.c_str(), &info) == 0 && (info.st_mode & others) != 0) {
    std::array<char, 8> mode{};
    std::snprintf(mode.data(), mode.size(), "%04o", info.st_mode & 07777U);
    return fail("other users can get at the database's password " + file.string() + " (mode " +
                mode.data() +
                "); expected a file that only the user of the run can read: chmod 600 " +
                file.string());
  }
  auto text = read_small_file(file);
  if (!text) return fail("the database's password: " + text.error().message);
  while (text->ends_with('\n') || text->ends_with('\r')) text->pop_back();
  if (text->empty()) return fail("the database's password: " + file.string() + " is empty");
  return text;
}

Expected<void> check(const std::string& url) {
  if (!url.starts_with("postgresql://")) return fail("expected postgresql://user@host/name");
  char* why = nullptr;
  PQconninfoOption* options = ::PQconninfoParse(url.c_str(), &why);
  if (options == nullptr) {
    // The message of libpq would repeat parts of the address.
    ::PQfreemem(why);
    return fail("expected postgresql://user@host/name?option=value as libpq reads it");
  }
  bool secret = false;
  for (const PQconninfoOption* o = options; o->keyword != nullptr; ++o) {
    const std::string_view keyword = o->keyword;
    if ((keyword == "password" || keyword == "sslpassword") && o->val != nullptr) secret = true;
  }
  ::PQconninfoFree(options);
  if (secret)
    return fail(
        "a password is no part of the address; expected it in password_file, in ~/.pgpass or in a "
        "service of libpq");
  return {};
}

Expected<std::unique_ptr<Connection>> connect(const Server& server, double patience) {
  if (auto well = check(server.url); !well) return fail(well.error());
  std::string password;
  if (!server.password_file.empty()) {
    NONIO_TRY(auto read, server_password(server.password_file));
    password = std::move(read);
  }
  // Later keywords have precedence, so the address can set its own time limit.
  const char* keywords[] = {"connect_timeout",
                            "fallback_application_name",
                            "dbname",
                            "client_encoding",
                            password.empty() ? nullptr : "password",
                            nullptr};
  const char* values[] = {connect_seconds, "nonio",          server.url.c_str(),
                          "UTF8",          password.c_str(), nullptr};
  // A server that rejects the connection is running; one that is starting or stopping may be
  // available at the next attempt. Therefore only a repeated rejection is final.
  constexpr int trials = 4;
  for (int trial = 1;; ++trial) {
    auto connection =
        std::make_unique<Postgresql>(::PQconnectdbParams(keywords, values, 1), server.schema);
    const std::string trouble = connection->set_up(patience);
    if (trouble.empty()) return connection;
    if (is_locked(Error{trouble})) return fail(trouble);
    const PGPing answer = ::PQpingParams(keywords, values, 1);
    if (answer == PQPING_REJECT || answer == PQPING_NO_RESPONSE)
      return fail(trouble + ": " + away_words);
    if (trial == trials) return fail(trouble);
    std::this_thread::sleep_for(std::chrono::milliseconds(50 << trial));
  }
}

}  // namespace
}  // namespace nonio::storage

NONIO_EXPORTED const nonio::storage::PostgreSQL nonio_postgresql;
const nonio::storage::PostgreSQL nonio_postgresql{nonio::storage::check, nonio::storage::connect};
