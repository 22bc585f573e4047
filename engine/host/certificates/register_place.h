// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "host/config/manifest.h"
#include "host/storage/database.h"

namespace nonio::host::certificates {

/// Where a site's register of numbers is: an SQLite file inside the site, or a schema of a
/// PostgreSQL server (`register = "postgresql://user@host/name#schema"`).
struct RegisterPlace {
  std::filesystem::path file{};  ///< empty: on a server
  std::optional<storage::Server> server{};
  std::string name{};  ///< for messages
};

Expected<RegisterPlace> register_place(const std::filesystem::path& site,
                                       const config::Numbering& numbering);
/// Whether anything was entered there yet; looking makes nothing.
Expected<bool> has_register(const RegisterPlace& place, double patience);
/// Made with `create`. A server that may lose what it has confirmed is refused: after a power cut
/// it would give numbers again.
Expected<storage::Database> open_register(const RegisterPlace& place, storage::Database::Use use,
                                          double patience);

}  // namespace nonio::host::certificates
