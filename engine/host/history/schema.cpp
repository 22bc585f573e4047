// SPDX-License-Identifier: Apache-2.0
#include "host/history/schema.h"

#include <charconv>
#include <string>

namespace nonio::host::history {

namespace {

/// Types and words that SQLite and PostgreSQL both have. Sequence numbers and doubles need 8 bytes.
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

/// The one type that they call differently.
constexpr const char* covariance_table = R"sql(
CREATE TABLE covariance (
  evaluation BIGINT NOT NULL, first_item BIGINT NOT NULL, items BIGINT NOT NULL, upper_triangle BLOB NOT NULL,
  PRIMARY KEY (evaluation, first_item));
)sql";

/// What campaigns say; the others are copies of the site's files as they are now.
constexpr const char* append_only[] = {"machine",     "campaign",   "evaluation", "result",
                                       "common_part", "covariance", "finding",    "certificate"};
/// Children first.
constexpr const char* all_tables[] = {
    "common_part", "covariance",    "finding", "result", "certificate",
    "evaluation",  "campaign",      "machine", "event",  "acknowledgement",
    "forgotten",   "machine_alias", "store"};

std::string triggers() {
  std::string sql;
  for (const std::string table : append_only)
    for (const std::string what : {"UPDATE", "DELETE"})
      sql += "CREATE TRIGGER " + table + "_no_" + what + " BEFORE " + what + " ON " + table +
             " BEGIN SELECT RAISE(ABORT, '" + table + " is append-only'); END;\n";
  return sql;
}

}  // namespace

std::optional<std::int64_t> version_of(storage::Database& database) {
  const std::string has =
      database.first("SELECT COUNT(*) FROM sqlite_master WHERE type = 'table' AND name = 'store'");
  if (has != "1") return std::nullopt;
  const std::string text = database.first("SELECT value FROM store WHERE name = 'schema'");
  std::int64_t version = 0;
  std::from_chars(text.data(), text.data() + text.size(), version);
  return version;
}

void make_tables(storage::Database& database) {
  std::string sql = "DROP VIEW IF EXISTS point;\nDROP VIEW IF EXISTS latest;\n";
  for (const std::string table : all_tables) sql += "DROP TABLE IF EXISTS " + table + ";\n";
  sql += tables;
  sql += covariance_table;
  sql += triggers();
  sql += "PRAGMA user_version = " + std::to_string(schema_version) + ";\n";
  database.script(sql);
  database.rows("INSERT INTO store VALUES ('schema', ?)", {schema_version});
}

}  // namespace nonio::host::history
