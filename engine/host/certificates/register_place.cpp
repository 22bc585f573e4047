// SPDX-License-Identifier: Apache-2.0
#include "host/certificates/register_place.h"

#include <algorithm>

#include "host/certificates/register.h"
#include "host/certificates/register_tables.h"
#include "host/storage/files.h"

namespace nonio::host::certificates {
namespace fs = std::filesystem;
using storage::Database;

namespace {

constexpr std::string_view server_scheme = "postgresql:";
constexpr const char* usual_schema = "nonio_register";

bool is_schema(const std::string& name) {
  constexpr std::size_t most = 63;
  return !name.empty() && name.size() <= most && (name[0] < '0' || name[0] > '9') &&
         std::all_of(name.begin(), name.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
         });
}

/// What a server has confirmed has to be on its disk.
Expected<void> check_durable(Database& database, const std::string& name) {
  for (const char* setting : {"fsync", "synchronous_commit", "full_page_writes"}) {
    const std::string value = database.first("SELECT current_setting(?)", {setting});
    if (auto well = database.take_error(); !well) return well;
    if (value == "off")
      return fail(name + ": " + setting +
                  " is off on this server: after a power cut it would give numbers a second time; "
                  "expected on");
  }
  return {};
}

}  // namespace

Expected<RegisterPlace> register_place(const fs::path& site, const config::Numbering& numbering) {
  const std::string& stated = numbering.register_file;
  if (!stated.starts_with(server_scheme)) {
    const auto path = register_path(site, numbering);
    if (!path) return fail(path.error());
    return RegisterPlace{*path, {}, path->string()};
  }
  const std::string key = "[certificate] register in site.toml: ";
  const std::size_t mark = stated.rfind('#');
  const std::string url = stated.substr(0, mark);
  const std::string schema = mark == stated.npos ? usual_schema : stated.substr(mark + 1);
  if (auto well = storage::check_address(url); !well) return fail(key + well.error().message);
  if (!is_schema(schema))
    return fail(key + "expected a schema of a-z, 0-9 and _ behind #, found \"" + schema + "\"");
  return RegisterPlace{{}, storage::Server{url, schema, {}}, "schema " + schema + " of " + url};
}

Expected<bool> has_register(const RegisterPlace& place, double patience) {
  if (!place.server) {
    std::error_code error;
    const auto kind = fs::status(place.file, error).type();
    if (kind == fs::file_type::none)
      return fail("cannot look at the register of certificates " + place.name + ": " +
                  error.message());
    return kind != fs::file_type::not_found;
  }
  auto database = Database::open(*place.server, patience);
  if (!database) return fail("the register of certificates: " + database.error().message);
  const bool there = has_tables(*database);
  if (auto well = database->take_error(); !well) return fail(well.error());
  return there;
}

Expected<Database> open_register(const RegisterPlace& place, Database::Use use, double patience) {
  if (!place.server && use == Database::Use::create) {
    std::error_code error;
    fs::create_directories(place.file.parent_path(), error);
  }
  auto database = place.server ? Database::open(*place.server, patience)
                               : Database::open(place.file, use, patience);
  if (!database) return fail("the register of certificates: " + database.error().message);
  if (place.server)
    if (auto durable = check_durable(*database, place.name); !durable)
      return fail("the register of certificates, " + durable.error().message);
  if (use != Database::Use::create) return database;
  if (auto made = make_tables(*database, place.server ? place.server->schema : ""); !made)
    return fail("the register of certificates " + place.name + ": " + made.error().message);
  return database;
}

}  // namespace nonio::host::certificates
