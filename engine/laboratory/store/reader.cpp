// SPDX-License-Identifier: Apache-2.0
#include "laboratory/store/reader.h"

#include <charconv>
#include <set>

#include "laboratory/store/place.h"
#include "nonio/sdk/withheld.h"

namespace nonio::store {
namespace fs = std::filesystem;
using storage::Database;

namespace {

double real_of(const std::string& text) {
  double out = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), out);
  return out;
}

std::optional<double> perhaps(const std::string& text) {
  return text.empty() ? std::nullopt : std::optional(real_of(text));
}

template <class T>
T whole_of(std::string_view text) {
  T out = 0;
  std::from_chars(text.data(), text.data() + text.size(), out);
  return out;
}

constexpr const char* campaign_columns = R"sql(
SELECT c.campaign, c.day, c.customer, c.purpose, e.status, c.instrument_maker, c.instrument_model,
  c.instrument_serial, c.instrument_calibrated, c.instrument_certificate, c.instrument_valid_until, e.evaluation, e.night,
  (SELECT number FROM certificate n WHERE n.campaign = c.campaign AND NOT EXISTS
     (SELECT 1 FROM certificate m WHERE m.replaces = n.number) ORDER BY number DESC LIMIT 1),
  e.place, e.control, e.date
FROM campaign c
)sql";

constexpr const char* counted_evaluation = R"sql(
JOIN evaluation e ON e.campaign = c.campaign AND e.campaign_sha256 = c.campaign_sha256
WHERE e.status <> 'failed' AND NOT EXISTS (SELECT 1 FROM evaluation n WHERE n.supersedes = e.evaluation)
)sql";

constexpr const char* of_machine =
    "AND (c.machine = ? OR c.machine IN (SELECT alias FROM machine_alias WHERE machine = ?)) ";
constexpr const char* of_campaign = "AND c.campaign = ? AND c.campaign = ? ";
constexpr const char* by_day = "ORDER BY c.day, c.campaign";

constexpr const char* results_sql = R"sql(
SELECT item, measurement, axis, quantity, unit, state, decision, conditions, source, value, u_repeat, expanded, k, tolerance
FROM result WHERE evaluation = ? AND (source = 'followed' OR tolerance IS NOT NULL OR quantity IN ('A', 'B', 'E', 'M', 'R')
  OR (quantity IN ('B_mean', 'centre_x', 'centre_y', 'centre_z', 'direction_i', 'direction_j', 'direction_k') AND expanded IS NOT NULL)
  OR (source = 'circle' AND quantity IN ('G_b', 'G_ccw', 'G_cw', 'H', 'D', 'F_max', 'F_min')))
ORDER BY item
)sql";

constexpr const char* states_sql = R"sql(
SELECT COALESCE(a.machine, c.machine) AS name,
  COALESCE(MAX(CASE WHEN a.machine IS NULL THEN m.asset END), MAX(m.asset)),
  COALESCE(MAX(CASE WHEN a.machine IS NULL THEN m.maker END), MAX(m.maker)),
  COALESCE(MAX(CASE WHEN a.machine IS NULL THEN m.model END), MAX(m.model)),
  COALESCE(MAX(CASE WHEN a.machine IS NULL THEN m.serial END), MAX(m.serial)),
  COUNT(DISTINCT c.campaign), MAX(e.night)
FROM latest e
JOIN campaign c ON c.campaign = e.campaign AND c.campaign_sha256 = e.campaign_sha256
JOIN machine m ON m.machine = c.machine
LEFT JOIN machine_alias a ON a.alias = c.machine
WHERE c.machine <> ''
GROUP BY COALESCE(a.machine, c.machine) ORDER BY name
)sql";

constexpr const char* evaluations_sql = R"sql(
SELECT COALESCE(a.machine, c.machine), e.campaign, e.evaluation_sha256, c.day, e.night, n.evaluation
FROM evaluation e
JOIN campaign c ON c.campaign = e.campaign AND c.campaign_sha256 = e.campaign_sha256
LEFT JOIN machine_alias a ON a.alias = c.machine
LEFT JOIN evaluation n ON n.supersedes = e.evaluation
ORDER BY e.evaluation
)sql";

