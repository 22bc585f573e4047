// SPDX-License-Identifier: Apache-2.0
#include "laboratory/store/query.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include "laboratory/store/place.h"
#include "nonio/sdk/format.h"
#include "platform/storage/database.h"
#include "platform/storage/nearest.h"

namespace nonio::store {
namespace fs = std::filesystem;
using storage::Database;

namespace {

Expected<std::vector<NamedMachine>> machines_of(Database& database, const char* sql) {
  std::vector<NamedMachine> machines;
  for (Database::Row& row : database.rows(sql))
    machines.push_back({row[0], {row[1], row[2], row[3], row[4]}, std::stoul(row[5])});
  if (auto well = database.take_error(); !well) return fail(well.error());
  return machines;
}

/// `superseded`: also a name that only earlier versions of campaigns state.
Expected<std::string> known_machine(Database& database, const std::string& name, bool superseded) {
  const std::string alias =
      database.first("SELECT machine FROM machine_alias WHERE alias = ?", {name});
  const std::string machine = alias.empty() ? name : alias;
  const std::string stated =
      std::string("FROM campaign c JOIN ") + (superseded ? "evaluation" : "latest") +
      " e ON e.campaign = c.campaign AND e.campaign_sha256 = c.campaign_sha256 ";
  const bool known =
      !alias.empty() ||
      !database.rows(("SELECT 1 " + stated + "WHERE c.machine = ? LIMIT 1").c_str(), {machine})
           .empty();
  if (auto well = database.take_error(); !well) return fail(well.error());
  if (known) return machine;
  std::vector<std::string> names;
  for (Database::Row& row :
       database.rows(("SELECT DISTINCT c.machine " + stated + "ORDER BY c.machine").c_str()))
    names.push_back(std::move(row[0]));
  return fail("there is no machine \"" + name + "\" in the history" +
              storage::suggestion(name, names));
}

/// A name that no result contains is an error, because it is probably a spelling mistake.
Expected<void> check_name(Database& database, const char* what, const char* sql,
                          const std::string& name) {
  if (name.empty()) return {};
  std::vector<std::string> names;
  for (Database::Row& row : database.rows(sql)) names.push_back(std::move(row[0]));
  if (auto well = database.take_error(); !well) return well;
  if (std::find(names.begin(), names.end(), name) != names.end()) return {};
  return fail("there is no " + std::string(what) + " \"" + name + "\" in the history" +
              storage::suggestion(name, names));
}

constexpr const char* points = R"sql(
SELECT COALESCE(a.machine, c.machine) AS name, r.axis, r.quantity, r.source, r.unit, c.day, r.state, c.purpose,
  r.value, r.u_repeat, r.u_common, COALESCE(r.expanded, (SELECT MIN(2.0 * s.expanded / COALESCE(s.k, 2.0)) FROM result s
    WHERE r.source = 'followed' AND s.evaluation = r.evaluation AND s.measurement = r.measurement AND s.quantity = r.quantity
    AND s.unit = r.unit AND s.source <> 'followed' AND s.state <> 'predicted')), r.k, r.tolerance, r.decision, c.campaign, r.measurement,
  c.instrument_serial, c.instrument_certificate, r.conditions, e.evaluation, n.evaluation
FROM campaign c
LEFT JOIN machine_alias a ON a.alias = c.machine
JOIN evaluation e ON e.campaign = c.campaign AND e.campaign_sha256 = c.campaign_sha256
JOIN result r ON r.evaluation = e.evaluation
LEFT JOIN evaluation n ON n.supersedes = e.evaluation
WHERE (? = '' OR COALESCE(a.machine, c.machine) = ?) AND (? = '' OR r.axis = ?) AND (? = '' OR r.quantity = ?)
  AND (? = '' OR r.source = ?) AND (? = '' OR c.day >= ?) AND (? = '' OR c.day <= ?)
  AND (? = 1 OR n.evaluation IS NULL)
ORDER BY name, r.axis, r.quantity, r.source, c.day, r.state, c.campaign, e.evaluation, r.item
)sql";

void complete(Point& p) {
  if (p.source != "followed") return;
  if (p.expanded.empty() && !p.u_repeat.empty())
    append_shortest(p.expanded, 2.0 * std::hypot(std::strtod(p.u_repeat.c_str(), nullptr),
                                                 std::strtod(p.u_common.c_str(), nullptr)));
  if (!p.expanded.empty() && p.k.empty()) p.k = "2";
}

Point point_of(Database::Row& r) {
  return {r[0],  r[1],  r[2],  r[3],  r[4],  r[5],  r[6],  r[7],  r[8],  r[9],  r[10],
          r[11], r[12], r[13], r[14], r[15], r[16], r[17], r[18], r[19], r[20], r[21]};
}

constexpr const char* joined_machines =
    "SELECT COALESCE(a.machine, m.machine) AS name, MAX(m.asset), MAX(m.maker), MAX(m.model), "
    "MAX(m.serial), COUNT(DISTINCT c.campaign) FROM machine m LEFT JOIN machine_alias a ON a.alias "
    "= m.machine JOIN campaign c ON c.machine = m.machine JOIN latest e ON e.campaign = c.campaign "
    "AND e.campaign_sha256 = c.campaign_sha256 GROUP BY COALESCE(a.machine, m.machine) "
    "ORDER BY name";
constexpr const char* stated_machines =
    "SELECT m.machine, m.asset, m.maker, m.model, m.serial, COUNT(DISTINCT c.campaign) FROM "
    "machine m JOIN campaign c ON c.machine = m.machine JOIN latest e ON e.campaign = c.campaign "
    "AND "
    "e.campaign_sha256 = c.campaign_sha256 GROUP BY m.machine, m.asset, m.maker, "
    "m.model, m.serial ORDER BY m.machine";

}  // namespace

