// SPDX-License-Identifier: Apache-2.0
#include "laboratory/store/schema.h"

#include <charconv>
#include <string>
#include <string_view>

namespace nonio::store {
using storage::Database;

namespace {

/// Types and keywords are common to SQLite and PostgreSQL. Sequence numbers and doubles have 8
/// bytes.
constexpr const char* tables = R"sql(
CREATE TABLE store (name TEXT PRIMARY KEY, value BIGINT NOT NULL);
CREATE TABLE machine (
  machine TEXT PRIMARY KEY, asset TEXT NOT NULL, maker TEXT NOT NULL, model TEXT NOT NULL, serial TEXT NOT NULL);
CREATE TABLE campaign (
  campaign TEXT NOT NULL, campaign_sha256 TEXT NOT NULL, machine TEXT NOT NULL REFERENCES machine,
  day TEXT NOT NULL, customer TEXT NOT NULL, purpose TEXT NOT NULL, instrument_maker TEXT NOT NULL,
  instrument_model TEXT NOT NULL, instrument_serial TEXT NOT NULL, instrument_certificate TEXT NOT NULL,
  instrument_calibrated TEXT NOT NULL, instrument_valid_until TEXT NOT NULL,
  PRIMARY KEY (campaign, campaign_sha256));
CREATE TABLE evaluation (
  evaluation BIGINT PRIMARY KEY, evaluation_sha256 TEXT NOT NULL, campaign TEXT NOT NULL,
  campaign_sha256 TEXT NOT NULL, night BIGINT NOT NULL, date TEXT NOT NULL, version TEXT NOT NULL,
  status TEXT NOT NULL, message TEXT NOT NULL, supersedes BIGINT UNIQUE REFERENCES evaluation, why TEXT NOT NULL,
  place TEXT NOT NULL, control TEXT NOT NULL,
  FOREIGN KEY (campaign, campaign_sha256) REFERENCES campaign);
CREATE INDEX evaluation_of_campaign ON evaluation (campaign, evaluation);
CREATE INDEX campaign_of_machine ON campaign (machine);
CREATE TABLE result (
  evaluation BIGINT NOT NULL, item BIGINT NOT NULL, measurement TEXT NOT NULL, axis TEXT NOT NULL,
  quantity TEXT NOT NULL, source TEXT NOT NULL, unit TEXT NOT NULL, state TEXT NOT NULL,
  value DOUBLE PRECISION NOT NULL, u_repeat DOUBLE PRECISION, u_common DOUBLE PRECISION, expanded DOUBLE PRECISION,
  k DOUBLE PRECISION, tolerance DOUBLE PRECISION, decision TEXT NOT NULL, conditions TEXT NOT NULL,
  not_stated TEXT NOT NULL, PRIMARY KEY (evaluation, item));
CREATE TABLE common_part (
  evaluation BIGINT NOT NULL, item BIGINT NOT NULL, part BIGINT NOT NULL, source TEXT NOT NULL,
  u DOUBLE PRECISION NOT NULL, PRIMARY KEY (evaluation, item, part));
CREATE TABLE finding (
  evaluation BIGINT NOT NULL, item BIGINT NOT NULL, measurement TEXT NOT NULL, source TEXT NOT NULL,
  finding TEXT NOT NULL, severity TEXT NOT NULL, PRIMARY KEY (evaluation, item));
CREATE TABLE limit_without_value (
  evaluation BIGINT NOT NULL, item BIGINT NOT NULL, measurement TEXT NOT NULL, axis TEXT NOT NULL,
  quantity TEXT NOT NULL, unit TEXT NOT NULL, tolerance DOUBLE PRECISION NOT NULL, PRIMARY KEY (evaluation, item));
CREATE TABLE control_table (
  evaluation BIGINT NOT NULL, item BIGINT NOT NULL, measurement TEXT NOT NULL, axis TEXT NOT NULL,
  state TEXT NOT NULL, PRIMARY KEY (evaluation, item));
CREATE TABLE certificate (
  number TEXT PRIMARY KEY, campaign TEXT NOT NULL, campaign_sha256 TEXT NOT NULL, day TEXT NOT NULL,
  replaces TEXT NOT NULL);
CREATE TABLE machine_alias (alias TEXT PRIMARY KEY, machine TEXT NOT NULL, why TEXT NOT NULL);
CREATE TABLE event (
  item BIGINT PRIMARY KEY, day TEXT NOT NULL, machine TEXT NOT NULL, axis TEXT NOT NULL, kind TEXT NOT NULL,
  note TEXT NOT NULL, said_by TEXT NOT NULL, source TEXT NOT NULL, line BIGINT NOT NULL);
CREATE TABLE acknowledgement (
  item BIGINT PRIMARY KEY, day TEXT NOT NULL, finding TEXT NOT NULL, machine TEXT NOT NULL, axis TEXT NOT NULL,
  quantity TEXT NOT NULL, until TEXT NOT NULL, value DOUBLE PRECISION, expanded DOUBLE PRECISION,
  said_by TEXT NOT NULL, why TEXT NOT NULL, line BIGINT NOT NULL);
CREATE TABLE forgotten (
  item BIGINT PRIMARY KEY, day TEXT NOT NULL, campaign TEXT NOT NULL, said_by TEXT NOT NULL, why TEXT NOT NULL,
  line BIGINT NOT NULL);
CREATE TABLE due_rule (machine TEXT PRIMARY KEY, months BIGINT NOT NULL);
CREATE VIEW latest AS
  SELECT e.* FROM evaluation e
  WHERE NOT EXISTS (SELECT 1 FROM evaluation n WHERE n.supersedes = e.evaluation);
CREATE VIEW point AS
  SELECT COALESCE(a.machine, c.machine) AS machine, r.axis, r.quantity, r.source, r.unit, c.day, r.state,
    r.value, r.u_repeat, r.u_common, r.expanded, r.k, r.tolerance, r.decision, c.campaign, c.purpose,
    r.measurement, c.instrument_serial, c.instrument_certificate, r.conditions, e.evaluation, r.item
  FROM latest e
  JOIN campaign c ON c.campaign = e.campaign AND c.campaign_sha256 = e.campaign_sha256
  JOIN result r ON r.evaluation = e.evaluation
  LEFT JOIN machine_alias a ON a.alias = c.machine;
)sql";

/// The types of this table differ between SQLite and PostgreSQL.
constexpr const char* covariance_table = R"sql(
CREATE TABLE covariance (
  evaluation BIGINT NOT NULL, first_item BIGINT NOT NULL, items BIGINT NOT NULL, upper_triangle BLOB NOT NULL,
  other_targets TEXT NOT NULL,
  PRIMARY KEY (evaluation, first_item));
)sql";

