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

/// A pack: one file with the results of many campaigns. It is an SQLite archive (`sqlite3 -At -f
/// FILE` lists it) with an additional table `digest`. A name in it is CAMPAIGN-ID/FILE. A pack
/// contains no time, so that the same files give the same bytes.
///
/// PACK/ID/FILE is the address of a file in a pack, which `read_file`, `read_parts`,
/// `sha256_of_file` and `is_there` of files.h accept as a path. Each file that is read is compared
/// with its digest.
namespace nonio::storage {

inline constexpr std::string_view packs_folder = ".nonio/packs";
inline constexpr const char* pack_suffix = ".sqlar";

struct PackAddress {
  std::filesystem::path pack;
  std::string name;
};
/// Splits a path into pack and name; none if it is not a file below `.nonio/packs`.
std::optional<PackAddress> in_pack(const std::filesystem::path& path);

class PackWriter {
 public:
  /// Creates a pack in a folder that no other process uses; nothing is flushed.
  static Expected<PackWriter> create(const std::filesystem::path& path);
  /// Adds a file. Names must be added in sorted order, because the order determines the bytes of
  /// the pack.
  Expected<void> add(const std::string& name, std::string_view bytes);
  Expected<void> end();

 private:
  explicit PackWriter(Database database) : database_(std::move(database)) {}
  Database database_;
};

/// Reads a file of a pack; none if the pack has no such file. An error if the pack is missing, or
/// if the pack or this file in it is damaged.
Expected<std::optional<std::string>> read_packed(const PackAddress& at);
/// Returns the size of a file in a pack without reading it; none if there is no such file.
Expected<std::optional<std::uint64_t>> size_packed(const PackAddress& at);
/// Returns the names in a pack that begin with `folder` and '/', without this prefix, sorted.
Expected<std::vector<std::string>> names_packed(const PackAddress& folder);
/// Reads all files of a pack and compares their digests. An error names campaign and file.
Expected<void> check_pack(const std::filesystem::path& pack);
/// Copies a pack into OUT/.nonio/packs, where it appears completely or not at all. Its name is
/// `begin` and a part of its digest, so that other content never replaces it.
Expected<PackFile> hand_over(const std::filesystem::path& pack, const std::filesystem::path& out,
                             const std::string& begin);
/// Checks that a pack that was handed over still has its digest. An error states what is wrong with
/// it.
Expected<void> check_handed_over(const std::filesystem::path& out, const PackFile& pack);
/// Closes all packs that this process keeps open. Reading opens them again.
void close_packs();

}  // namespace nonio::storage
