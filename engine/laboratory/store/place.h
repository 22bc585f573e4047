// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "platform/storage/database.h"

namespace nonio::store {

/// Location of the store, kept in OUT/.nonio/database, so that reading does not need site.toml.
struct StorePlace {
  std::optional<storage::Server> server{};  ///< std::nullopt for OUT/history.sqlite
  /// Random id, which the schema on the server contains too.
  std::string owner{};
  std::int64_t evaluations = 0;  ///< number of evaluations on the server after the last update
  /// Random ids of the last 500 updates on the server, which contains the last id. Two copies of
  /// the output folder that write to one schema are detected, because each lacks ids of the other.
  std::vector<std::string> turns{};
};

/// Reads OUT/.nonio/database; without this file, the location is OUT/history.sqlite. An error if
/// the file is damaged. The password file is ignored unless root or this user owns the file,
/// because another owner could send the password to any server.
Expected<StorePlace> place_of(const std::filesystem::path& out);

/// Stores the location that site.toml states. Returns true if it has changed.
Expected<bool> note_place(const std::filesystem::path& out,
                          const std::optional<storage::Server>& server);
Expected<void> note_evaluations(const std::filesystem::path& out, std::int64_t count);

/// Returns the name of the store in messages: its file or schema.
std::string name_of(const StorePlace& place, const std::filesystem::path& out);
std::string store_in(const std::filesystem::path& out);

/// Opens the store for reading; on a server, all reads see one snapshot (repeatable read). An error
/// if there is no store of this version.
Expected<storage::Database> open_store(const std::filesystem::path& out);

/// Makes the schema of the server if it does not exist, and adds a turn. An error if it belongs to
/// another output folder, or if a copy of this folder has written to it.
Expected<void> take_schema(storage::Database& database, const std::filesystem::path& out);

}  // namespace nonio::store
