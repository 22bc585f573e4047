// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "certificates/journal.h"
#include "platform/storage/database.h"

namespace nonio::certificates {

std::int64_t integer(const std::string& text);

/// The tables of a register that was made just now; those of one that version 1 of this format has
/// left, carried over with all that is in it. An error if the file is something else.
Expected<void> make_tables(storage::Database& database);
/// The same in a schema of a server, which is made too. An error if the schema holds anything else.
Expected<void> make_server_tables(storage::Database& database, const std::string& schema);
/// Whether a server's schema has the tables of a register, of whatever version.
bool has_tables(storage::Database& database);
/// Whether it has what this version adds.
bool is_of_this_version(storage::Database& database);

/// What was issued under a number, as the journal keeps it: digests, no contents.
storage::Json issued_json(storage::Database& database, std::int64_t id);

}  // namespace nonio::certificates
