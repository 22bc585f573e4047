// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"
#include "platform/storage/database.h"
#include "platform/storage/packed_results.h"

/// A pack: one file with the results of many campaigns, an SQLite archive (`sqlite3 -At -f FILE`
/// lists it) with an additional table `digest`. Names in the archive are CAMPAIGN-ID/FILE. A pack
/// contains no time, so that the same files give the same bytes.
///
/// PACK/ID/FILE is the address of a file in a pack, which `read_file`, `read_parts`,
/// `sha256_of_file` and `is_there` of files.h accept as a path. Each file is compared with its
/// digest when it is read.
namespace nonio::storage {

inline constexpr std::string_view packs_folder = ".nonio/packs";
inline constexpr const char* pack_suffix = ".sqlar";

struct PackAddress {
  std::filesystem::path pack;
  std::string name;
};
/// Returns std::nullopt if the path is not a file below `.nonio/packs`.
std::optional<PackAddress> in_pack(const std::filesystem::path& path);

class PackWriter {
 public:
  /// Creates a pack in a folder that no other process uses; nothing is flushed.
  static Expected<PackWriter> create(const std::filesystem::path& path);
  /// Names must be added in sorted order, because the order determines the bytes of the pack.
  Expected<void> add(const std::string& name, std::string_view bytes);
  Expected<void> end();

 private:
  explicit PackWriter(Database database) : database_(std::move(database)) {}
  Database database_;
};

/// Returns std::nullopt if the pack has no such file. An error if the pack is missing, or if the
/// pack or this file is damaged.
Expected<std::optional<std::string>> read_packed(const PackAddress& at);
/// Returns the size in bytes without reading the content; std::nullopt if the file does not exist.
Expected<std::optional<std::uint64_t>> size_packed(const PackAddress& at);
/// Returns the sorted names that begin with `folder` and '/', without this prefix.
Expected<std::vector<std::string>> names_packed(const PackAddress& folder);
/// Compares all files of a pack with their digests. An error names campaign and file.
Expected<void> check_pack(const std::filesystem::path& pack);
/// Copies a pack into OUT/.nonio/packs, where it appears completely or not at all. Its name is
/// `begin` and a part of its digest, so that different content has a different name.
Expected<PackFile> hand_over(const std::filesystem::path& pack, const std::filesystem::path& out,
                             const std::string& begin);
/// Checks that a pack in OUT/.nonio/packs still has its digest.
Expected<void> check_handed_over(const std::filesystem::path& out, const PackFile& pack);
/// Closes the packs that this process keeps open; reading reopens them.
void close_packs();

}  // namespace nonio::storage
