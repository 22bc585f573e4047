// SPDX-License-Identifier: Apache-2.0
#include "certificates/register_tables.h"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "platform/storage/digest.h"

namespace nonio::certificates {

namespace {

constexpr const char* schema = R"(
CREATE TABLE counters(
  sequence TEXT PRIMARY KEY,  -- the pattern with its year: each has its own numbers
  last INTEGER NOT NULL
) WITHOUT ROWID;
CREATE TABLE certificates(
  id INTEGER PRIMARY KEY,
  number TEXT NOT NULL UNIQUE,
  campaign TEXT NOT NULL,
  state TEXT NOT NULL CHECK(state IN ('drawn', 'issued', 'withdrawn')),
  date TEXT NOT NULL,  -- of issue; while drawn: of the day on which it was drawn
  issued INTEGER UNIQUE,  -- order of issue
  replaces INTEGER REFERENCES certificates(id),
  reason TEXT NOT NULL,  -- why it was withdrawn, or is not issued yet
  output TEXT, templates TEXT, readings TEXT,
  results BLOB
);
CREATE INDEX of_campaign ON certificates(campaign);
CREATE UNIQUE INDEX one_draft ON certificates(campaign) WHERE state = 'drawn';
CREATE TABLE inputs(
  certificate INTEGER NOT NULL REFERENCES certificates(id),
  place INTEGER NOT NULL,
  name TEXT NOT NULL,
  sha256 TEXT NOT NULL,
  PRIMARY KEY(certificate, place)
) WITHOUT ROWID;
CREATE TABLE files(
  certificate INTEGER NOT NULL REFERENCES certificates(id),
  place INTEGER NOT NULL,
  output TEXT NOT NULL,
  name TEXT NOT NULL,
  no_time_stamp TEXT NOT NULL,
  bytes BLOB NOT NULL,
  PRIMARY KEY(certificate, place)
);
)";
constexpr std::int64_t application = 0x4e6f6e69;  // SQLite application_id that identifies a
                                                  // register

/// Tables that version 2 of the format adds.
constexpr const char* additions = R"(
CREATE TABLE site(
  "only" INTEGER PRIMARY KEY CHECK("only" = 1),
  id TEXT NOT NULL  -- no two registers have the same
);
CREATE TABLE drafts(
  campaign TEXT PRIMARY KEY,
  says TEXT NOT NULL  -- JSON
) WITHOUT ROWID;
)";
constexpr const char* this_version = "2";
constexpr const char* of_newer_version = "was written by a newer version of Nonio";

/// Returns a random UUID (RFC 9562, version 4).
std::string random_id() {
  std::random_device random;
  std::array<unsigned, 4> part{};
  for (unsigned& p : part) p = random();
  part[1] = (part[1] & 0xFFFF0FFFU) | 0x4000U;
  part[2] = (part[2] & 0x3FFFFFFFU) | 0x80000000U;
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%08x-%04x-%04x-%04x-%04x%08x", part[0], part[1] >> 16,
                part[1] & 0xFFFFU, part[2] >> 16, part[2] & 0xFFFFU, part[3]);
  return text.data();
}

void carry_over(storage::Database& database) {
  Journal journal(database);
  for (const storage::Database::Row& row :
       database.rows("SELECT id, number, campaign, date, state, reason FROM certificates ORDER BY "
                     "coalesce(issued, 9e15), id")) {
    journal.add("drawn", row[1], {{"campaign", row[2]}, {"carried_over", true}});
    if (row[4] == "drawn") continue;
    storage::Json says = issued_json(database, integer(row[0]));
    says["carried_over"] = true;
    journal.add("issued", row[1], says);
    if (row[4] == "withdrawn")
      journal.add("withdrawn", row[1], {{"reason", row[5]}, {"carried_over", true}});
  }
}

}  // namespace

std::int64_t integer(const std::string& text) { return std::strtoll(text.c_str(), nullptr, 10); }

/// Whether the schema has the tables. Reads the catalogue instead of calling to_regclass, which may
/// answer from the cache of this connection and miss tables that another process has just made.
bool has_tables(storage::Database& database) {
  return database.first(
             "SELECT count(*) FROM pg_catalog.pg_class c JOIN pg_catalog.pg_namespace n ON n.oid = "
             "c.relnamespace WHERE c.relname = 'register_version' AND n.nspname = "
             "trim('\"' FROM current_setting('search_path'))") == "1";
}

