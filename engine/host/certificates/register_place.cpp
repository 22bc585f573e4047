// SPDX-License-Identifier: Apache-2.0
#include "host/certificates/register_place.h"

#include "host/certificates/register.h"
#include "host/certificates/register_tables.h"
#include "host/storage/files.h"

namespace nonio::host::certificates {
namespace fs = std::filesystem;
using storage::Database;

namespace {

constexpr const char* identity_name = "certificates.register";

std::string what_of(const RegisterPlace& place) {
  return std::string("the register of certificates ") + (place.server ? "in " : "");
}

/// What a server has confirmed has to be on its disk, and on that of a standby that may take over.
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

/// Empty: the site has none yet.
Expected<std::string> identity_in(const RegisterPlace& place) {
  const auto there = storage::is_there(place.file);
  if (!there) return fail(there.error());
  if (!*there) return std::string();
  auto text = storage::read_small_file(place.file);
  if (!text) return fail(text.error());
  while (text->ends_with('\n')) text->pop_back();
  if (text->empty())
    return fail(place.file.string() + " is empty; expected the identity of the site's register");
  return text;
}

Error is_gone(const RegisterPlace& place, const std::string& identity) {
  return Error{"the register " + identity + " of this site (" + place.file.string() +
               ") is not in " + place.name +
               ": restore it from the backup; a new one would give numbers a second time"};
}

/// A register is not moved from a file to a server or back: a new one would begin with 1.
Expected<void> check_is_first(const RegisterPlace& place) {
  const auto there = storage::is_there(place.other);
  if (!there) return fail(there.error());
  if (!*there) return {};
  return fail("the site has a register already (" + place.other.string() + "), and " + place.name +
              " would be a new one that gives its numbers a second time; expected the one that is "
              "there in site.toml. If a new register is meant, give it another [certificate] "
              "numbering, and keep that file outside the site");
}

/// One process at a time, wherever it is.
Expected<void> note_identity(Database& database, const RegisterPlace& place,
                             const std::string& identity) {
  Database::Transaction transaction(database);
  if (database.failed()) return database.take_error();
  if (const auto known = identity_in(place); !known || known->empty()) {
    if (!known) return fail(known.error());
    const auto done =
        storage::publish(place.file.parent_path(), {{identity_name, identity + "\n"}});
    if (!done) return done;
  }
  return transaction.end();
}

/// Two sites, or a site and its copy for trials, never draw from one register unseen.
Expected<void> check_identity(Database& database, const RegisterPlace& place, bool may_write) {
  const std::string identity = database.first("SELECT id FROM site");
  const bool is_new = database.first("SELECT count(*) FROM certificates") == "0";
  if (auto well = database.take_error(); !well) return well;
  const auto known = identity_in(place);
  if (!known) return fail(known.error());
  if (*known == identity) return {};
  if (!known->empty()) return fail(is_gone(place, *known));
  if (is_new) return may_write ? note_identity(database, place, identity) : Expected<void>();
  return fail(place.name + " holds the register " + identity +
              " of another site: give each site a schema of its own ([database] register in "
              "site.toml). If it is this site's, write its identity into " +
              place.file.string());
}

Expected<Database> open_on_server(const RegisterPlace& place, bool create, double patience) {
  auto database = Database::open(*place.server, patience);
  if (!database) return database;
  if (auto durable = check_durable(*database); !durable)
    return fail(place.name + ": " + durable.error().message);
  const bool there = has_tables(*database);
  if (auto well = database->take_error(); !well) return fail(well.error());
  if (!there) {
    if (const auto known = identity_in(place); !known || !known->empty())
      return fail(known ? is_gone(place, *known) : known.error());
    if (const auto first = check_is_first(place); create && !first) return fail(first.error());
  }
  if (create)
    if (auto made = make_server_tables(*database, place.server->schema); !made)
      return fail(place.name + ": " + made.error().message);
  if (auto ours = check_identity(*database, place, create); !ours) return fail(ours.error());
  return database;
}

Expected<Database> open_file(const RegisterPlace& place, Database::Use use, double patience) {
  std::error_code error;
  if (use == Database::Use::create) {
    const auto there = storage::is_there(place.file);
    if (!there) return fail(there.error());
    if (const auto first = check_is_first(place); !*there && !first) return fail(first.error());
    fs::create_directories(place.file.parent_path(), error);
  }
  auto database = Database::open(place.file, use, patience);
  if (!database || use != Database::Use::create) return database;
  if (auto made = make_tables(*database); !made)
    return fail(place.name + ": " + made.error().message);
  return database;
}

}  // namespace

Expected<RegisterPlace> register_place(const fs::path& site, const config::Numbering& numbering) {
  const auto path = register_path(site, numbering);
  if (!path) return fail(path.error());
  const auto identity = storage::path_inside(site, identity_name);
  if (!identity) return fail(identity.error());
  if (!numbering.server) return RegisterPlace{*path, {}, path->string(), *identity};
  const auto& [url, password_file, schema, unused] = *numbering.server;
  return RegisterPlace{
      *identity,
      storage::Server{url, schema,
                      password_file.empty() ? fs::path() : fs::absolute(site / password_file)},
      "schema " + schema + " of " + url, *path};
}

Expected<bool> has_register(const RegisterPlace& place, double patience) {
  if (!place.server) {
    const auto there = storage::is_there(place.file);
    return there ? there : fail(what_of(place) + place.name + ": " + there.error().message);
  }
  auto database = Database::open(*place.server, patience);
  if (!database) return fail(what_of(place) + database.error().message);
  const bool there = has_tables(*database);
  if (auto well = database->take_error(); !well) return fail(what_of(place) + well.error().message);
  if (there) return true;
  const auto known = identity_in(place);
  if (!known) return fail(known.error());
  if (!known->empty()) return fail(is_gone(place, *known));
  return false;
}

Expected<Database> open_register(const RegisterPlace& place, Database::Use use, double patience) {
  auto database = place.server ? open_on_server(place, use == Database::Use::create, patience)
                               : open_file(place, use, patience);
  if (!database) return fail(what_of(place) + database.error().message);
  return database;
}

}  // namespace nonio::host::certificates