constexpr const char* counted_sql = R"sql(
SELECT COALESCE(a.machine, c.machine) AS name, e.campaign, c.day, e.evaluation_sha256
FROM latest e
JOIN campaign c ON c.campaign = e.campaign AND c.campaign_sha256 = e.campaign_sha256
LEFT JOIN machine_alias a ON a.alias = c.machine
WHERE e.status <> 'failed' ORDER BY name, c.day, e.campaign
)sql";

constexpr const char* followed_sql = R"sql(
SELECT night, COUNT(*) FROM (
  SELECT DISTINCT e.night AS night, COALESCE(a.machine, c.machine), r.axis, r.quantity FROM evaluation e
  JOIN campaign c ON c.campaign = e.campaign AND c.campaign_sha256 = e.campaign_sha256
  LEFT JOIN machine_alias a ON a.alias = c.machine
  JOIN result r ON r.evaluation = e.evaluation
  WHERE r.evaluation >= (SELECT MIN(evaluation) FROM evaluation WHERE night >= ?) AND e.night >= ? AND r.source = 'followed' AND c.machine <> '') t
GROUP BY night
)sql";

void read_results(Database& database, std::size_t campaign, std::int64_t evaluation,
                  StoredMachine& to) {
  std::map<std::string, std::vector<CommonPart>> common;
  for (Database::Row& row : database.rows(
           "SELECT item, source, u FROM common_part WHERE evaluation = ? ORDER BY item, part",
           {evaluation}))
    common[row[0]].push_back({std::move(row[1]), real_of(row[2])});
  const auto targets = database.rows(
      "SELECT first_item, items, other_targets FROM covariance WHERE evaluation = ? "
      "AND other_targets <> '' ORDER BY first_item",
      {evaluation});
  const auto put_targets = [&, first = to.other_targets.size()](std::size_t item, StoredResult& r) {
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const auto begin = whole_of<std::size_t>(targets[i][0]);
      if (item >= begin && item - begin < whole_of<std::size_t>(targets[i][1]))
        r.targets = first + i, r.place = item - begin;
    }
  };
  for (const Database::Row& row : targets) to.other_targets.push_back(row[2]);
  for (Database::Row& r : database.rows(results_sql, {evaluation})) {
    StoredResult result{.campaign = campaign,
                        .measurement = std::move(r[1]),
                        .axis = std::move(r[2]),
                        .quantity = std::move(r[3]),
                        .source = std::move(r[8]),
                        .unit = std::move(r[4]),
                        .state = std::move(r[5]),
                        .decision = std::move(r[6]),
                        .conditions = std::move(r[7]),
                        .value = real_of(r[9]),
                        .u_repeat = perhaps(r[10]),
                        .expanded = perhaps(r[11]),
                        .k = perhaps(r[12]),
                        .tolerance = perhaps(r[13])};
    if (const auto parts = common.find(r[0]); parts != common.end())
      result.common = std::move(parts->second);
    result.followed = result.source == "followed";
    if (result.followed) put_targets(whole_of<std::size_t>(r[0]), result);
    auto& list = result.state == predicted_state ? to.predicted : to.results;
    list.push_back(std::move(result));
  }
}

