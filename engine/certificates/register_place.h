// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "campaign/config/manifest.h"
#include "platform/storage/database.h"

namespace nonio::certificates {

/// Where a site's register of numbers is: an SQLite file inside the site, or a schema of a
/// PostgreSQL server (`[database] register`). A file in the site holds the identity of its register
/// and how far its journal went: `certificates.register` of a schema, else the name of the file and
/// `.identity`. So a register that was lost, emptied or restored to an older state is recognised.
struct RegisterPlace {
  std::filesystem::path file{};  ///< the register; on a server: what holds its identity
  std::optional<storage::Server> server{};
  std::string name{};  ///< for messages
  std::filesystem::path identity{};
  std::filesystem::path other{};  ///< is there where the site's register is of the other kind
};

/// Notes the last entry of its journal in the file of its identity.
Expected<void> note_state(storage::Database& database, const RegisterPlace& place);

Expected<RegisterPlace> register_place(const std::filesystem::path& site,
                                       const config::Numbering& numbering);
/// Whether anything was entered there yet; looking makes nothing. An error if it no longer exists.
Expected<bool> has_register(const RegisterPlace& place, double patience);
/// Made with `create`. Refused: a server that may lose what it has confirmed, since it would give
/// numbers again; the register of another site; a new one where the site has one of the other kind.
/// `as_it_is`: not compared with what the site has seen, for an audit, which states all that is
/// wrong.
Expected<storage::Database> open_register(const RegisterPlace& place, storage::Database::Use use,
                                          double patience, bool as_it_is = false);
/// An error if it is not the register of the site, or lacks entries that the site has seen.
Expected<void> check_seen_state(storage::Database& database, const RegisterPlace& place);

}  // namespace nonio::certificates
