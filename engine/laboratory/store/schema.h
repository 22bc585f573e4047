// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "platform/storage/database.h"

namespace nonio::store {

/// Of the tables below. A store of an older version is made again from the results; one of a newer
/// version is refused.
inline constexpr std::int64_t schema_version = 7;

bool has_table(storage::Database& database, std::string_view name);

/// The version that a database states it is of; none: it is empty.
std::optional<std::int64_t> version_of(storage::Database& database);

/// In place of whatever was there, in the transaction that is open.
void make_tables(storage::Database& database);

}  // namespace nonio::store