void read_findings(Database& database, std::size_t campaign, std::int64_t evaluation,
                   StoredMachine& to) {
  for (Database::Row& r : database.rows(
           "SELECT measurement, source, finding, severity FROM finding WHERE evaluation = ? ORDER "
           "BY item",
           {evaluation})) {
    FindingRow f{std::move(r[0]), std::move(r[1]), std::move(r[2]), std::move(r[3])};
    if (auto& severity = to.findings[campaign][f.id]; severity != "attention")
      severity = f.severity;
    if (f.severity == "attention" && is_withholding(f.id))
      to.asked[campaign].push_back(std::move(f));
  }
  for (Database::Row& r : database.rows(
           "SELECT measurement, axis, quantity, unit, tolerance FROM limit_without_value WHERE "
           "evaluation = ? ORDER BY item",
           {evaluation}))
    to.without_value.push_back({campaign, std::move(r[0]), std::move(r[1]), std::move(r[2]),
                                std::move(r[3]), real_of(r[4])});
  for (Database::Row& r : database.rows(
           "SELECT measurement, axis, state FROM control_table WHERE evaluation = ? ORDER BY item",
           {evaluation}))
    to.tables.push_back({campaign, std::move(r[0]), std::move(r[1]), std::move(r[2])});
}

}  // namespace

Expected<StoreReader> StoreReader::open(const fs::path& out) {
  NONIO_TRY(auto database, open_store(out));
  return StoreReader(std::move(database));
}

Expected<std::vector<MachineState>> StoreReader::machines() {
  std::vector<MachineState> out;
  for (Database::Row& r : database_.rows(states_sql))
    out.push_back({{r[0], {r[1], r[2], r[3], r[4]}, whole_of<std::size_t>(r[5])},
                   whole_of<std::uint64_t>(r[6]),
                   {}});
  std::map<std::string, std::set<std::string>> serials;
  for (Database::Row& r :
       database_.rows("SELECT COALESCE(a.machine, m.machine), m.serial FROM machine m LEFT JOIN "
                      "machine_alias a ON a.alias = m.machine WHERE m.serial <> ''"))
    serials[r[0]].insert(std::move(r[1]));
  for (MachineState& m : out) m.serials = std::move(serials[m.machine.name]);
  if (auto well = database_.take_error(); !well) return fail(well.error());
  return out;
}

Expected<StoredMachine> StoreReader::machine(const std::string& name, const std::string& until) {
  return stored(Of::machine, name, until);
}

Expected<StoredMachine> StoreReader::campaign(const std::string& id, const std::string& until) {
  return stored(Of::campaign, id, until);
}

Expected<StoredMachine> StoreReader::stored(Of of, const std::string& name,
                                            const std::string& until) {
  const Database::Reading one_moment(database_);
  StoredMachine out;
  const std::string which =
      std::string(counted_evaluation) + (of == Of::machine ? of_machine : of_campaign);
  const std::string later =
      "SELECT c.campaign, c.day FROM campaign c" + which + "AND c.day > ? " + by_day;
  const std::string campaigns = campaign_columns + which + "AND c.day <= ? " + by_day;
  for (Database::Row& r : database_.rows(later.c_str(), {name, name, until}))
    out.later.push_back({std::move(r[0]), std::move(r[1])});
  for (Database::Row& r : database_.rows(campaigns.c_str(), {name, name, until}))
    out.campaigns.push_back({.id = std::move(r[0]),
                             .day = std::move(r[1]),
                             .customer = std::move(r[2]),
                             .purpose = std::move(r[3]),
                             .status = std::move(r[4]),
                             .instrument = {.maker = std::move(r[5]),
                                            .model = std::move(r[6]),
                                            .serial = std::move(r[7]),
                                            .calibrated = std::move(r[8]),
                                            .certificate = std::move(r[9]),
                                            .valid_until = std::move(r[10])},
                             .evaluation = whole_of<std::int64_t>(r[11]),
                             .run = whole_of<std::uint64_t>(r[12]),
                             .number = std::move(r[13]),
                             .place = std::move(r[14]),
                             .control = std::move(r[15]),
                             .evaluated = std::move(r[16])});
  out.findings.resize(out.campaigns.size());
  out.asked.resize(out.campaigns.size());
  for (std::size_t i = 0; i < out.campaigns.size(); ++i) {
    const std::int64_t evaluation = out.campaigns[i].evaluation;
    read_results(database_, i, evaluation, out);
    read_findings(database_, i, evaluation, out);
  }
  if (auto well = database_.take_error(); !well) return fail(well.error());
  return out;
}

