// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "campaign/config/manifest.h"
#include "platform/storage/database.h"

namespace nonio::certificates {

/// Location of a site's register: an SQLite file inside the site, or a schema of a PostgreSQL
/// server. An identity file in the site contains the id of the register and its last known journal
/// entry, so that a register that was lost, emptied or restored to an older state is detected. Its
/// name is `certificates.register` for a schema, otherwise the name of the file with `.identity`
/// appended.
struct RegisterPlace {
  std::filesystem::path file{};  ///< the register file; for a server, its identity file
  std::optional<storage::Server> server{};
  std::string name{};  ///< name of the file or schema in messages
  std::filesystem::path identity{};
  std::filesystem::path other{};  ///< register of the other kind, which must not exist
};

/// Updates the identity file, unless it states the last journal entry or a later one.
Expected<void> note_state(storage::Database& database, const RegisterPlace& place);

Expected<RegisterPlace> register_place(const std::filesystem::path& site,
                                       const config::Numbering& numbering);
/// Does not create the register. An error if it existed before and no longer does.
Expected<bool> has_register(const RegisterPlace& place, double patience);
/// Opens the register, or creates it if `use` is `create`. Errors: a server that may lose confirmed
/// transactions, so that numbers could be given twice; the register of another site; a second
/// register of the other kind. `as_it_is`: skip the comparison with the identity file, for an
/// audit.
Expected<storage::Database> open_register(const RegisterPlace& place, storage::Database::Use use,
                                          double patience, bool as_it_is = false);
/// Returns an error if the register does not belong to the site, or lacks known entries.
Expected<void> check_seen_state(storage::Database& database, const RegisterPlace& place);

}  // namespace nonio::certificates
