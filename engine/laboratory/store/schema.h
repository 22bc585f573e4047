// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "platform/storage/database.h"

namespace nonio::store {

/// Version of the tables. A store of an older version is rebuilt from the results; one of a newer
/// version is an error.
inline constexpr std::int64_t schema_version = 7;

bool has_table(storage::Database& database, std::string_view name);

/// Returns std::nullopt if the database does not contain a store.
std::optional<std::int64_t> version_of(storage::Database& database);

/// Replaces all tables by empty ones in the open transaction.
void make_tables(storage::Database& database);

}  // namespace nonio::store
