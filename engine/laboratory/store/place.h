// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "platform/storage/database.h"

namespace nonio::store {

/// Location of the store of an output folder, kept in OUT/.nonio/database, so that reading the
/// output folder does not need site.toml.
struct StorePlace {
  std::optional<storage::Server> server{};  ///< server that contains the store; none: the store is
                                            ///< OUT/history.sqlite
  std::string owner{};                      ///< random id, which the schema on the server contains
                                            ///< too
  std::int64_t evaluations = 0;  ///< number of evaluations in the server's store when it was last
                                 ///< written
  /// Random ids of the last 500 updates of the server's store; the server contains the id of the
  /// last one. A copy of this folder lacks the ids of later updates, so two copies that write to
  /// one schema are detected.
  std::vector<std::string> turns{};
};

/// Reads the location; without a file, it is OUT/history.sqlite. An error if the file is damaged.
/// In a file that belongs neither to this user nor to root, the password file is ignored, since its
/// owner could otherwise send this user's password to any server.
Expected<StorePlace> place_of(const std::filesystem::path& out);

/// Stores the location that site.toml states for the store. Returns true if the store was in
/// another place before.
Expected<bool> note_place(const std::filesystem::path& out,
                          const std::optional<storage::Server>& server);
Expected<void> note_evaluations(const std::filesystem::path& out, std::int64_t count);

/// Returns the name of the store for messages: its file or its schema.
std::string name_of(const StorePlace& place, const std::filesystem::path& out);
std::string store_in(const std::filesystem::path& out);

/// Opens the store for reading. On a server, all reads see one snapshot (repeatable read). An error
/// if there is no store, or if its version is not that of this program.
Expected<storage::Database> open_store(const std::filesystem::path& out);

/// Makes the server's schema if it is missing, and adds a turn. An error if the schema belongs to
/// another output folder, or if a copy of this folder has written to it.
Expected<void> take_schema(storage::Database& database, const std::filesystem::path& out);

}  // namespace nonio::store
