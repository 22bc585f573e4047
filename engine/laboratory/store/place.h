// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "platform/storage/database.h"

namespace nonio::store {

/// Where the store of an output folder lies, kept in OUT/.nonio/database: whoever reads the output
/// folder needs no site.toml for it.
struct StorePlace {
  std::optional<storage::Server> server{};  ///< none: OUT/history.sqlite
  std::string owner{};                      ///< random; the schema on the server bears it too
  std::int64_t evaluations = 0;  ///< that the server's store had when it was last written
  /// Random, one each time that the store is written; the server has the one of the last time. A
  /// copy of this folder does not know those that come after it.
  std::vector<std::string> turns{};
};

/// An error if the file is damaged. Where it belongs to somebody else it names no password file:
/// it would have us send our own password to a server of his choice.
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

/// Makes the server's schema if it is not there. An error if it is another output folder's, or if a
/// copy of this one has written into it.
Expected<void> take_schema(storage::Database& database, const std::filesystem::path& out);

}  // namespace nonio::store