bool is_of_this_version(storage::Database& database) {
  if (database.kind() == storage::Database::Kind::postgresql)
    return has_tables(database) &&
           database.first("SELECT version FROM register_version") == this_version;
  return integer(database.first("PRAGMA application_id")) == application &&
         database.first("PRAGMA user_version") == this_version;
}

namespace {

void note_made(storage::Database& database) {
  const std::string id = random_id();
  database.rows("INSERT INTO site VALUES(1, ?)", {id});
  Journal(database).add("made", "", {{"register", id}});
}

/// Returns the SQL for the tables in a schema of a server. Row numbers are drawn in the transaction
/// that holds the lock, so that their order is that of the certificate numbers.
std::string server_tables() {
  constexpr std::string_view row_number = "  id INTEGER PRIMARY KEY";
  std::string sql = std::string(schema) + additions + Journal::schema +
                    "CREATE TABLE register_version(version TEXT NOT NULL);";
  sql.replace(sql.find(row_number), row_number.size(),
              "  id INTEGER GENERATED BY DEFAULT AS IDENTITY PRIMARY KEY");
  return storage::server_words(std::move(sql));
}

}  // namespace

Expected<void> make_server_tables(storage::Database& database, const std::string& schema_name) {
  const bool made = is_of_this_version(database);
  if (auto well = database.take_error(); !well || made) return well;
  storage::Database::Transaction transaction(database);
  if (is_of_this_version(database))
    return transaction.end();  // another process has made the
                               // tables in the meantime
  if (has_tables(database)) return fail(of_newer_version);
  if (database.first("SELECT count(*) FROM pg_catalog.pg_class c JOIN pg_catalog.pg_namespace n ON "
                     "n.oid = c.relnamespace WHERE n.nspname = ?",
                     {schema_name}) != "0")
    return fail(database.failed() ? database.take_error().error().message
                                  : "it holds other tables, and no register of certificates");
  if (database.first("SELECT count(*) FROM pg_catalog.pg_namespace WHERE nspname = ?",
                     {schema_name}) == "0")
    database.script("CREATE SCHEMA \"" + schema_name + "\"");
  database.script(server_tables());
  note_made(database);
  database.rows("INSERT INTO register_version VALUES(?)", {this_version});
  return transaction.end();
}

Expected<void> make_tables(storage::Database& database) {
  const bool made = is_of_this_version(database);
  if (auto well = database.take_error(); !well || made) return well;
  storage::Database::Transaction transaction(database);
  if (is_of_this_version(database))
    return transaction.end();  // another process has made the
                               // tables in the meantime
  const bool is_marked = integer(database.first("PRAGMA application_id")) == application;
  const bool is_old = is_marked && database.first("PRAGMA user_version") == "1";
  if (!is_old && !database.failed() && database.first("SELECT count(*) FROM sqlite_schema") != "0")
    return fail(is_marked ? of_newer_version : "is no register of certificates");
  if (!is_old) database.script(schema);
  database.script(additions);
  database.script(Journal::schema);
  note_made(database);
  if (is_old) carry_over(database);
  database.script(std::string("PRAGMA user_version = ") + this_version +
                  "; PRAGMA application_id = " + std::to_string(application));
  return transaction.end();
}

storage::Json issued_json(storage::Database& database, std::int64_t id) {
  const auto rows = database.rows(
      "SELECT c.campaign, c.date, c.issued, old.number, c.output, c.templates, c.readings, "
      "c.results FROM certificates c LEFT JOIN certificates old ON old.id = c.replaces "
      "WHERE c.id = ?",
      {id});
  if (rows.empty()) return storage::Json::object();
  const storage::Database::Row& row = rows.front();
  storage::Json says = {{"campaign", row[0]},
                        {"date", row[1]},
                        {"order", integer(row[2])},
                        {"replaces", row[3]},
                        {"output", row[4]},
                        {"templates_sha256", row[5]},
                        {"readings_sha256", row[6]},
                        {"results_sha256", storage::sha256(row[7])},
                        {"inputs", storage::Json::array()},
                        {"files", storage::Json::array()}};
  for (const storage::Database::Row& input :
       database.rows("SELECT name, sha256 FROM inputs WHERE certificate = ? ORDER BY place", {id}))
    says["inputs"].push_back({input[0], input[1]});
  for (const storage::Database::Row& file : database.rows(
           "SELECT output, name, bytes FROM files WHERE certificate = ? ORDER BY place", {id}))
    says["files"].push_back({{"output", file[0]},
                             {"name", file[1]},
                             {"size", file[2].size()},
                             {"sha256", storage::sha256(file[2])}});
  return says;
}

}  // namespace nonio::certificates
