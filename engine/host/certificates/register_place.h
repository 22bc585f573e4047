// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "host/config/manifest.h"
#include "host/storage/database.h"

namespace nonio::host::certificates {

/// Where a site's register of numbers is: an SQLite file inside the site, or a schema of a
/// PostgreSQL server (`[database] register`). A schema lies apart from its site: the file
/// `certificates.register` of the site holds the identity of its register.
struct RegisterPlace {
  std::filesystem::path file{};  ///< the register; on a server: what holds its identity
  std::optional<storage::Server> server{};
  std::string name{};             ///< for messages
  std::filesystem::path other{};  ///< is there where the site's register is of the other kind
};

Expected<RegisterPlace> register_place(const std::filesystem::path& site,
                                       const config::Numbering& numbering);
/// Whether anything was entered there yet; looking makes nothing. An error if it is gone.
Expected<bool> has_register(const RegisterPlace& place, double patience);
/// Made with `create`. Refused: a server that may lose what it has confirmed, since it would give
/// numbers again; the register of another site; a new one where the site has one of the other kind.
Expected<storage::Database> open_register(const RegisterPlace& place, storage::Database::Use use,
                                          double patience);

}  // namespace nonio::host::certificates
