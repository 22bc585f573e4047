// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "certificates/journal.h"
#include "platform/storage/database.h"

namespace nonio::certificates {

std::int64_t integer(const std::string& text);

/// Makes the tables of a new register, or converts those of version 1 with their content. An error
/// if the file is not a register.
Expected<void> make_tables(storage::Database& database);
/// Makes the tables, and the schema if necessary. An error if the schema contains anything else.
Expected<void> make_server_tables(storage::Database& database, const std::string& schema);
/// Whether a server's schema has the tables of any version of the format.
bool has_tables(storage::Database& database);
bool is_of_this_version(storage::Database& database);

/// Returns the issued certificate in the form of the journal: digests without contents.
storage::Json issued_json(storage::Database& database, std::int64_t id);

}  // namespace nonio::certificates