Expected<std::vector<Point>> query(const fs::path& out, const Query& wanted) {
  NONIO_TRY(auto database, open_store(out));
  std::string machine;
  if (!wanted.machine.empty()) {
    NONIO_TRY(auto known, known_machine(database, wanted.machine, wanted.superseded));
    machine = std::move(known);
  }
  if (auto well = check_name(database, "axis", "SELECT DISTINCT axis FROM result ORDER BY axis",
                             wanted.axis);
      !well)
    return fail(well.error());
  if (auto well =
          check_name(database, "quantity", "SELECT DISTINCT quantity FROM result ORDER BY quantity",
                     wanted.quantity);
      !well)
    return fail(well.error());
  std::vector<Point> found;
  for (Database::Row& row :
       database.rows(points, {machine, machine, wanted.axis, wanted.axis, wanted.quantity,
                              wanted.quantity, wanted.source, wanted.source, wanted.from,
                              wanted.from, wanted.to, wanted.to, std::int64_t{wanted.superseded}}))
    complete(found.emplace_back(point_of(row)));
  if (auto well = database.take_error(); !well) return fail(well.error());
  return found;
}

Expected<std::string> machine_named(const fs::path& out, const std::string& name) {
  NONIO_TRY(auto opened, open_store(out));
  return known_machine(opened, name, false);
}

Expected<std::vector<NamedMachine>> machines_in(const fs::path& out) {
  NONIO_TRY(auto opened, open_store(out));
  return machines_of(opened, joined_machines);
}

Expected<std::vector<Spelling>> spellings_in(const fs::path& out) {
  NONIO_TRY(auto opened, open_store(out));
  NONIO_TRY(const auto machines, machines_of(opened, stated_machines));
  std::map<std::string, std::string> aliases;
  for (Database::Row& row : opened.rows("SELECT alias, machine FROM machine_alias"))
    aliases[row[0]] = row[1];
  if (auto well = opened.take_error(); !well) return fail(well.error());
  const auto joined = [&](const std::string& name) {
    const auto found = aliases.find(name);
    return found == aliases.end() ? name : found->second;
  };
  auto found = spellings(machines);
  std::erase_if(found, [&](const Spelling& s) { return joined(s.one) == joined(s.other); });
  return found;
}

}  // namespace nonio::store