/// Rows are only added to these tables until the store is rebuilt.
constexpr const char* append_only[] = {
    "machine",    "campaign", "evaluation",          "result",        "common_part",
    "covariance", "finding",  "limit_without_value", "control_table", "certificate"};
/// Child tables precede their parents.
constexpr const char* all_tables[] = {
    "common_part",   "covariance",    "finding",     "limit_without_value",
    "control_table", "result",        "certificate", "evaluation",
    "campaign",      "machine",       "event",       "acknowledgement",
    "forgotten",     "machine_alias", "store",       "due_rule"};

/// Triggers of a server that reject changes of append-only tables. They are per statement, so that
/// TRUNCATE is rejected too.
std::string server_triggers() {
  std::string sql =
      "CREATE FUNCTION append_only() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN "
      "RAISE EXCEPTION '% is append-only', TG_TABLE_NAME; END $$;\n";
  for (const std::string table : append_only)
    sql += "CREATE TRIGGER " + table + "_append_only BEFORE UPDATE OR DELETE OR TRUNCATE ON " +
           table + " FOR EACH STATEMENT EXECUTE FUNCTION append_only();\n";
  return sql;
}

std::string triggers() {
  std::string sql;
  for (const std::string table : append_only)
    for (const std::string what : {"UPDATE", "DELETE"})
      sql += "CREATE TRIGGER " + table + "_no_" + what + " BEFORE " + what + " ON " + table +
             " BEGIN SELECT RAISE(ABORT, '" + table + " is append-only'); END;\n";
  return sql;
}

}  // namespace

bool has_table(Database& database, std::string_view name) {
  return database.first(database.kind() == Database::Kind::sqlite
                            ? "SELECT COUNT(*) FROM sqlite_master WHERE type = 'table' AND name = ?"
                            : "SELECT COUNT(*) FROM pg_catalog.pg_tables WHERE schemaname = "
                              "current_schema() AND tablename = ?",
                        {name}) == "1";
}

std::optional<std::int64_t> version_of(Database& database) {
  if (!has_table(database, "store")) return std::nullopt;
  const std::string text = database.first("SELECT value FROM store WHERE name = 'schema'");
  std::int64_t version = 0;
  std::from_chars(text.data(), text.data() + text.size(), version);
  if (database.kind() != Database::Kind::sqlite) return version;
  // A newer program may store its version in another table, so the mark in the file is read too.
  const std::string mark = database.first("PRAGMA user_version");
  std::int64_t marked = 0;
  std::from_chars(mark.data(), mark.data() + mark.size(), marked);
  return marked > schema_version ? marked : version;
}

void make_tables(Database& database) {
  // Readers lock this table first; the same order excludes a deadlock.
  if (database.kind() == Database::Kind::postgresql && has_table(database, "store"))
    database.script("LOCK TABLE store IN ACCESS EXCLUSIVE MODE");
  std::string sql = "DROP VIEW IF EXISTS point;\nDROP VIEW IF EXISTS latest;\n";
  for (const std::string table : all_tables) sql += "DROP TABLE IF EXISTS " + table + ";\n";
  const std::string made = std::string(tables) + covariance_table;
  if (database.kind() == Database::Kind::postgresql)
    sql += "DROP FUNCTION IF EXISTS append_only();\n" + storage::server_words(made) +
           server_triggers();
  else
    sql += made + triggers() + "PRAGMA user_version = " + std::to_string(schema_version) + ";\n";
  database.script(sql);
  database.rows("INSERT INTO store VALUES ('schema', ?)", {schema_version});
}

}  // namespace nonio::store