Expected<StoredLogs> StoreReader::logs() {
  StoredLogs out;
  for (Database::Row& r : database_.rows(
           "SELECT day, machine, axis, kind, note, said_by, line, source FROM event ORDER BY "
           "day, item")) {
    out.events.push_back({r[0], r[1], r[2], r[3], r[4], r[5], whole_of<std::uint64_t>(r[6])});
    if (r[7] != config::events_name) out.recorded.insert(r[1]);
  }
  for (Database::Row& r : database_.rows(
           "SELECT day, finding, machine, axis, quantity, until, value, expanded, said_by, why, "
           "line FROM acknowledgement ORDER BY item"))
    out.acknowledged.push_back({r[0], r[1], r[2], r[3], r[4], r[5], perhaps(r[6]), perhaps(r[7]),
                                r[8], r[9], whole_of<std::uint64_t>(r[10])});
  for (Database::Row& r :
       database_.rows("SELECT day, campaign, said_by, why, line FROM forgotten ORDER BY item"))
    out.forgotten.push_back({r[0], r[1], r[2], r[3], whole_of<std::uint64_t>(r[4])});
  for (Database::Row& r : database_.rows("SELECT alias, machine FROM machine_alias"))
    out.aliases[r[0]] = r[1];
  for (Database::Row& r : database_.rows("SELECT machine, months FROM due_rule"))
    out.due[r[0]] = whole_of<int>(r[1]);
  for (const auto& [alias, machine] : out.aliases)  // a rule may name a machine by an alias
    if (const auto rule = out.due.find(alias); rule != out.due.end()) {
      out.due.try_emplace(machine, rule->second);
      out.due.erase(rule);
    }
  if (auto well = database_.take_error(); !well) return fail(well.error());
  return out;
}

Expected<std::map<std::string, std::string>> StoreReader::machine_of_campaigns() {
  std::map<std::string, std::string> out;
  for (Database::Row& r :
       database_.rows("SELECT c.campaign, COALESCE(a.machine, c.machine) FROM campaign c LEFT JOIN "
                      "machine_alias a ON a.alias = c.machine"))
    out[std::move(r[0])] = std::move(r[1]);
  if (auto well = database_.take_error(); !well) return fail(well.error());
  return out;
}

Expected<std::vector<StoredEvaluation>> StoreReader::evaluations() {
  std::vector<StoredEvaluation> out;
  database_.each(evaluations_sql, {}, [&](const std::vector<std::string_view>& r) {
    out.push_back({std::string(r[0]), std::string(r[1]), std::string(r[2]), std::string(r[3]),
                   whole_of<std::uint64_t>(r[4]), r[5].empty()});
  });
  if (auto well = database_.take_error(); !well) return fail(well.error());
  return out;
}

Expected<std::vector<CountedCampaign>> StoreReader::counted_campaigns() {
  std::vector<CountedCampaign> out;
  for (Database::Row& r : database_.rows(counted_sql))
    out.push_back({std::move(r[0]), std::move(r[1]), std::move(r[2]), std::move(r[3])});
  if (auto well = database_.take_error(); !well) return fail(well.error());
  return out;
}

Expected<std::map<std::string, std::string>> StoreReader::certificates() {
  std::map<std::string, std::string> out;
  for (Database::Row& r :
       database_.rows("SELECT campaign, number, replaces FROM certificate ORDER BY number"))
    out[r[0]] += r[1] + '\n' + r[2] + '\n';
  if (auto well = database_.take_error(); !well) return fail(well.error());
  return out;
}

Expected<std::map<std::uint64_t, std::uint64_t>> StoreReader::followed_since(std::uint64_t run) {
  const auto first = static_cast<std::int64_t>(run);
  std::map<std::uint64_t, std::uint64_t> out;
  for (Database::Row& r : database_.rows(followed_sql, {first, first}))
    out[whole_of<std::uint64_t>(r[0])] = whole_of<std::uint64_t>(r[1]);
  if (auto well = database_.take_error(); !well) return fail(well.error());
  return out;
}

}  // namespace nonio::store
