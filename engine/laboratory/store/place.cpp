// SPDX-License-Identifier: Apache-2.0
#include "laboratory/store/place.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <random>

#include "laboratory/store/schema.h"
#include "laboratory/store/store.h"
#include "platform/storage/files.h"
#include "platform/storage/json_values.h"

namespace nonio::store {
namespace fs = std::filesystem;
using storage::Database;

namespace {

constexpr const char* place_name = "database";
fs::path place_folder(const fs::path& out) { return out / ".nonio"; }

std::string random_digits(int count) {
  std::random_device random;
  std::string digits;
  for (int i = 0; i < count; ++i) digits += "0123456789abcdef"[random() % 16];
  return digits;
}

Expected<void> write_place(const fs::path& out, const StorePlace& place) {
  storage::Json json;
  json["owner"] = place.owner;
  json["evaluations"] = place.evaluations;
  if (!place.turns.empty()) json["turns"] = place.turns;
  if (place.server) {
    json["url"] = place.server->url;
    json["schema"] = place.server->schema;
    json["password_file"] = place.server->password_file.string();
  }
  return storage::publish(place_folder(out), {{place_name, json.dump(1) + "\n"}});
}

bool is_of_somebody_else(const fs::path& path) {
  struct stat info {};
  return ::stat(path.c_str(), &info) != 0 || (info.st_uid != ::geteuid() && info.st_uid != 0);
}

/// End of the message if the schema belongs to another output folder.
constexpr const char* another_owner =
    " holds the history of another output folder: give each site a schema of its own ([database] "
    "schema in site.toml). If the output folder of this site was lost, restore OUT/.nonio/database "
    "and the campaigns' earlier.json from the backup, or remove the schema (DROP SCHEMA ... "
    "CASCADE): it is made again from the results that are there";

}  // namespace

Expected<StorePlace> place_of(const fs::path& out) {
  const fs::path path = place_folder(out) / place_name;
  NONIO_TRY(const auto there, storage::is_there(path));
  if (!there) return StorePlace{};
  NONIO_TRY(const auto text, storage::read_small_file(path));
  try {
    const auto json = storage::parse(text);
    StorePlace place{std::nullopt, json.at("owner"), json.at("evaluations"),
                     json.value("turns", std::vector<std::string>{})};
    if (json.contains("url"))
      place.server = storage::Server{json.at("url"), json.at("schema"),
                                     json.at("password_file").get<std::string>()};
    if (place.server && is_of_somebody_else(path)) place.server->password_file.clear();
    return place;
  } catch (const storage::Json::exception&) {
    return fail(path.string() +
                " is damaged: restore it from the backup; it states which schema is this folder's");
  }
}

Expected<bool> note_place(const fs::path& out, const std::optional<storage::Server>& server) {
  NONIO_TRY(auto place, place_of(out));
  const auto where = [](const std::optional<storage::Server>& s) {
    return s ? s->url + "\n" + s->schema : std::string();
  };
  const bool elsewhere = where(place.server) != where(server);
  const auto file = [](const std::optional<storage::Server>& s) {
    return s ? s->password_file : fs::path();
  };
  if (!elsewhere && file(place.server) == file(server)) return false;
  place.server = server;
  if (place.owner.empty()) place.owner = random_digits(32);
  if (auto written = write_place(out, place); !written) return fail(written.error());
  return elsewhere;
}

Expected<void> note_evaluations(const fs::path& out, std::int64_t count) {
  NONIO_TRY(auto place, place_of(out));
  if (place.evaluations == count) return {};
  place.evaluations = count;
  return write_place(out, place);
}

std::string name_of(const StorePlace& place, const fs::path& out) {
  return place.server ? "schema " + place.server->schema + " of " + place.server->url
                      : (out / store_name).string();
}

std::string store_in(const fs::path& out) {
  const auto place = place_of(out);
  return name_of(place ? *place : StorePlace{}, out);
}

Expected<Database> open_store(const fs::path& out) {
  NONIO_TRY(const auto place, place_of(out));
  const std::string name = name_of(place, out);
  const std::string how = ": `nonio run SITE --out " + out.string() + "` writes it";
  if (!place.server) {
    NONIO_TRY(const auto there, storage::is_there(out / store_name));
    if (!there) return fail("there is no " + name + how);
  }
  auto database = place.server ? Database::open(*place.server)
                               : Database::open(out / store_name, Database::Use::write);
  if (!database) return database;
  const auto version = version_of(*database);
  if (place.server && version) {
    // The lock waits until a store that is being rebuilt is complete.
    database->script("BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY");
    database->script("LOCK TABLE store IN ACCESS SHARE MODE");
  }
  if (auto well = database->take_error(); !well) return fail(well.error());
  if (place.server && !version) return fail("there is no history in " + name + how);
  if (version != schema_version)
    return fail(name + " is of version " + std::to_string(version.value_or(0)) +
                ", this program reads " + std::to_string(schema_version) +
                ": `nonio run` makes it again");
  return database;
}

namespace {

/// The turn is stored in the output folder before it is written to the server, so that the folder
/// contains it even after a crash. An error if `place` lacks the turn `last` of the server, because
/// a copy of this folder has written to the schema.
Expected<void> take_turn(Database& database, const fs::path& out, StorePlace& place,
                         const std::string& last) {
  constexpr std::size_t most = 500;
  const auto& turns = place.turns;
  if (!last.empty() && std::find(turns.begin(), turns.end(), last) == turns.end())
    return fail("schema " + place.server->schema +
                " was written since by another copy of this output folder: give each a schema of "
                "its own ([database] schema in site.toml), or leave one of them. If this folder is "
                "the valid one (a restored backup, for example), remove the schema (DROP "
                "SCHEMA ... CASCADE): it is made again from the results that are there");
  place.turns.push_back(random_digits(16));
  if (place.turns.size() > most) place.turns.erase(place.turns.begin());
  if (auto written = write_place(out, place); !written) return written;
  database.put("UPDATE owner SET owner = ?", {place.owner + ":" + place.turns.back()});
  return database.take_error();
}

}  // namespace

Expected<void> take_schema(Database& database, const fs::path& out) {
  NONIO_TRY(auto place, place_of(out));
  const std::string& schema = place.server->schema;
  if (database.first("SELECT COUNT(*) FROM pg_catalog.pg_namespace WHERE nspname = ?", {schema}) ==
      "0")
    database.script("CREATE SCHEMA \"" + schema + "\"");
  if (!has_table(database, "owner")) database.script("CREATE TABLE owner (owner TEXT NOT NULL)");
  std::string owner = database.first("SELECT owner FROM owner");
  if (database.failed()) return database.take_error();
  if (owner.empty()) {
    if (has_table(database, "store")) return fail("schema " + schema + another_owner);
    database.put("INSERT INTO owner VALUES (?)", {place.owner});
    owner = place.owner;
  }
  const std::size_t mark = owner.find(':');
  if (owner.substr(0, mark) != place.owner) return fail("schema " + schema + another_owner);
  return take_turn(database, out, place, mark == owner.npos ? "" : owner.substr(mark + 1));
}

}  // namespace nonio::store
