// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "database.h"
#include "journal.h"

namespace nonio::host {

std::int64_t integer(const std::string& text);

/// The tables of a register that was made just now; those of one that version 1 of this format has
/// left, carried over with all that is in it. An error if the file is something else.
Expected<void> make_tables(Database& database);
/// Whether it has what this version adds.
bool is_of_this_version(Database& database);

/// What was issued under a number, as the journal keeps it: digests, no contents.
Json issued_json(Database& database, std::int64_t id);

}  // namespace nonio::host
