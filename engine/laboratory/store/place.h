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
  std::optional<storage::Server> server{};  ///< none: OUT/history.sqlite
  std::string owner{};                      ///< random; the schema on the server bears it too
  std::int64_t evaluations = 0;  ///< that the server's store had when it was last written
  /// Random, one each time that the store is written; the server has the one of the last time. A
  /// copy of this folder does not know those that come after it.
  std::vector<std::string> turns{};
};

/// An error if the file is damaged. In a file of another user a password file is ignored: that user
/// could otherwise make this process send its password to any server.
Expected<StorePlace> place_of(const std::filesystem::path& out);

/// As site.toml has it. True: the store lay elsewhere before.
Expected<bool> note_place(const std::filesystem::path& out,
                          const std::optional<storage::Server>& server);
Expected<void> note_evaluations(const std::filesystem::path& out, std::int64_t count);

/// For messages: the file or the schema.
std::string name_of(const StorePlace& place, const std::filesystem::path& out);
std::string store_in(const std::filesystem::path& out);

/// The store, opened to be read: on a server all that is read from it belongs to one run.
Expected<storage::Database> open_store(const std::filesystem::path& out);

/// Makes the server's schema if it is missing. An error if it is another output folder's, or if a
/// copy of this one has written into it.
Expected<void> take_schema(storage::Database& database, const std::filesystem::path& out);

}  // namespace nonio::store
