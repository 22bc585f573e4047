// SPDX-License-Identifier: Apache-2.0
#include "laboratory/store/rows.h"

#include <bit>
#include <cmath>

#include "laboratory/store/identity.h"

namespace nonio::store {

namespace {

using storage::Database;

Database::Value value_of(const std::optional<double>& x) {
  return x ? Database::Value(*x) : Database::Value(Database::Null{});
}

std::int64_t number(std::size_t n) { return static_cast<std::int64_t>(n); }

/// Doubles of 8 bytes, the least significant byte first.
std::string bytes_of(const std::vector<double>& numbers) {
  std::string out;
  for (const double x : numbers) {
    const auto bits = std::bit_cast<std::uint64_t>(x);
    for (int shift = 0; shift < 64; shift += 8) out += static_cast<char>(bits >> shift & 0xFF);
  }
  return out;
}

std::optional<double> together(const std::vector<CommonPart>& parts) {
  if (parts.empty()) return std::nullopt;
  double sum = 0.0;
  for (const CommonPart& part : parts) sum += part.u * part.u;
  return std::sqrt(sum);
}

void insert_campaign(Database& database, const Entry& e) {
  const std::string machine = machine_of(e.machine);
  database.put("INSERT INTO machine VALUES (?, ?, ?, ?, ?) ON CONFLICT DO NOTHING",
               {machine, e.machine.asset, e.machine.maker, e.machine.model, e.machine.serial});
  const InstrumentAsStated& i = e.instrument;
  database.put(
      "INSERT INTO campaign VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT DO NOTHING",
      {e.campaign, e.campaign_sha256, machine, e.day, e.customer,
       e.purpose.empty() ? std::string_view("periodic") : std::string_view(e.purpose), i.maker,
       i.model, i.serial, i.certificate, i.calibrated, i.valid_until});
}

void insert_result(Database& database, std::int64_t evaluation, std::int64_t item,
                   const ResultRow& r) {
  database.put("INSERT INTO result VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
               {evaluation, item, r.measurement, r.axis, r.quantity, r.source, r.unit, r.state,
                r.value, value_of(r.u_repeat), value_of(together(r.common)), value_of(r.expanded),
                value_of(r.k), value_of(r.tolerance), r.decision, r.conditions, r.not_stated});
  for (std::size_t i = 0; i < r.common.size(); ++i)
    database.put("INSERT INTO common_part VALUES (?, ?, ?, ?, ?)",
                 {evaluation, item, number(i), r.common[i].source, r.common[i].u});
}

const char* why(const Known& known, const Before& before) {
  if (before.evaluation == 0) return "";
  if (before.campaign_sha256 != known.entry.campaign_sha256) return "files";
  return before.version != known.since.version ? "version" : "settings";
}

}  // namespace

void insert(Database& database, std::int64_t evaluation, const Known& known, const Before& before) {
  const Entry& e = known.entry;
  insert_campaign(database, e);
  const Database::Value supersedes = before.evaluation == 0 ? Database::Value(Database::Null{})
                                                            : Database::Value(before.evaluation);
  database.put("INSERT INTO evaluation VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
               {evaluation, known.since.sha256, e.campaign, e.campaign_sha256,
                static_cast<std::int64_t>(known.since.night.number), known.since.night.date,
                known.since.version, e.status, e.message, supersedes,
                std::string_view(why(known, before)), e.place, e.control});
  for (std::size_t i = 0; i < e.results.size(); ++i)
    insert_result(database, evaluation, number(i), e.results[i]);
  for (const CovarianceRow& c : e.covariance) {
    const std::string upper = bytes_of(c.upper);
    database.put(
        "INSERT INTO covariance VALUES (?, ?, ?, ?, ?)",
        {evaluation, number(c.first), number(c.count), Database::Blob{upper}, c.other_targets});
  }
  for (std::size_t i = 0; i < e.without_value.size(); ++i) {
    const LimitRow& l = e.without_value[i];
    database.put("INSERT INTO limit_without_value VALUES (?, ?, ?, ?, ?, ?, ?)",
                 {evaluation, number(i), l.measurement, l.axis, l.quantity, l.unit, l.tolerance});
  }
  for (std::size_t i = 0; i < e.control_tables.size(); ++i) {
    const ControlTableRow& t = e.control_tables[i];
    database.put("INSERT INTO control_table VALUES (?, ?, ?, ?, ?)",
                 {evaluation, number(i), t.measurement, t.axis, t.state});
  }
  for (std::size_t i = 0; i < e.findings.size(); ++i) {
    const FindingRow& f = e.findings[i];
    database.put("INSERT INTO finding VALUES (?, ?, ?, ?, ?, ?)",
                 {evaluation, number(i), f.measurement, f.source, f.id, f.severity});
  }
}

void insert(Database& database, const std::string& campaign,
            const std::vector<CertificateRow>& certificates) {
  for (const CertificateRow& c : certificates)
    database.put("INSERT INTO certificate VALUES (?, ?, ?, ?, ?) ON CONFLICT DO NOTHING",
                 {c.number, campaign, c.campaign_sha256, c.day, c.replaces});
}

void replace_logs(Database& database, const config::SiteLogs& logs,
                  const std::vector<config::Alias>& aliases,
                  const std::vector<config::Event>& of_records,
                  const std::vector<config::DueRule>& due) {
  for (const char* sql :
       {"DELETE FROM machine_alias", "DELETE FROM event", "DELETE FROM acknowledgement",
        "DELETE FROM forgotten", "DELETE FROM due_rule"})
    database.put(sql);
  for (const config::Alias& a : aliases)
    database.put("INSERT INTO machine_alias VALUES (?, ?, ?)", {a.name, a.asset, a.why});
  std::int64_t item = 0;
  const auto put_event = [&](const config::Event& e, std::string_view source) {
    database.put("INSERT INTO event VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)",
                 {++item, e.date, e.machine, e.axis, e.kind, e.text, e.by, source,
                  static_cast<std::int64_t>(e.line)});
  };
  for (const config::Event& e : logs.events) put_event(e, config::events_name);
  for (const config::Event& e : of_records) put_event(e, "machines");
  item = 0;
  for (const config::Acknowledgement& a : logs.acknowledged)
    database.put(
        "INSERT INTO acknowledgement VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
        {++item, a.date, a.finding, a.machine, a.axis, a.quantity, a.until, value_of(a.value),
         value_of(a.U), a.by, a.why, static_cast<std::int64_t>(a.line)});
  item = 0;
  for (const config::Forgotten& f : logs.forgotten)
    database.put("INSERT INTO forgotten VALUES (?, ?, ?, ?, ?, ?)",
                 {++item, f.date, f.campaign, f.by, f.why, static_cast<std::int64_t>(f.line)});
  for (const config::DueRule& rule : due)
    database.put("INSERT INTO due_rule VALUES (?, ?)",
                 {rule.machine, static_cast<std::int64_t>(rule.months)});
}

}  // namespace nonio::store
