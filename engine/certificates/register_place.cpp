// SPDX-License-Identifier: Apache-2.0
#include "certificates/register_place.h"

#include "certificates/journal.h"
#include "certificates/register.h"
#include "certificates/register_tables.h"
#include "platform/storage/files.h"

namespace nonio::certificates {
namespace fs = std::filesystem;
using storage::Database;

namespace {

constexpr const char* identity_name = "certificates.register";

std::string what_of(const RegisterPlace& place) {
  return std::string("the register of certificates ") + (place.server ? "in " : "");
}

/// Confirmed transactions must be on the disks of the server and of a standby that may take over.
Expected<void> check_durable(Database& database) {
  const auto rows = database.rows(
      "SELECT current_setting('fsync'), current_setting('full_page_writes'), "
      "current_setting('synchronous_commit'), current_setting('synchronous_standby_names')");
  if (auto well = database.take_error(); !well) return well;
  const auto& settings = rows.front();
  constexpr const char* names[] = {"fsync", "full_page_writes", "synchronous_commit"};
  for (std::size_t i = 0; i < std::size(names); ++i)
    if (settings[i] == "off")
      return fail(std::string(names[i]) +
                  " is off on this server: after a power cut it would give numbers a second time; "
                  "expected on");
  const std::string& commit = settings[2];
  if (!settings[3].empty() && commit != "on" && commit != "remote_apply")
    return fail("synchronous_commit is " + commit +
                " on this server, which has synchronous_standby_names: a standby that takes over "
                "would give numbers a second time; expected on or remote_apply");
  return {};
}

struct Identity {
  std::string id;          ///< empty if the site has no register yet
  std::int64_t place = 0;  ///< position of the last known journal entry, or 0
  std::string sha256{};
};

constexpr std::string_view entry_key = "entry ";

/// Format: "UUID", and on a second line "entry 17 SHA-256"; without a file, an empty identity.
Expected<Identity> identity_in(const RegisterPlace& place) {
  NONIO_TRY(const auto there, storage::is_there(place.identity));
  if (!there) return Identity{};
  NONIO_TRY(const auto text, storage::read_small_file(place.identity));
  Identity identity{text.substr(0, text.find('\n'))};
  if (identity.id.empty())
    return fail(place.identity.string() +
                " is empty; expected the identity of the site's register");
  const std::size_t second = text.find('\n');
  const std::string_view rest =
      second == std::string::npos ? std::string_view() : std::string_view(text).substr(second + 1);
  if (!rest.starts_with(entry_key)) return identity;
  const std::size_t blank = rest.find(' ', entry_key.size());
  identity.place = integer(std::string(rest.substr(entry_key.size())));
  if (blank != rest.npos) identity.sha256 = rest.substr(blank + 1, rest.find('\n') - blank - 1);
  return identity;
}

Error is_gone(const RegisterPlace& place, const std::string& identity) {
  return Error{"the register " + identity + " of this site (" + place.identity.string() +
               ") is not in " + place.name +
               ": restore it from the backup; a new one would give numbers a second time. If it is "
               "lost for good, use another [certificate] numbering, and keep that file outside the "
               "site"};
}

/// A new register next to one of the other kind (file or server) would begin with number 1 again.
Expected<void> check_is_first(const RegisterPlace& place) {
  NONIO_TRY(const auto there, storage::is_there(place.other));
  if (!there) return {};
  return fail("the site has a register already (" + place.other.string() + "), and " + place.name +
              " would be a new one that gives its numbers a second time; expected the one that is "
              "there in site.toml. If a new register is meant, give it another [certificate] "
              "numbering, and keep that file outside the site");
}

/// Must be called inside a transaction, so that only one process writes at a time.
Expected<void> write_identity(const RegisterPlace& place, const Identity& identity) {
  std::string text = identity.id + "\n";
  if (identity.place > 0)
    text += std::string(entry_key) + std::to_string(identity.place) + " " + identity.sha256 + "\n";
  return storage::publish(place.identity.parent_path(),
                          {{place.identity.filename().string(), std::move(text)}});
}

/// Checks that the journal still contains the last entry known to the site.
Expected<void> check_state(Database& database, const RegisterPlace& place, const Identity& known) {
  if (known.place == 0) return {};
  const std::string sha256 =
      database.first("SELECT sha256 FROM journal WHERE place = ?", {known.place});
  if (auto well = database.take_error(); !well) return well;
  if (sha256 == known.sha256) return {};
  return fail(place.name + (sha256.empty() ? " ends before" : " has another") + " entry " +
              std::to_string(known.place) + " of its journal than this site has seen (" +
              place.identity.string() +
              "): an older state was restored, or a standby without the last entries took over. "
              "Numbers would be given a second time; restore the newest state of the register");
}

/// Two sites, or a site and a copy of it, must never draw numbers from one register. If the site
/// has no identity file yet, an empty register, or any register that is a file, is accepted; with
/// `may_write`, the identity file is then written.
Expected<void> check_identity(Database& database, const RegisterPlace& place, bool may_write) {
  const std::string id = database.first("SELECT id FROM site");
  const bool is_new = database.first("SELECT count(*) FROM certificates") == "0";
  if (auto well = database.take_error(); !well) return well;
  NONIO_TRY(const auto known, identity_in(place));
  if (known.id == id) return check_state(database, place, known);
  if (!known.id.empty()) return fail(is_gone(place, known.id));
  if (is_new || !place.server) return may_write ? note_state(database, place) : Expected<void>();
  return fail(place.name + " holds the register " + id +
              " of another site: give each site a schema of its own ([database] register in "
              "site.toml). If it is this site's, write its identity into " +
              place.identity.string());
}

Expected<Database> open_on_server(const RegisterPlace& place, bool create, double patience,
                                  bool as_it_is) {
  auto database = Database::open(*place.server, patience);
  if (!database) return database;
  if (auto durable = check_durable(*database); !durable)
    return fail(place.name + ": " + durable.error().message);
  const bool there = has_tables(*database);
  if (auto well = database->take_error(); !well) return fail(well.error());
  if (!there) {
    if (const auto known = identity_in(place); !known || !known->id.empty())
      return fail(known ? is_gone(place, known->id) : known.error());
    if (const auto first = check_is_first(place); create && !first) return fail(first.error());
  }
  if (create)
    if (auto made = make_server_tables(*database, place.server->schema); !made)
      return fail(place.name + ": " + made.error().message);
  if (as_it_is) return database;
  if (auto ours = check_identity(*database, place, create); !ours) return fail(ours.error());
  return database;
}

Expected<Database> open_file(const RegisterPlace& place, Database::Use use, double patience,
                             bool as_it_is) {
  const bool create = use == Database::Use::create;
  NONIO_TRY(const auto known, identity_in(place));
  if (create) {
    NONIO_TRY(const auto there, storage::is_there(place.file));
    if (!there && !known.id.empty()) return fail(is_gone(place, known.id));
    if (const auto first = check_is_first(place); !there && !first) return fail(first.error());
    std::error_code error;
    fs::create_directories(place.file.parent_path(), error);
  }
  auto database = Database::open(place.file, use, patience);
  if (!database) return database;
  if (!known.id.empty() && database->first("SELECT count(*) FROM sqlite_schema") == "0")
    return fail(is_gone(place, known.id));
  if (auto well = database->take_error(); !well) return fail(well.error());
  if (create)
    if (auto made = make_tables(*database); !made)
      return fail(place.name + ": " + made.error().message);
  if (is_of_this_version(*database) && !as_it_is)
    if (auto ours = check_identity(*database, place, create); !ours) return fail(ours.error());
  if (auto well = database->take_error(); !well) return fail(well.error());
  return database;
}

}  // namespace

Expected<void> note_state(Database& database, const RegisterPlace& place) {
  Database::Transaction transaction(database);
  Identity now{database.first("SELECT id FROM site")};
  if (const auto last = Journal(database).last()) {
    now.place = last->place;
    now.sha256 = last->sha256;
  }
  if (auto well = database.take_error(); !well) return well;
  NONIO_TRY(const auto known, identity_in(place));
  if (known.id.empty() || known.place < now.place)
    if (auto written = write_identity(place, now); !written) return written;
  return transaction.end();
}

Expected<RegisterPlace> register_place(const fs::path& site, const config::Numbering& numbering) {
  NONIO_TRY(const auto path, register_path(site, numbering));
  NONIO_TRY(const auto identity, storage::path_inside(site, identity_name));
  if (!numbering.server) {
    fs::path own = path;
    own += ".identity";
    return RegisterPlace{path, {}, path.string(), std::move(own), identity};
  }
  const auto& [url, password_file, schema, unused] = *numbering.server;
  return RegisterPlace{
      identity,
      storage::Server{url, schema,
                      password_file.empty() ? fs::path() : fs::absolute(site / password_file)},
      "schema " + schema + " of " + url, identity, path};
}

Expected<bool> has_register(const RegisterPlace& place, double patience) {
  if (!place.server) {
    const auto there = storage::is_there(place.file);
    if (!there) return fail(what_of(place) + place.name + ": " + there.error().message);
    if (*there) return true;
    NONIO_TRY(const auto known, identity_in(place));
    if (!known.id.empty()) return fail(is_gone(place, known.id));
    return false;
  }
  auto database = Database::open(*place.server, patience);
  if (!database) return fail(what_of(place) + database.error().message);
  const bool there = has_tables(*database);
  if (auto well = database->take_error(); !well) return fail(what_of(place) + well.error().message);
  if (there) return true;
  NONIO_TRY(const auto known, identity_in(place));
  if (!known.id.empty()) return fail(is_gone(place, known.id));
  return false;
}

Expected<void> check_seen_state(Database& database, const RegisterPlace& place) {
  return check_identity(database, place, false);
}

Expected<Database> open_register(const RegisterPlace& place, Database::Use use, double patience,
                                 bool as_it_is) {
  auto database = place.server
                      ? open_on_server(place, use == Database::Use::create, patience, as_it_is)
                      : open_file(place, use, patience, as_it_is);
  if (!database) return fail(what_of(place) + database.error().message);
  return database;
}

}  // namespace nonio::certificates
