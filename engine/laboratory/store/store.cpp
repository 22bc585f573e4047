// SPDX-License-Identifier: Apache-2.0
#include "laboratory/store/store.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "campaign/config/manifest.h"
#include "campaign/config/site_logs.h"
#include "laboratory/store/earlier.h"
#include "laboratory/store/identity.h"
#include "laboratory/store/place.h"
#include "laboratory/store/schema.h"
#include "platform/storage/database.h"
#include "platform/storage/files.h"

namespace nonio::store {
namespace fs = std::filesystem;
using storage::Database;

namespace {

struct Before {
  std::int64_t evaluation = 0;
  std::string campaign_sha256, version;
};

Database::Value value_of(const std::optional<double>& x) {
  return x ? Database::Value(*x) : Database::Value(Database::Null{});
}

std::int64_t number(std::size_t n) { return static_cast<std::int64_t>(n); }

/// Little-endian, 8 bytes per double.
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

void insert(Database& database, std::int64_t evaluation, const Known& known, const Before& before) {
  const Entry& e = known.entry;
  insert_campaign(database, e);
  const Database::Value supersedes = before.evaluation == 0 ? Database::Value(Database::Null{})
                                                            : Database::Value(before.evaluation);
  database.put(
      "INSERT INTO evaluation VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
      {evaluation, known.since.sha256, e.campaign, e.campaign_sha256,
       static_cast<std::int64_t>(known.since.run.number), known.since.run.date, known.since.version,
       e.status, e.message, supersedes, std::string_view(why(known, before)), e.place, e.control});
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

/// Replaces logs, events of machine records, aliases and calibration intervals by those in the
/// files of the site.
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

constexpr const char* known_folder = ".nonio";
constexpr const char* known_name = "history";

struct Place {
  std::uint64_t run = 0;
  std::string campaign;
  std::size_t in_chain = 0;
  auto key() const { return std::tie(run, campaign, in_chain); }
};
bool operator<(const Place& a, const Place& b) { return a.key() < b.key(); }

Before before_of(std::int64_t number, const Known& known) {
  return {number, known.entry.campaign_sha256, known.since.version};
}

std::int64_t last_number(Database& database) {
  const std::string last = database.first("SELECT MAX(evaluation) FROM evaluation");
  return last.empty() ? 0 : std::stoll(last);
}

class Filling {
 public:
  Filling(const fs::path& out, Database& database, const std::function<void()>& alive,
          Updated& updated)
      : out_(out), database_(database), alive_(alive), updated_(updated) {}

  Expected<void> all() {
    NONIO_TRY(auto places, all_places());
    std::int64_t number = 0;
    std::map<std::string, Before> last;  // only for campaigns with several evaluations
    for (const Place& place : places) {
      alive_();
      const auto history =
          history_of(storage::results_folder(out_, place.campaign), place.campaign);
      if (!history || place.in_chain >= history->evaluations.size()) {
        leave_out(place.campaign,
                  history ? "its files changed meanwhile" : history.error().message);
        continue;
      }
      const Known& known = history->evaluations[place.in_chain];
      const auto before = last.find(place.campaign);
      insert(database_, ++number, known, before == last.end() ? Before{} : before->second);
      insert(database_, place.campaign, history->certificates);
      if (history->evaluations.size() > 1) last[place.campaign] = before_of(number, known);
      if (database_.failed()) return database_.take_error();
    }
    updated_.evaluations = static_cast<std::uint64_t>(number);
    return {};
  }

  /// Adds new evaluations of these campaigns. Returns false if the store contradicts the files or
  /// if an evaluation precedes the last one in the store.
  Expected<bool> some(const std::vector<std::string>& campaigns) {
    const Place last = last_place();
    std::map<Place, std::pair<Known, Before>> added;
    for (const std::string& campaign : campaigns) {
      alive_();
      auto history = history_of(storage::results_folder(out_, campaign), campaign);
      if (!history) {
        leave_out(campaign, history.error().message);
        continue;
      }
      const auto rows = database_.rows(
          "SELECT evaluation, evaluation_sha256, campaign_sha256, version FROM evaluation WHERE "
          "campaign = ? ORDER BY evaluation",
          {campaign});
      if (database_.failed()) return fail(database_.take_error().error());
      if (!fits(rows, history->evaluations)) return false;
      std::uint64_t run = 0;
      for (std::size_t i = 0; i < history->evaluations.size(); ++i) {
        run = std::max(run, history->evaluations[i].since.run.number);
        if (i < rows.size()) continue;
        Before before;
        if (i == rows.size() && i > 0)
          before = {std::stoll(rows.back()[0]), rows.back()[2], rows.back()[3]};
        const Place place{run, campaign, i};
        if (place < last) return false;
        added.emplace(place, std::pair(std::move(history->evaluations[i]), std::move(before)));
      }
      insert(database_, campaign, history->certificates);
    }
    return add(std::move(added));
  }

 private:
  static bool fits(const std::vector<Database::Row>& rows, const std::vector<Known>& known) {
    if (rows.size() > known.size()) return false;
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (rows[i][1] != known[i].since.sha256) return false;
    return true;
  }

  Place last_place() {
    const auto rows =
        database_.rows("SELECT night, campaign FROM evaluation ORDER BY evaluation DESC LIMIT 1");
    return rows.empty() ? Place{} : Place{std::stoull(rows[0][0]), rows[0][1], 0};
  }

  Expected<bool> add(std::map<Place, std::pair<Known, Before>> added) {
    std::int64_t number = last_number(database_) + 1;
    std::map<std::string, Before> last;
    for (auto& [place, what] : added) {
      auto& [known, before] = what;
      if (const auto mine = last.find(place.campaign); mine != last.end()) before = mine->second;
      insert(database_, number, known, before);
      last[place.campaign] = before_of(number, known);
      ++number;
      ++updated_.evaluations;
      alive_();
    }
    if (database_.failed()) return fail(database_.take_error().error());
    return true;
  }

  Expected<std::vector<Place>> all_places() {
    std::vector<Place> places;
    // The order in a campaign is kept even if the numbers of runs were reset.
    const auto listed = storage::each_results_folder(out_, [&](const fs::path& folder) {
      alive_();
      const std::string campaign = folder.filename().string();
      if (!config::is_campaign_id(campaign)) return;
      const auto record = storage::is_there(folder / evaluation::results_name);
      if (record && !*record) return;
      const auto runs = runs_of(folder);
      if (!runs) return leave_out(campaign, runs.error().message);
      std::uint64_t run = 0;
      for (std::size_t i = 0; i < runs->size(); ++i) {
        run = std::max(run, (*runs)[i]);
        places.push_back({run, campaign, i});
      }
    });
    if (!listed) return fail(listed.error());
    std::sort(places.begin(), places.end());
    return places;
  }

  void leave_out(const std::string& campaign, const std::string& why) {
    std::string line = campaign + ": " + why;
    if (updated_.left_out.empty() || updated_.left_out.back() != line)
      updated_.left_out.push_back(std::move(line));
  }

  const fs::path& out_;
  Database& database_;
  const std::function<void()>& alive_;
  Updated& updated_;
};

Expected<Database> open(const fs::path& out) {
  auto database = Database::open(out / store_name, Database::Use::create);
  if (!database) return database;
  database->rows("PRAGMA cache_size = -65536");
  if (auto well = database->take_error(); !well) return fail(well.error());
  return database;
}

/// A file that cannot be read is replaced, because it can be rebuilt, but not a file that another
/// process has locked.
Expected<Database> open_or_replace(const fs::path& out, const StorePlace& place) {
  if (place.server) return Database::open(*place.server);
  auto database = open(out);
  if (database) {
    version_of(*database);
    const auto well = database->take_error();
    if (well) return database;
    if (storage::is_locked(well.error())) return fail(well.error());
  } else if (storage::is_locked(database.error())) {
    return database;
  }
  const fs::path path = out / store_name;
  std::error_code error;
  for (const char* suffix : {"-journal", ""})
    if (!fs::remove(fs::path(path.string() + suffix), error) && error)
      return fail("cannot remove " + path.string() + suffix + ": " + error.message());
  return open(out);
}

Expected<void> check_version(std::optional<std::int64_t> version, const std::string& name) {
  if (!version || *version <= schema_version) return {};
  return fail(name + " is of version " + std::to_string(*version) + ", this program writes " +
              std::to_string(schema_version) +
              ": use the newer program, or remove it; it is made again");
}

/// Removes history.sqlite, which would become outdated, and notes the number of evaluations on the
/// server.
Expected<void> leave_to_server(const fs::path& out, std::int64_t evaluations) {
  std::error_code error;
  const fs::path path = out / store_name;
  if (!fs::remove(path, error) && error)
    return fail("cannot remove " + path.string() + ", which is no longer kept: " + error.message());
  return note_evaluations(out, evaluations);
}

Expected<Updated> write(const fs::path& out, bool all, const std::vector<std::string>& campaigns,
                        const SiteRecords& records, const std::function<void()>& alive) {
  NONIO_TRY(const auto place, place_of(out));
  NONIO_TRY(auto database, open_or_replace(out, place));
  Updated updated;
  Database::Transaction transaction(database);
  const auto version = version_of(database);
  if (database.failed()) return fail(database.take_error().error());
  if (auto fit = check_version(version, name_of(place, out)); !fit) return fail(fit.error());
  if (place.server)
    if (auto ours = take_schema(database, out); !ours) return fail(ours.error());
  bool again = all || version != schema_version;
  // A server that was restored from a backup or replaced by its standby may lack the last runs.
  if (!again && place.server) again = last_number(database) != place.evaluations;
  Filling filling(out, database, alive, updated);
  if (!again) {
    NONIO_TRY(const auto added, filling.some(campaigns));
    again = !added;
  }
  if (again) {
    updated = {0, true, {}};
    make_tables(database);
    if (auto filled = filling.all(); !filled) return fail(filled.error());
  }
  replace_logs(database, records.logs, records.aliases, records.of_records, records.due);
  const std::int64_t last = last_number(database);
  if (auto ended = transaction.end(); !ended) return fail(ended.error());
  if (place.server)
    if (auto noted = leave_to_server(out, last); !noted) return fail(noted.error());
  return updated;
}

}  // namespace

Expected<Updated> update(const fs::path& out, bool behind, std::vector<std::string> campaigns,
                         const SiteRecords& records, const std::function<void()>& alive) {
  std::sort(campaigns.begin(), campaigns.end());
  campaigns.erase(std::unique(campaigns.begin(), campaigns.end()), campaigns.end());
  return write(out, behind, campaigns, records, alive);
}

Expected<std::optional<std::uint64_t>> known_run(const fs::path& out) {
  const fs::path path = out / known_folder / known_name;
  NONIO_TRY(const auto there, storage::is_there(path));
  if (!there) return std::nullopt;
  NONIO_TRY(const auto text, storage::read_small_file(path));
  std::uint64_t run = 0;
  const char* const end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, run);
  if (error != std::errc() || std::string_view(at, end) != "\n") return std::nullopt;
  return run;
}

Expected<void> forget_known_run(const fs::path& out) {
  // The note is overwritten, because files cannot be removed on some network shares.
  return storage::publish(out / known_folder, {{known_name, "none\n"}});
}

Expected<void> note_known_run(const fs::path& out, std::uint64_t run) {
  return storage::publish(out / known_folder, {{known_name, std::to_string(run) + "\n"}});
}

}  // namespace nonio::store
